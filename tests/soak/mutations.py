"""Mutated part programs: from a seed to a text, always the same one.

In: programs as they stand in the project, and a seed.  Out: a case: what is left of one of them after some edits.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from random import Random
from typing import TYPE_CHECKING

from trochia.languages.gcode.functions import FUNCTIONS, OPERATORS
from trochia.languages.gcode.registry import G_CODES, M_CODES

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from trochia.program import WorkState

MOST_BYTES = 3000  #: of a mutated program
_NUMBER = re.compile(rb"[-+]?(?:\d+\.?\d*|\.\d+)")
_WORD = re.compile(rb"[A-Za-z$@^#]\s*[-+]?[\d.]*")
_TOKEN = re.compile(rb"[\[\]()<>=#/*+-]|[A-Za-z]+|[\d.]+")
_NUMBERS = (
    b"0", b"-0", b"1", b"-1", b"0.5", b"2", b"3", b"10", b"30", b"31", b"0.0001", b"1e9", b"99999", b"999999999",
    b"2147483648", b"4294967297", b"-99999999999", b"1" + b"0" * 40, b"9" * 200, b"1" + b"0" * 240, b".", b"-", b"--1",
    b"0." + b"0" * 60 + b"1", b"5161", b"5220", b"5400", b"5599", b"5601", b"5602", b"#1", b"#<x>", b"##1", b"[1/3]",
    b"[0-1]", b"[1/0]", b"[10**300]", b"[10**300*10**300]", b"[2**0.5]", b"exp[700]", b"atan[0]/[0]", b"sqrt[0-1]",
)  # fmt: skip
_FLOW = (
    b"o1 sub", b"o1 endsub", b"o1 call [1] [2]", b"o1 call", b"o1 return [3]", b"o2 while [1]", b"o2 endwhile",
    b"o2 while [#1 LT 9]", b"o3 do", b"o3 while [0]", b"o4 repeat [5]", b"o4 endrepeat", b"o5 if [#1]", b"o5 else",
    b"o5 elseif [1]", b"o5 endif", b"o2 break", b"o2 continue", b"o<a> sub", b"o<a> endsub", b"o<a> call", b"m98 p1",
    b"m98 p1 l3", b"m99", b"o#1 if [1]", b"o[1+1] endif", b"o1", b"o", b"o<", b"o1 [", b"%", b"m2", b"m30", b"/ g1 x1",
    b"(msg, #1 #<x>)", b"(debug, #5420 %d #<_x>)", b"(print, %f %)", b"(log, #9999)", b"(logopen, /tmp)", b"(abort, #)",
    b"(probeopen x)", b"#<x> = 1", b"#<_y> = [#<_y> + 1]", b"#1 = [#1 + 1]", b"#[#1] = #1", b"#5220 = 3", b"#1 = #1",
)  # fmt: skip
_LETTERS = b"abcdefghijklmnopqrstuvwxyz$@^#"


@dataclass(frozen=True, slots=True)
class Origin:
    """A program to begin with, and what it finds set up."""

    name: str
    text: bytes
    work: WorkState


@dataclass(frozen=True, slots=True)
class Case:
    """A program to try: its text, what it finds set up, its dialect, and whether lines with ``/`` are left out."""

    seed: int
    text: bytes
    work: WorkState
    dialect: str
    block_delete: bool


def case(seed: int, origins: Sequence[Origin], dialects: Sequence[str]) -> Case:
    """Return the case of a seed; one in eight is generated, and one in eight in another dialect."""
    draw = Random(seed)  # noqa: S311 - for tests
    origin = draw.choice(origins)
    text = _generated(draw) if draw.random() < 1 / 8 else _window(origin.text, draw)
    for _ in range(draw.choice((1, 1, 1, 2, 2, 3, 5, 9))):
        edit = draw.choice(_EDITS)
        text = _spliced(text, draw.choice(origins).text, draw) if edit is None else edit(text, draw)
    dialect = draw.choice(dialects) if draw.random() < 1 / 8 else dialects[0]
    return Case(seed, text[:MOST_BYTES], origin.work, dialect, draw.random() < 1 / 8)


def _window(text: bytes, draw: Random) -> bytes:
    """Return a text, or of a long one some lines."""
    if len(text) <= MOST_BYTES:
        return text
    lines = text.splitlines(keepends=True)
    first = draw.randrange(len(lines))
    return b"".join(lines[first : first + draw.randint(1, 60)]) + b"m2\n"


def _generated(draw: Random) -> bytes:
    """Return a program of codes in no order, with the words codes have, and O-words."""
    lines = [_line(draw) for _ in range(draw.randint(1, 15))]
    return b"\n".join([b"f100 s1000 m3", *lines, b"m2", b""])


def _line(draw: Random) -> bytes:
    if draw.random() < 1 / 5:
        return draw.choice(_FLOW)
    words: list[bytes] = []
    if draw.random() < 3 / 4:
        code = draw.choice(list(G_CODES))
        words.append(b"g%g" % (code / 10))
    if draw.random() < 1 / 8:
        words.append(b"m%d" % draw.choice(list(M_CODES)))
    letters = draw.sample(b"xyzxyzijkabcuvwrpqldhefst", draw.randint(0, 5))
    words += [bytes((letter,)) + _value(draw) for letter in letters]
    return b" ".join(words)


def _value(draw: Random) -> bytes:
    kind = draw.random()
    if kind < 2 / 3:
        return b"%g" % draw.choice((0, 1, 2, -1, draw.randint(-9, 30), round(draw.uniform(-20, 20), 3)))
    return draw.choice(_NUMBERS) if kind < 5 / 6 else b"[" + _expression(draw, 3) + b"]"


def _expression(draw: Random, depth: int) -> bytes:
    if depth == 0 or draw.random() < 1 / 3:
        return draw.choice(_NUMBERS)
    if draw.random() < 1 / 2:
        return draw.choice(list(FUNCTIONS)).encode() + b"[" + _expression(draw, depth - 1) + b"]"
    operator = b" " + draw.choice(list(OPERATORS)).encode() + b" "
    return _expression(draw, depth - 1) + operator + _expression(draw, depth - 1)


# --- edits: a text and a draw -> another text


def _flip(text: bytes, draw: Random) -> bytes:
    at = draw.randrange(len(text) + 1)
    return text[:at] + bytes(byte ^ 1 << draw.randrange(8) for byte in text[at : at + 1]) + text[at + 1 :]


def _cut(text: bytes, draw: Random) -> bytes:
    at = draw.randrange(len(text) + 1)
    return text[:at] + text[at + draw.choice((1, 1, 2, 5, 30)) :]


def _insert(text: bytes, draw: Random) -> bytes:
    at = draw.randrange(len(text) + 1)
    new = bytes(draw.choice(b"\n\r\t %()[]<>#;/=.+-*oOgGmMnN\xef\xff\x00\x0b019" + _LETTERS) for _ in range(2))
    return text[:at] + new[: draw.randint(1, 2)] + text[at:]


def _repeat(text: bytes, draw: Random) -> bytes:
    """Repeat a few bytes, now and then very often."""
    at = draw.randrange(len(text) + 1)
    size = draw.choice((1, 1, 2, 4, 20))
    return text[:at] + text[at : at + size] * draw.choice((2, 2, 3, 20, 200)) + text[at + size :]


def _replace(pattern: re.Pattern[bytes], new: Callable[[bytes, Random], bytes]) -> Callable[[bytes, Random], bytes]:
    """Return an edit that replaces one match of a pattern."""

    def edit(text: bytes, draw: Random) -> bytes:
        found = list(pattern.finditer(text))
        if not found:
            return text
        match = draw.choice(found)
        return text[: match.start()] + new(match.group(), draw) + text[match.end() :]

    return edit


def _number(old: bytes, draw: Random) -> bytes:
    kind = draw.random()
    if kind < 1 / 4:
        return _value(draw)
    if kind < 1 / 2:
        return draw.choice(_NUMBERS)
    return draw.choice((b"-" + old, old + old, old[:-1], old + b".5", b"0" + old, old + b"0", b"[" + old + b"]"))


def _word(old: bytes, draw: Random) -> bytes:
    letter = bytes((draw.choice(_LETTERS),))
    return draw.choice((b"", old + b" " + old, letter + old[1:], old + b" " + letter + _value(draw)))


def _bracket(old: bytes, draw: Random) -> bytes:
    names = [name.encode() for name in (*FUNCTIONS, *OPERATORS, "atan", "exists")]
    new = draw.choice((b"[", b"]", b"#", b"<", b">", b"(", b")", b"[[", b"=", b"", draw.choice(names)))
    return draw.choice((new, new + old, old + new, b"[" + old + b"]"))


def _lines(text: bytes, draw: Random) -> bytes:
    """Drop, double, move or exchange lines, or put one of O-words between them."""
    lines = text.splitlines(keepends=True) or [b""]
    one, other = draw.randrange(len(lines)), draw.randrange(len(lines))
    kind = draw.randrange(6)
    if kind == 0:
        del lines[min(one, other) : min(one, other) + draw.choice((1, 1, 2, 5))]
    elif kind == 1:
        lines[one:one] = lines[other : other + draw.choice((1, 1, 3))]
    elif kind == 2:
        lines[one], lines[other] = lines[other], lines[one]
    elif kind == 3:
        lines.insert(one, _line(draw) + b"\n")
    elif kind == 4:
        lines.insert(one, draw.choice(_FLOW) + b"\n")
    else:
        lines[one] = lines[one].rstrip() + b" " + lines[other]
    return b"".join(lines)


def _spliced(text: bytes, other: bytes, draw: Random) -> bytes:
    """Return the head of a program with the tail of another, cut at lines or anywhere."""
    if draw.random() < 1 / 2:
        return text[: draw.randrange(len(text) + 1)] + other[draw.randrange(len(other) + 1) :]
    head, tail = text.splitlines(keepends=True), other.splitlines(keepends=True)
    return b"".join(head[: draw.randrange(len(head) + 1)] + tail[draw.randrange(len(tail) + 1) :])


_EDITS: tuple[Callable[[bytes, Random], bytes] | None, ...] = (
    _flip, _cut, _insert, _repeat, _lines, _lines, _lines, None,
    _replace(_NUMBER, _number), _replace(_NUMBER, _number), _replace(_WORD, _word), _replace(_TOKEN, _bracket),
)  # fmt: skip
