"""A text in another controller's dialect to the same text in LinuxCNC's language.

In: the bytes of a program and its :class:`~trochia.languages.gcode.dialects.Dialect`.  Out: bytes with the same lines,
so that every later error names the right one, and remarks on what was read differently.  Comments stay as they are.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from trochia.errors import UnknownCodeError
from trochia.languages.gcode.codes import key_of
from trochia.languages.gcode.place import Place
from trochia.languages.gcode.registry import M_CODES

if TYPE_CHECKING:
    from trochia.languages.gcode.dialects import Dialect

# comment, word with a number or an expression, letter alone, anything else
_PIECE = re.compile(
    r"(?P<comment>\([^()]*\)?|;.*)|(?P<letter>[a-z])[ \t]*(?P<value>(?:[-+][ \t]*)*[0-9.](?:[ \t]*[0-9.])*|\[[^;()]*\])"
    r"|(?P<bare>[a-z])|(?P<other>.)",
    re.IGNORECASE,
)
_NUMBER_OF_PROGRAM = re.compile(r"\s*[O:]\s*[0-9]+\s*", re.IGNORECASE)
_ENDS = re.compile(rb"^(?:[^(;\n]|\([^()\n]*\))*m[ \t]*0*(?:2|30)(?![0-9])", re.IGNORECASE | re.MULTILINE)
_CHECKSUM = re.compile(r"\*[0-9]+\s*$")
FIRST_USER_CODE = 100  #: from here on M codes are a LinuxCNC machine's own
FLOW = (98, 99)  #: M codes that are no rows of the table
_MIRRORED_SENSE = {"g2": "g3", "g3": "g2", "g41": "g42", "g42": "g41", "g41.1": "g42.1", "g42.1": "g41.1"}
_OFFSET_OF = {"x": "i", "y": "j"}


@dataclass(frozen=True, slots=True)
class Remark:
    """Something that was read differently; line counts from 1."""

    line: int
    message: str


@dataclass(slots=True)
class _Word:
    """A piece of a line: a word in lower case (``value`` is None where it has none), or other text (``letter`` "")."""

    letter: str
    value: str | None
    text: str

    @property
    def code(self) -> str:
        """Letter and number without leading zeros, as the tables spell it: g1, g41.1."""
        number = (self.value or "").lstrip("+").lstrip("0")
        if "." in number:
            number = number.rstrip("0").rstrip(".")
        return self.letter + (number or "0")


@dataclass(slots=True)
class _Adapter:
    dialect: Dialect
    name: str
    remarks: list[Remark] = field(default_factory=list[Remark])
    said: set[str] = field(default_factory=set[str])
    mirrored: set[str] = field(default_factory=set[str])

    def line(self, raw: bytes, number: int) -> bytes:
        """Return one line in LinuxCNC's language.

        Raises
        ------
        UnknownCodeError
            For a command to the controller, which is no part of a program.
        """
        text = raw.decode("latin-1")
        start = text.lstrip()[:1]
        if start and start in self.dialect.refused:
            column = text.index(start)
            raise Place(self.name, number, raw).fault(UnknownCodeError, self.dialect.refused[start], column,
                                                      hint="Take the line out of the program.")  # fmt: skip
        if self.dialect.checksums:
            text = _CHECKSUM.sub("", text)
        if self.dialect.program_numbers:
            text = _without_program_number(text)
        words = [_piece(match) for match in _PIECE.finditer(text)]
        kept = self._codes(words, number)
        return "".join(word.text for word in self._values(kept, number)).encode("latin-1")

    def _codes(self, words: list[_Word], number: int) -> list[_Word]:
        """Return the line with the codes this language has."""
        kept: list[_Word] = []
        dropped = False
        for word in words:
            if word.letter in "gm" and word.value is not None:
                spelt = self._code(word, words, number)
                dropped = dropped or spelt == ""
                word.text = spelt
            kept.append(word)
        if dropped and (self.dialect.whole_line or not _has_code(kept)):
            return [word for word in kept if not word.letter]
        return [word for word in kept if word.text]

    def _code(self, word: _Word, words: list[_Word], number: int) -> str:
        """Return what a code is spelt here; nothing where it is left out."""
        dialect, code = self.dialect, word.code
        if code in dialect.remarks:
            self._remark(number, dialect.remarks[code], once=code)
        if code in dialect.left_out:
            self._remark(number, f"left out: {dialect.left_out[code]}")
            return ""
        if word.letter != "m" or word.value is None or not word.value.isdigit():
            return _MIRRORED_SENSE.get(code, word.text) if len(self.mirrored) == 1 else word.text
        value = int(word.value)
        if value in dialect.mirrors:
            axis, on = dialect.mirrors[value]
            (self.mirrored.add if on else self.mirrored.discard)(axis)
            return " "
        if value in dialect.replaced:
            spelt = dialect.replaced[value]
            return spelt if spelt != "M3" or any(other.letter == "s" for other in words) else "M3S255"
        if not dialect.unknown_m and (key_of(value) not in M_CODES or value >= FIRST_USER_CODE) and value not in FLOW:
            self._remark(number, f"M{value} is not known here, and is left out")
            return ""
        return word.text

    def _values(self, words: list[_Word], number: int) -> list[_Word]:
        """Return the line with its words in the units and directions of this language."""
        codes = {word.code for word in words if word.letter in "gm" and word.letter}
        kept: list[_Word] = []
        for word in words:
            if word.letter in self.dialect.dropped_words and word.letter:
                self._remark(number, f"{word.letter.upper()} words are left out", once=word.letter)
                continue
            if "g4" in codes and word.letter in self.dialect.dwell:
                word.text = _scaled(word, self.dialect.dwell[word.letter])
            elif self.dialect.bare_axes and word.value is None and word.letter in tuple("xyz") and "g28" in codes:
                word.text = word.text + "0"
            elif word.letter and word.value is not None and self._mirrors(word.letter):
                word.text = word.letter.upper() + _negative(word.value)
            kept.append(word)
        return kept

    def _mirrors(self, letter: str) -> bool:
        return any(letter in (axis, _OFFSET_OF[axis]) for axis in self.mirrored)

    def _remark(self, line: int, message: str, *, once: str = "") -> None:
        if not once or once not in self.said:
            self.remarks.append(Remark(line, message))
        if once:
            self.said.add(once)


def adapt(text: bytes, dialect: Dialect, *, name: str = "<text>") -> tuple[bytes, list[Remark]]:
    """Return a program in LinuxCNC's language, line by line, and remarks on what was read differently.

    Raises
    ------
    UnknownCodeError
        For a line that is a command to the controller.
    """
    adapter = _Adapter(dialect, name)
    lines = text.split(b"\n")
    out = [adapter.line(raw, number) for number, raw in enumerate(lines, start=1)]
    if not dialect.needs_end and not _ended(text):
        adapter.remarks.append(Remark(len(lines), "the program has no M2, M30 or % at its end: it is ended here"))
        out.append(b"M2\n" if out and not out[-1].strip() else b"\nM2\n")
    return b"\n".join(out), adapter.remarks


def _ended(text: bytes) -> bool:
    lines = [line.strip() for line in text.split(b"\n") if line.strip()]
    return _ENDS.search(text) is not None or (lines[:1] == [b"%"] and lines.count(b"%") > 1)


def _piece(match: re.Match[str]) -> _Word:
    letter, bare = match["letter"], match["bare"]
    if letter is not None:
        return _Word(letter.lower(), _compact(match["value"]), match[0])
    return _Word("" if bare is None else bare.lower(), None, match[0])


def _compact(value: str) -> str:
    """Return a number as the language reads it, without its blanks and with one sign at most."""
    if value.startswith("["):
        return value
    value = "".join(value.split())
    digits = value.lstrip("+-")
    return digits if value.count("-") % 2 == 0 else "-" + digits


def _without_program_number(text: str) -> str:
    match = _NUMBER_OF_PROGRAM.match(text)
    return text if match is None else " " * match.end() + text[match.end() :]


def _has_code(words: list[_Word]) -> bool:
    """Return whether something acts on the line: a code, or an axis word."""
    return any(word.text and word.letter in tuple("gmxyzabcuvw") for word in words)


def _scaled(word: _Word, unit: float) -> str:
    """Return a dwell in seconds, as P."""
    if word.value is None:
        return word.text
    if word.value.startswith("["):
        return f"P[{word.value}*{unit:g}]"
    try:
        seconds = float(word.value) * unit
    except ValueError:  # no number: the reader says so
        return word.text
    text = f"{seconds:.10g}"
    return f"P{seconds:.12f}" if "e" in text else f"P{text}"


def _negative(value: str) -> str:
    if value.startswith("["):
        return f"[0-{value}]"
    if not value.strip("+-0."):
        return value
    return value[1:] if value.startswith("-") else "-" + value.lstrip("+")
