"""Tool tables on disk, in LinuxCNC's ``.tbl`` format.

One tool a line: ``T3 P3 Z12.5 D6 ;cutter``, words in any order: T number, P pocket, X Y Z A B C U V W offset, D
diameter, I and J angles of a turning tool's edges, Q its orientation; the rest behind ``;`` is a remark.

In: text, and the length its lengths count in [mm].  Out: tools, or the text again.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from trochia.errors import ConfigError
from trochia.program.modes import AXES
from trochia.program.tools import Tool

if TYPE_CHECKING:
    from collections.abc import Iterable

_WORD = re.compile(r"([A-Za-z])([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)")
_ROTARY = frozenset("ABC")
_HOW = "A line is like: T3 P3 Z12.5 D6 ;remark"
MOST_ORIENTATION = 9


def read_tools(text: str, name: str, *, unit: float = 1.0) -> tuple[Tool, ...]:
    """Return the tools of a table, in its order.

    Parameters
    ----------
    name
        What errors call the file.
    unit
        Length that its lengths count in [mm].

    Raises
    ------
    ConfigError
        For a line that is no tool, and for a tool that stands twice.
    """
    tools: list[Tool] = []
    lines: dict[int, int] = {}
    for number, line in enumerate(text.splitlines(), start=1):
        words, _, remark = line.partition(";")
        if not words.strip():
            continue
        tool = _tool(words, remark, f"{name}, line {number}", unit)
        if tool.number in lines:
            raise ConfigError(f"{name}, line {number}: tool {tool.number} stands in line {lines[tool.number]} already",
                              hint="Give each tool one line.")  # fmt: skip
        lines[tool.number] = number
        tools.append(tool)
    return tuple(tools)


def _tool(text: str, remark: str, place: str, unit: float) -> Tool:
    """Return the tool of one line."""
    values: dict[str, float] = {}
    for word in text.split():
        match = _WORD.fullmatch(word)
        letter = word[0].upper()
        if match is None or letter not in "TPDIJQ" + AXES:
            raise ConfigError(f"{place}: {word!r} is no word of a tool", hint=_HOW)
        if letter in values:
            raise ConfigError(f"{place}: the word {letter} stands twice", hint="Keep one of them.")
        values[letter] = float(match[2])
    if "T" not in values:
        raise ConfigError(f"{place}: the tool has no number T", hint=_HOW)
    number, pocket, orientation = (_whole(values, letter, place) for letter in "TPQ")
    if orientation > MOST_ORIENTATION:
        raise ConfigError(f"{place}: the orientation Q is a whole number from 0 to 9", hint=_HOW)
    return Tool(
        number=number,
        pocket=pocket,
        offset=tuple(values.get(axis, 0.0) * (1.0 if axis in _ROTARY else unit) for axis in AXES),
        diameter=values.get("D", 0.0) * unit,
        front=values.get("I", 0.0),
        back=values.get("J", 0.0),
        orientation=orientation,
        remark=remark.strip(),
    )


def _whole(values: dict[str, float], letter: str, place: str) -> int:
    value = values.get(letter, 0.0)
    if value < 0 or value != int(value):
        raise ConfigError(f"{place}: {letter} must be a whole number, 0 or more, not {value:g}", hint=_HOW)
    return int(value)


def write_tools(tools: Iterable[Tool], *, unit: float = 1.0) -> str:
    """Return the text of a table; ``unit`` is the length that its lengths count in [mm]."""
    return "".join(f"{_line(tool, unit)}\n" for tool in tools)


def _line(tool: Tool, unit: float) -> str:
    words = [f"T{tool.number}", f"P{tool.pocket}"]
    for axis, value in zip(AXES, tool.offset, strict=True):
        words += _word(axis, value / (1.0 if axis in _ROTARY else unit))
    words += _word("D", tool.diameter / unit) + _word("I", tool.front) + _word("J", tool.back)
    words += _word("Q", tool.orientation)
    return " ".join(words) + (f" ;{tool.remark}" if tool.remark else "")


def _word(letter: str, value: float) -> list[str]:
    """Return a word, or nothing for zero; six decimals, as the reference writes them."""
    text = f"{value:+.6f}".rstrip("0").rstrip(".")
    return [] if text in ("+0", "-0") else [letter + text]
