"""Keys changed in the text of a machine file: everything else stays as it stands, comments too.

In: the text, and the machine that it shall say.  Out: the text that says it, held to say nothing else.  Only keys of
one line, or of lines up to their closing bracket, are changed; what stands in a table of its own is refused.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from trochia.errors import ConfigError
from trochia.machine.dump import dumps
from trochia.machine.load import loads

if TYPE_CHECKING:
    from trochia.machine.machine import Machine

_HEADER = re.compile(r"\s*\[([^\[\]]+)\]\s*(?:#.*)?$")
_HINT = "Put it in by hand; nothing was written."


def with_keys(text: str, machine: Machine, keys: list[tuple[str, str]], *, file: str = "<text>") -> str:
    """Return the text with keys, each a table's name and a key's, as a machine has them.

    Raises
    ------
    ConfigError
        When one cannot be changed in the text without changing more.
    """
    fresh = dumps(machine).split("\n")
    lines = text.split("\n")
    for table, key in keys:
        _put(lines, table, key, _line(fresh, table, key))
    changed = "\n".join(lines)
    if loads(changed, file) != machine:
        table, key = keys[0]
        raise ConfigError("cannot be changed in this file without changing more", key=f"{table}.{key}", hint=_HINT)
    return changed


def _span(lines: list[str], table: str) -> tuple[int, int] | None:
    """Return the lines of a table: its header, and the line behind its last."""
    wanted = _parts(table)
    headers = [(i, _parts(found[1])) for i, line in enumerate(lines) if (found := _HEADER.match(line))]
    for number, (start, parts) in enumerate(headers):
        if parts == wanted:
            return start, headers[number + 1][0] if number + 1 < len(headers) else len(lines)
    return None


def _parts(dotted: str) -> tuple[str, ...]:
    return tuple(part.strip().strip("\"'") for part in dotted.split("."))


def _line(lines: list[str], table: str, key: str) -> str | None:
    """Return the line of a key as it is dumped; None where it is left out."""
    span = _span(lines, table)
    for line in lines[span[0] + 1 : span[1]] if span else ():
        if re.match(rf"{re.escape(key)}\s*=", line):
            return line
    return None


def _put(lines: list[str], table: str, key: str, line: str | None) -> None:
    """Replace a key's line or lines, add it at the table's end, or take it away."""
    span = _span(lines, table)
    if _span(lines, f"{table}.{key}") is not None:
        raise ConfigError("stands in a table of its own, not on a line", key=f"{table}.{key}", hint=_HINT)
    if span is None:
        if line is not None:
            while lines and not lines[-1].strip():
                lines.pop()
            lines += ["", f"[{table}]", line, ""]
        return
    start, end = span
    for i in range(start + 1, end):
        if re.match(rf"\s*{re.escape(key)}\s*=", lines[i]):
            last = _last(lines, i)
            remark = _remark(lines[last])
            lines[i : last + 1] = [] if line is None else [line + remark]
            return
    if line is not None:
        while end > start + 1 and (not lines[end - 1].strip() or lines[end - 1].lstrip().startswith("#")):
            end -= 1
        lines.insert(end, line)


def _last(lines: list[str], first: int) -> int:
    """Return the line at which the brackets of a value are closed."""
    open_ = 0
    for i in range(first, len(lines)):
        bare = re.sub(r'"(?:[^"\\]|\\.)*"|\'[^\']*\'', '""', lines[i]).partition("#")[0]
        open_ += sum(map(bare.count, "[{")) - sum(map(bare.count, "]}"))
        if open_ <= 0:
            return i
    return first


def _remark(line: str) -> str:
    """Return the remark at a line's end, with two blanks before it."""
    bare = re.sub(r'"(?:[^"\\]|\\.)*"|\'[^\']*\'', lambda found: "x" * len(found[0]), line)
    place = bare.find("#")
    return "" if place < 0 else "  " + line[place:].rstrip()
