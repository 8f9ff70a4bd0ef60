"""Where a key stands in the text of a TOML file.  In: text.  Out: dotted key → line and column.

The TOML reader of the standard library keeps no places; this light scan finds those of headers, of keys, and of keys
inside inline tables.  It only serves error messages: what it does not find is placed at the nearest table above.
"""

from __future__ import annotations

import re

_HEADER = re.compile(r"\s*\[\[?\s*([^\[\]]+?)\s*\]\]?\s*(?:#.*)?$")
_KEY = re.compile(r"""\s*((?:"[^"]*"|'[^']*'|[\w-]+)(?:\s*\.\s*(?:"[^"]*"|'[^']*'|[\w-]+))*)\s*=""")
_INLINE = re.compile(r"""[{,]\s*("[^"]*"|'[^']*'|[\w-]+)\s*=""")
_PART = re.compile(r""""[^"]*"|'[^']*'|[\w-]+""")

Place = tuple[int, int]  #: line and column, from 1


def places(text: str) -> dict[tuple[str, ...], Place]:
    """Return the place of every header and key found."""
    found: dict[tuple[str, ...], Place] = {}
    table: tuple[str, ...] = ()
    for number, line in enumerate(text.splitlines(), 1):
        if header := _HEADER.match(line):
            table = _parts(header.group(1))
            for length in range(1, len(table) + 1):
                found.setdefault(table[:length], (number, header.start(1) + 1))
        elif entry := _KEY.match(line):
            name = table + _parts(entry.group(1))
            for length in range(len(table) + 1, len(name) + 1):
                found.setdefault(name[:length], (number, entry.start(1) + 1))
            for inner in _INLINE.finditer(line, entry.end()):
                found.setdefault(name + _parts(inner.group(1)), (number, inner.start(1) + 1))
    return found


def nearest(found: dict[tuple[str, ...], Place], key: str) -> Place | None:
    """Return the place of a dotted key, else of the nearest table around it, else None."""
    parts = tuple(key.split("."))
    for length in range(len(parts), 0, -1):
        if parts[:length] in found:
            return found[parts[:length]]
    return None


def _parts(dotted: str) -> tuple[str, ...]:
    """Return the names of a dotted key, unquoted."""
    return tuple(part.strip("\"'") for part in _PART.findall(dotted))
