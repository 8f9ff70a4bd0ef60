"""A program text to canonical functions, line by line.

In: the text and a sink.  Out: calls to the sink.  :func:`blocks` is a generator that pauses after every line (or run
of plain lines), so that a live controller can decide how far ahead to read.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.errors import ParseError
from trochia.languages.gcode.adapt import adapt
from trochia.languages.gcode.dialects import LINUXCNC
from trochia.languages.gcode.execution import run_line
from trochia.languages.gcode.place import Place
from trochia.languages.gcode.predefined import define
from trochia.languages.gcode.reader import LONGEST_LINE
from trochia.languages.gcode.reading import USUAL, Reading
from trochia.languages.gcode.state import begin, work_of
from trochia.languages.gcode.stored import define as define_stored
from trochia.languages.gcode.stored import define_settings
from trochia.languages.gcode.texts import Text, Texts, next_line
from trochia.languages.gcode.walk import HOW_TO_END, Walk

if TYPE_CHECKING:
    from collections.abc import Iterator
    from mmap import mmap

    from trochia.languages.gcode.dialects import Dialect
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State
    from trochia.languages.gcode.walk import OnError
    from trochia.program.work import WorkState

AXES = "XYZABC"  #: axis words of the reference's stand-alone interpreter
HOME = (0.0,) * 9  #: where a program starts if nobody says otherwise


def interpret(
    text: bytes | mmap,
    sink: Sink,
    *,
    name: str,
    work: WorkState | None = None,
    start: tuple[float, ...] = HOME,
    axes: str = AXES,
    block_delete: bool = False,
    reading: Reading = USUAL,
    fast: bool = True,
) -> int:
    """Run a whole program and return the last line it came to; parameters and errors are those of :func:`blocks`."""
    walk = blocks(
        text, sink, name=name, work=work, start=start, axes=axes, block_delete=block_delete,
        reading=reading, fast=fast,
    )  # fmt: skip
    return max(walk, default=0)


def blocks(
    text: bytes | mmap,
    sink: Sink,
    *,
    name: str,
    work: WorkState | None = None,
    start: tuple[float, ...] = HOME,
    axes: str = AXES,
    block_delete: bool = False,
    reading: Reading = USUAL,
    fast: bool = True,
    on_error: OnError | None = None,
) -> Iterator[int]:
    """Interpret a program; yield the number of the last line done, again and again.

    Parameters
    ----------
    text
        The program, Latin-1.
    sink
        Receives the canonical functions.
    name
        What errors call the text: its file name, or ``<text>``.
    work
        Offsets set up on the machine; without it, those of ``reading``.
    start
        Machine position before the first move (9) [mm, degree].
    axes
        Letters that are axis words.
    block_delete
        Leave out lines that begin with ``/``.
    reading
        How programs are read here.
    fast
        Let the C core take the plain lines; the result is the same.
    on_error
        Is given every error, and reading goes on with the next line; without it the first error is raised.

    Raises
    ------
    ProgramError
        Where the reference rejects the program.
    """
    if reading.dialect is not None and reading.dialect is not LINUXCNC:
        text = _adapted(text, reading.dialect, reading, name)
    work = work or reading.work
    state = begin(work, start)
    state.answers = reading.answers
    for number, value in work.variables.items():
        state.parameters.numbered[number] = value
    define(state.parameters, state)
    define_stored(state.parameters, state)
    define_settings(state.parameters, reading.ini)
    _announce(state, sink)
    in_percent = _open(text, name)
    sink.on_reset()
    try:
        walk = Walk(
            Text(name, text), state, sink, axes=axes.lower(), texts=Texts(reading.subroutines), fast=fast,
            block_delete=block_delete, in_percent=in_percent, most_lines=reading.most_lines, on_error=on_error,
        )  # fmt: skip
        if reading.startup.strip():
            run_line(reading.startup, Place("startup code", 1, b""), state, sink)
        yield from walk.lines()
        if reading.on_end is not None:
            reading.on_end(work_of(state, work))
    finally:
        sink.on_reset()
        sink.on_reset()


def _adapted(text: bytes | mmap, dialect: Dialect, reading: Reading, name: str) -> bytes:
    """Return a text of another dialect in this language, and hand its remarks over."""
    adapted, remarks = adapt(text[:], dialect, name=name)
    for remark in remarks:
        if reading.on_remark is not None:
            reading.on_remark(remark.line, remark.message)
    return adapted


def _announce(state: State, sink: Sink) -> None:
    """Tell the sink the state a program starts in."""
    sink.line = 1
    sink.use_length_units(inch=state.inch)
    sink.set_g5x_offset(state.system, state.origin)
    sink.set_g92_offset(state.shift)
    sink.set_xy_rotation(state.rotation)
    sink.set_feed_reference()


def _open(text: bytes | mmap, name: str) -> bool:
    """Return whether the first line that is not blank is ``%``, so that another ``%`` ends the program.

    Raises
    ------
    ParseError
        For an empty or a binary text.
    """
    nul = text.find(b"\0")
    if nul >= 0:
        line = text[:nul].count(b"\n") + 1
        raise Place(name, line, b"").fault(ParseError, "this is no text: it holds a NUL byte",
                                           hint="A part program is plain text, like .ngc.")  # fmt: skip
    offset, line = 0, 1
    while offset < len(text):
        raw, offset = next_line(text, offset)
        if len(raw) > LONGEST_LINE or raw.strip():
            return raw.strip() == b"%"
        line += 1
    raise Place(name, 1, b"").fault(ParseError, "the program is empty", hint=HOW_TO_END)
