"""A joint's loop changed in the text of a machine file: everything else stays as it stands, comments too.

In: the text, a joint, its new loop.  Out: the text that says it, held to say nothing else.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from trochia.errors import ConfigError
from trochia.machine.dump import table_of
from trochia.machine.load import loads

if TYPE_CHECKING:
    from trochia.machine.machine import Machine
    from trochia.machine.servos import ServoLoop

_HEADER = re.compile(r"\s*\[([^\[\]]+)\]\s*(?:#.*)?$")
_INLINE = re.compile(r"\s*loop\s*=")
_HINT = "Put the loop in by hand; nothing was written."


def with_loop(text: str, joint: str, loop: ServoLoop, *, file: str = "<text>") -> str:
    """Return the text with the joint's loop in place of the one that it has.

    Raises
    ------
    ConfigError
        When the loop is not found in it as a table or on a line, or more than the loop would be another.
    """
    before = loads(text, file)
    index = [one.name for one in before.joints].index(joint)
    rotary = any(axis.rotary for axis, c in zip(before.axes, before.kinematics.matrix[index], strict=True) if c)
    lines = text.split("\n")
    table = table_of(f"joints.{joint}.loop", loop, rotary=rotary)
    found = _tables(lines, ("joints", joint, "loop"))
    if found:
        for start, end in reversed(found[1:]):
            del lines[start:end]
        lines[found[0][0] : found[0][1]] = table
    else:
        _out_of_line(lines, joint, table)
    changed = "\n".join(lines)
    _check(before, changed, index, file)
    return changed


def _tables(lines: list[str], name: tuple[str, ...]) -> list[tuple[int, int]]:
    """Return the spans of a table and of the tables in it, without the blanks and remarks behind them."""
    spans: list[tuple[int, int]] = []
    headers = [(i, _parts(found[1])) for i, line in enumerate(lines) if (found := _HEADER.match(line))]
    for number, (start, parts) in enumerate(headers):
        if parts[: len(name)] == name:
            end = headers[number + 1][0] if number + 1 < len(headers) else len(lines)
            while end > start + 1 and (not lines[end - 1].strip() or lines[end - 1].lstrip().startswith("#")):
                end -= 1
            spans.append((start, end))
    return spans


def _parts(header: str) -> tuple[str, ...]:
    return tuple(part.strip().strip("\"'") for part in header.split("."))


def _out_of_line(lines: list[str], joint: str, table: list[str]) -> None:
    """Replace the line of a loop in its joint's table by a table behind it."""
    for start, end in _tables(lines, ("joints", joint))[:1]:
        for i in range(start, end):
            if _INLINE.match(lines[i]):
                del lines[i]
                lines[end - 1 : end - 1] = ["", *table]
                return
    raise ConfigError("is not found as a table or on a line of its own", key=f"joints.{joint}.loop", hint=_HINT)


def _check(before: Machine, text: str, index: int, file: str) -> None:
    after = loads(text, file)
    own = after.joints[index]
    joints = tuple(replace(one, loop=own.loop) if i == index else one for i, one in enumerate(before.joints))
    if replace(before, joints=joints) != after:
        raise ConfigError("cannot be changed without changing more", key=f"joints.{own.name}.loop", hint=_HINT)
