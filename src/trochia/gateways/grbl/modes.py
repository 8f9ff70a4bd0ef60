"""Lines as GRBL 1.1 reads them: words, modal groups, its error numbers.

In: a line.  Out: the same line in words that mean one thing only, modes kept; or the number of what is wrong with it.
What GRBL does not have is refused here, though Trochia has it: a sender that speaks GRBL counts on that.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

WIDTH = 79  #: characters of a line

_REMARK = re.compile(r"\([^)]*\)?|;.*|[\s/]")
_WORD = re.compile(r"([A-Z])([-+]?(?:\d+\.?\d*|\.\d+))")
_GROUPS: dict[str, str] = {
    **dict.fromkeys(("G0", "G1", "G2", "G3", "G80"), "motion"),
    **dict.fromkeys(("G17", "G18", "G19"), "plane"),
    **dict.fromkeys(("G90", "G91"), "distance"),
    "G91.1": "arc distance",
    **dict.fromkeys(("G93", "G94"), "feed mode"),
    **dict.fromkeys(("G20", "G21"), "units"),
    "G40": "compensation",
    **dict.fromkeys(("G43.1", "G49"), "length"),
    **dict.fromkeys(("G54", "G55", "G56", "G57", "G58", "G59"), "system"),
    "G61": "path",
    **dict.fromkeys(("G4", "G10", "G28", "G28.1", "G30", "G30.1", "G53", "G92", "G92.1"), "once"),
    **dict.fromkeys(("M0", "M1", "M2", "M30"), "stop"),
    **dict.fromkeys(("M3", "M4", "M5"), "spindle"),
    **dict.fromkeys(("M7", "M8", "M9"), "coolant"),
}
_START = {"motion": "G0", "system": "G54", "plane": "G17", "units": "G21", "distance": "G90", "feed mode": "G94",
          "spindle": "M5", "coolant": "M9"}  # fmt: skip
_AFTER_END = {"motion": "G1", "system": "G54", "plane": "G17", "distance": "G90", "feed mode": "G94",
              "spindle": "M5", "coolant": "M9"}  # fmt: skip
_TAKES_AXES = frozenset({"G10", "G28", "G28.1", "G30", "G30.1", "G92"})
_ARC_WORDS = {"G17": "IJ", "G18": "IK", "G19": "JK"}


class Refused(Exception):  # noqa: N818 - it is GRBL's answer, not a mistake of ours
    """A line GRBL refuses, by the number of its error."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


@dataclass(slots=True)
class Modes:
    """The modes as they stand, by group; feed in the units in force, speed as S gave it.

    ``user`` are the codes M100 to M199 that the machine has programs for: those it has beside GRBL's.
    """

    user: frozenset[int] = frozenset()
    codes: dict[str, str] = field(default_factory=lambda: dict(_START))
    feed: float = 0.0
    speed: float = 0.0
    tool: int = 0

    def preamble(self) -> list[str]:
        """Return lines that set these modes up for a program that knows nothing of them."""
        codes = self.codes
        lines = [" ".join((codes["units"], codes["plane"], codes["distance"], codes["feed mode"], codes["system"]))]
        if self.feed and codes["feed mode"] == "G94":
            lines.append(f"F{self.feed:g}")
        if codes["spindle"] != "M5":
            lines.append(f"{codes['spindle']} S{self.speed:g}")
        return lines

    def shown(self) -> str:
        """Return the modes as ``$G`` shows them."""
        codes = [self.codes[group] for group in
                 ("motion", "system", "plane", "units", "distance", "feed mode", "spindle", "coolant")]  # fmt: skip
        return f"[GC:{' '.join(codes)} T{self.tool} F{self.feed:g} S{self.speed:g}]"

    def take(self, line: str) -> tuple[str, str]:
        """Return a line's words with its motion code, and its stop code or nothing; the modes are as after it.

        Raises
        ------
        Refused
            With nothing changed.
        """
        codes, values = words_of(line, self.user)
        motion = codes.get("motion", self.codes["motion"])
        axes = {letter for letter in values if letter in "XYZ"}
        moves = bool(axes) and codes.get("once") not in _TAKES_AXES and codes.get("length") != "G43.1"
        self._check(codes, values, motion, moves=moves)
        if "units" in codes and codes["units"] != self.codes["units"] and "F" not in values:
            self.feed *= 25.4 if codes["units"] == "G21" else 1 / 25.4
        self.feed, self.speed = values.get("F", self.feed), values.get("S", self.speed)
        self.tool = int(values.get("T", self.tool))
        self.codes.update({group: code for group, code in codes.items() if group in _START})
        stop = codes.get("stop", "")
        text = " ".join([code for group, code in codes.items() if group not in {"motion", "stop"}]
                        + ([motion] if moves else []) + ([stop] if stop in {"M0", "M1"} else [])
                        + [f"{letter}{value:.10g}" for letter, value in values.items() if letter != "N"])  # fmt: skip
        if stop in {"M2", "M30"}:
            self.codes.update(_AFTER_END)
            text = f"{text}\nM5 M9"
        return text, stop

    def _check(self, codes: dict[str, str], values: dict[str, float], motion: str, *, moves: bool) -> None:
        """Refuse what cannot stand together."""
        once = codes.get("once", "")
        used = set("FSTNXYZ")
        if moves:
            if motion == "G80":
                raise Refused(31)
            if once == "G53" and motion not in {"G0", "G1"}:
                raise Refused(30)
            inverse = codes.get("feed mode", self.codes["feed mode"]) == "G93"
            if motion != "G0" and not values.get("F", 0.0 if inverse else self.feed) > 0.0:
                raise Refused(22)
            if motion in {"G2", "G3"}:
                used |= self._arc(codes, values)
        elif codes.get("motion") in {"G2", "G3"}:
            raise Refused(26)
        if once in {"G4", "G10"} and "P" not in values:
            raise Refused(28)
        if once == "G10" and values.get("L") not in {2, 20}:
            raise Refused(20)
        used |= {"G4": {"P"}, "G10": {"P", "L"}}.get(once, set())
        used |= {"P", "Q"} if "user" in codes else set()
        if set(values) - used:
            raise Refused(36)

    def _arc(self, codes: dict[str, str], values: dict[str, float]) -> set[str]:
        """Return the letters an arc uses, or refuse it."""
        offsets = _ARC_WORDS[codes.get("plane", self.codes["plane"])]
        if "R" in values:
            return {"R"}
        if not set(offsets) & set(values):
            raise Refused(35)
        return set(offsets)


def plain(line: str) -> str:
    """Return a line in capitals, without remarks, blanks and block-delete marks."""
    return _REMARK.sub("", line).upper()


def words_of(text: str, user: frozenset[int] = frozenset()) -> tuple[dict[str, str], dict[str, float]]:
    """Return codes by modal group, and values by letter; ``user``: codes M100 to M199 that there are.

    Raises
    ------
    Refused
        For what is no word, no code of GRBL's, or stands twice.
    """
    if "".join(match.group(0) for match in _WORD.finditer(text)) != text:
        raise Refused(2 if text[:1].isalpha() else 1)
    codes: dict[str, str] = {}
    values: dict[str, float] = {}
    for letter, number in _WORD.findall(text):
        value = float(number)
        if letter in "GM":
            code = f"{letter}{value:g}"
            group = "user" if letter == "M" and value in user else _GROUPS.get(code)
            if group is None:
                raise Refused(20)
            if group in codes:
                raise Refused(21)
            codes[group] = code
        elif letter not in "FIJKLNPRSTXYZ" and not (letter == "Q" and "user" in codes):
            raise Refused(20)
        elif letter in values:
            raise Refused(25)
        else:
            values[letter] = value
    if any(values.get(letter, 0.0) < 0.0 for letter in "FNPST"):
        raise Refused(4)
    return codes, values
