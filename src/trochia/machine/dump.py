"""A Machine to the text of its file: what :func:`trochia.machine.load.loads` reads back as an equal machine.

With ``comments`` every key is explained where it stands first, and optional keys that are not set stand as comments,
so that a file is its own manual.
"""

from __future__ import annotations

import dataclasses
import re
from typing import TYPE_CHECKING, Any

from trochia.machine.axes import Axis, AxisKind
from trochia.machine.codecs import Text, quote
from trochia.machine.read import FORMAT
from trochia.machine.schema import Record, Variant, keys_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from trochia.machine.codecs import Codec
    from trochia.machine.machine import Machine
    from trochia.machine.schema import Key

_BARE = re.compile(r"[A-Za-z0-9_-]+\Z")
_TABLES = (
    "path",
    "squareness",
    "squareness_error",
    "spindle",
    "beam",
    "probe",
    "panel",
    "board",
)  #: records of a machine that are written as tables of their own


def dumps(machine: Machine, *, comments: bool = False) -> str:
    """Return TOML text; keys at their defaults are left out."""
    writer = _Writer(comments)
    writer.head(machine)
    for name in _TABLES[:1]:
        writer.table(name, getattr(machine, name), skip_empty=True)
    for axis in machine.axes:
        writer.table(f"axes.{axis.name}", axis, rotary=axis.rotary)
    matrix = machine.kinematics.matrix
    for joint, row in zip(machine.joints, matrix, strict=True):
        moved = [axis for axis, c in zip(machine.axes, row, strict=True) if c]
        extra = {}
        if len(moved) == 1 and moved[0].name != joint.name:
            extra["axis"] = (quote(moved[0].name), "the axis it drives")
        writer.table(f"joints.{_name(joint.name)}", joint, rotary=moved[0].rotary, extra=extra)
    for name in _TABLES[1:]:
        writer.table(name, getattr(machine, name))
    for channel in machine.io:
        writer.table(f"io.{_name(channel.name)}", channel)
    return "\n".join(writer.lines) + "\n"


def table_of(header: str, description: Any, *, rotary: bool = False) -> list[str]:  # noqa: ANN401 - any variant
    """Return the lines of a variant of a description as a table of its own, its kind first."""
    writer = _Writer(comments=False)
    writer.table(header, description, rotary=rotary, extra={"kind": (quote(description.kind), "")})
    return writer.lines[1:]


class _Writer:
    """Lines of a machine file."""

    def __init__(self, comments: bool) -> None:  # noqa: FBT001 - the one switch of a private class
        self.lines: list[str] = []
        self.comments = comments
        self._explained: set[str] = set()

    def head(self, machine: Machine) -> None:
        """Write what stands above all tables."""
        self._line(f"format = {FORMAT}", "version of this file's form")
        self._entries(machine, rotary=False, only=("name", "description"))
        self._line(f"kinematics = {quote(machine.kinematics.kind)}", "how joints move axes")
        rest = tuple(name for name in keys_of(type(machine)) if name not in {"name", "description", *_TABLES})
        self._entries(machine, rotary=False, only=rest)

    def table(
        self,
        header: str,
        description: object,
        *,
        rotary: bool = False,
        extra: dict[str, tuple[str, str]] | None = None,
        skip_empty: bool = False,
    ) -> None:
        """Write one description as a table; None is left out."""
        if description is None or (skip_empty and not self.comments and description == type(description)()):
            return
        self.lines += ["", f"[{header}]"]
        for name, (text, doc) in (extra or {}).items():
            self._line(f"{name} = {text}", doc)
        self._entries(description, rotary=rotary)

    def _entries(self, description: Any, *, rotary: bool, only: tuple[str, ...] | None = None) -> None:  # noqa: ANN401 - any description
        """Write the keys of a description; optional ones at their defaults only as comments."""
        cls = type(description)
        first = cls.__name__ not in self._explained or only is not None
        self._explained.add(cls.__name__)
        defaults = {field.name: field.default for field in dataclasses.fields(cls)}
        for name, entry in keys_of(cls).items():
            if only is not None and name not in only:
                continue
            value = getattr(description, name)
            if _left_out(description, name, value, defaults):
                if first and self.comments and not isinstance(entry.codec, Variant):
                    self._line(f"# {name} = {_sample(entry.codec, defaults[name], rotary=rotary)}", _doc(entry))
            else:
                self._line(f"{name} = {_text(entry.codec, value, rotary=rotary)}", _doc(entry) if first else "")

    def _line(self, text: str, doc: str) -> None:
        """Write a line, explained where that is asked for."""
        self.lines.append(f"{text:<40} # {doc}" if self.comments and doc else text)


def _left_out(description: object, name: str, value: object, defaults: Mapping[str, object]) -> bool:
    """Whether a key says nothing: not given, at its default, or an axis' kind that its letter already tells."""
    if isinstance(description, Axis) and name == "kind":
        return (description.kind is AxisKind.ROTARY) == (description.name in tuple("ABC"))
    return value is None or value == defaults[name]


def _doc(entry: Key) -> str:
    """Return what a key means, with its choices."""
    choices = entry.codec.choices if isinstance(entry.codec, Text) else ()
    listed = f": {', '.join(choices)}" if choices and choices[0] not in entry.doc else ""
    return f"{entry.doc}{listed}"


def _sample(codec: Codec | Record, default: object, *, rotary: bool) -> str:
    """Return a value for a key that is not set: its default, or an example."""
    if isinstance(codec, Record):
        defaults = {field.name: field.default for field in dataclasses.fields(codec.cls)}
        parts = [
            f"{name} = {_sample(entry.codec, defaults[name], rotary=rotary)}"
            for name, entry in keys_of(codec.cls).items()
            if not isinstance(entry.codec, Variant)
        ]
        return "{ " + ", ".join(parts) + " }"
    if default is None or default is dataclasses.MISSING:
        return codec.example(rotary=rotary)
    return codec.write(default, rotary=rotary)


def _text(codec: Codec | Record | Variant, value: Any, *, rotary: bool) -> str:  # noqa: ANN401 - any field's value
    """Return one value as TOML; a description becomes an inline table."""
    if not isinstance(codec, Record | Variant):
        return codec.write(value, rotary=rotary)
    parts = [f"kind = {quote(value.kind)}"] if isinstance(codec, Variant) else []
    defaults = {field.name: field.default for field in dataclasses.fields(value)}
    for name, entry in keys_of(type(value)).items():
        inner = getattr(value, name)
        if not _left_out(value, name, inner, defaults):
            parts.append(f"{name} = {_text(entry.codec, inner, rotary=rotary)}")
    return "{ " + ", ".join(parts) + " }" if parts else "{}"


def _name(name: str) -> str:
    """Return a name as part of a table's header."""
    return name if _BARE.match(name) else quote(name)
