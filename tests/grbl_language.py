"""The language of the strict GRBL model: settings, words and modal groups of a line, the chords of an arc, a move."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

SETTINGS = {
    "$0": "10", "$1": "25", "$2": "0", "$3": "0", "$4": "0", "$5": "0", "$6": "0", "$10": "3", "$11": "0.010",
    "$12": "0.002", "$13": "0", "$20": "0", "$21": "0", "$22": "0", "$23": "0", "$24": "25.000", "$25": "500.000",
    "$26": "250", "$27": "1.000", "$30": "1000", "$31": "0", "$32": "0", "$100": "250.000", "$101": "250.000",
    "$102": "250.000", "$110": "6000.000", "$111": "6000.000", "$112": "3000.000", "$120": "500.000",
    "$121": "500.000", "$122": "500.000", "$130": "400.000", "$131": "300.000", "$132": "100.000",
}  # fmt: skip
GROUPS = (
    {"G0", "G1", "G2", "G3", "G38.2", "G38.3", "G38.4", "G38.5", "G80"}, {"G17", "G18", "G19"}, {"G90", "G91"},
    {"G91.1"}, {"G93", "G94"}, {"G20", "G21"}, {"G40"}, {"G43.1", "G49"}, {"G54", "G55", "G56", "G57", "G58", "G59"},
    {"G61"}, {"G4", "G10", "G28", "G28.1", "G30", "G30.1", "G53", "G92", "G92.1"}, {"M0", "M1", "M2", "M30"},
    {"M3", "M4", "M5"}, {"M7", "M8", "M9"},
)  # fmt: skip
STARTING = {0: "G0", 1: "G17", 2: "G90", 4: "G94", 5: "G21", 6: "G40", 7: "G49", 8: "G54", 12: "M5", 13: "M9"}
_WORD = re.compile(r"([A-Z])([-+]?(?:\d+\.?\d*|\.\d+))")


class Refused(Exception):  # noqa: N818 - what it is called
    """``error:`` with a number."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


def words_of(text: str) -> tuple[dict[int, str], dict[str, float]]:
    """Return codes by modal group, and values by letter."""
    if "".join(m.group(0) for m in _WORD.finditer(text)) != text:
        raise Refused(2 if text[:1].isalpha() else 1)
    codes: dict[int, str] = {}
    values: dict[str, float] = {}
    for letter, number in _WORD.findall(text):
        value = float(number)
        if letter in "GM":
            code = f"{letter}{value:g}"
            group = next((at for at, row in enumerate(GROUPS) if code in row), None)
            if group is None:
                raise Refused(20)
            if group in codes:
                raise Refused(21)
            codes[group] = code
        elif letter in values:
            raise Refused(25)
        elif letter in "FLNPTSIJKRXYZ":
            values[letter] = value
        else:
            raise Refused(20)
    if values.get("F", 0) < 0 or values.get("S", 0) < 0 or values.get("T", 0) < 0:
        raise Refused(4)
    return codes, values


def arc_points(  # noqa: PLR0917 - what an arc is made of
    motion: str, plane: str, begin_at: list[float], end: list[float], values: dict[str, float], tolerance: float
) -> list[list[float]]:
    """Return the ends of an arc's chords; values in mm."""
    first, second = {"G17": (0, 1), "G18": (2, 0), "G19": (1, 2)}[plane]
    if "R" in values or not {"IJK"[first], "IJK"[second]} & set(values):
        raise Refused(35)
    centre = [begin_at[at] + values.get("IJK"[at], 0.0) for at in (first, second)]
    here = begin_at[first] - centre[0], begin_at[second] - centre[1]
    there = end[first] - centre[0], end[second] - centre[1]
    radius = math.hypot(*here)
    apart = abs(radius - math.hypot(*there))
    if apart > 0.5 or (apart > 0.005 and apart > 0.001 * radius):
        raise Refused(33)
    angle = math.atan2(here[0] * there[1] - here[1] * there[0], here[0] * there[0] + here[1] * there[1])
    if motion == "G2" and angle >= -5e-7:
        angle -= math.tau
    if motion == "G3" and angle <= 5e-7:
        angle += math.tau
    count = int(abs(0.5 * angle * radius) / math.sqrt(tolerance * (2 * radius - tolerance)))
    begin = math.atan2(here[1], here[0])
    points = []
    for number in range(1, count):
        share = number / count
        point = [a + share * (b - a) for a, b in zip(begin_at, end, strict=True)]
        point[first] = centre[0] + radius * math.cos(begin + share * angle)
        point[second] = centre[1] + radius * math.sin(begin + share * angle)
        points.append(point)
    return [*points, end]


@dataclass
class Block:
    """One straight move in the planner: end, speed [mm/s], and how far it has come."""

    start: list[float]
    end: list[float]
    speed: float
    jog: bool = False
    rapid: bool = False
    done: float = 0.0

    @property
    def length(self) -> float:
        return math.dist(self.start, self.end)
