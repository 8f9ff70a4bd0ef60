"""RS274/NGC, as LinuxCNC 2.9 has it: a text to canonical functions, and those to a program in machine coordinates.

The way of a line: ``reader`` (words) → ``block`` (codes by modal group) → ``check`` (against the modal state) →
``interpreter`` (order of execution) → ``groups/`` (one file per modal group) → a ``sink``: ``canon`` prints,
``builder`` builds.  ``fast`` takes plain lines in C instead, with the same result.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.dialects import DIALECTS, Dialect
from trochia.languages.gcode.interpreter import HOME, blocks, interpret
from trochia.languages.gcode.reading import USUAL, Reading

if TYPE_CHECKING:
    from trochia.errors import ProgramError
    from trochia.program import Program, WorkState

__all__ = ["ALL_AXES", "DIALECTS", "MOST_PROBLEMS", "Dialect", "Reading", "blocks", "interpret", "problems", "read"]

ALL_AXES = "XYZABCUVW"
MOST_PROBLEMS = 10_000  #: after so many, a text is no part program, and reading it further helps nobody


def read(
    text: str | bytes,
    *,
    name: str = "<text>",
    work: WorkState | None = None,
    start: tuple[float, ...] = HOME,
    axes: str = ALL_AXES,
    block_delete: bool = False,
    reading: Reading = USUAL,
) -> Program:
    """Return the program of a text, in machine coordinates.

    Parameters are those of :func:`~trochia.languages.gcode.interpreter.blocks`.

    Raises
    ------
    ProgramError
        At the first line that is wrong.
    """
    from trochia.languages.gcode.builder import Builder  # noqa: PLC0415 - only programs need numpy

    data = _as_bytes(text)
    sink = Builder(name, start, room=data.count(b"\n") + 1)
    lines = interpret(
        data, sink, name=name, work=work, start=start, axes=axes, block_delete=block_delete, reading=reading
    )
    return sink.program(lines)


def problems(
    text: str | bytes,
    *,
    name: str = "<text>",
    work: WorkState | None = None,
    start: tuple[float, ...] = HOME,
    axes: str = ALL_AXES,
    block_delete: bool = False,
    reading: Reading = USUAL,
) -> list[ProgramError]:
    """Return every wrong line of a text, at most :data:`MOST_PROBLEMS`; an empty list means it can be read.

    After a wrong line reading goes on as if it had been right.  Parameters are those of :func:`read`.
    """
    from trochia.errors import ProgramError  # noqa: PLC0415 - only here a class, above a type
    from trochia.languages.gcode.builder import Builder  # noqa: PLC0415 - only programs need numpy

    found: list[ProgramError] = []
    sink = Builder(name, start)
    walk = blocks(
        _as_bytes(text), sink, name=name, work=work, start=start, axes=axes, block_delete=block_delete,
        reading=reading, on_error=found.append,
    )  # fmt: skip
    try:
        for _ in walk:
            if len(found) >= MOST_PROBLEMS:
                break
        sink.program(0)
    except ProgramError as error:  # one that ends the reading: empty, binary
        found.append(error)
    return found


def _as_bytes(text: str | bytes) -> bytes:
    """Return the text in Latin-1, with ``?`` for what that lacks (it can only stand in comments)."""
    return text if isinstance(text, bytes) else text.encode("latin-1", errors="replace")
