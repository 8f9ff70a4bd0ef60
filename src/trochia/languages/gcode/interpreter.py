"""A program text to canonical functions, line by line.

In: the text and a sink.  Out: calls to the sink.  :func:`blocks` is a generator that pauses after every line (or run
of plain lines), so that a live controller can decide how far ahead to read.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.errors import ParseError, ProgramError
from trochia.languages.gcode.block import sort_words
from trochia.languages.gcode.check import check
from trochia.languages.gcode.codes import key_of
from trochia.languages.gcode.fast import FastPath
from trochia.languages.gcode.groups.compensation import run_compensated, sink_of
from trochia.languages.gcode.place import Place
from trochia.languages.gcode.reader import LONGEST_LINE, read_line
from trochia.languages.gcode.registry import RANK
from trochia.languages.gcode.state import NO_MOTION, begin
from trochia.program.work import WorkState

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from mmap import mmap

    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.codes import Code, WordCode
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State

    OnError = Callable[[ProgramError], None]

AXES = "XYZABC"  #: axis words of the reference's stand-alone interpreter
HOME = (0.0,) * 9  #: where a program starts if nobody says otherwise
_MOST_PATIENCE = 16  # lines
_HOW_TO_END = "The program must end with M2 or M30, or with a line % if it begins with one."


def interpret(
    text: bytes | mmap,
    sink: Sink,
    *,
    name: str,
    work: WorkState | None = None,
    start: tuple[float, ...] = HOME,
    axes: str = AXES,
    block_delete: bool = False,
    fast: bool = True,
) -> int:
    """Run a whole program and return its number of lines; parameters and errors are those of :func:`blocks`."""
    line = 0
    walk = blocks(text, sink, name=name, work=work, start=start, axes=axes, block_delete=block_delete, fast=fast)
    for line in walk:  # noqa: B007 - the last one is wanted
        pass
    return line


def blocks(
    text: bytes | mmap,
    sink: Sink,
    *,
    name: str,
    work: WorkState | None = None,
    start: tuple[float, ...] = HOME,
    axes: str = AXES,
    block_delete: bool = False,
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
        Offsets set up on the machine.
    start
        Machine position before the first move (9) [mm, degree].
    axes
        Letters that are axis words.
    block_delete
        Leave out lines that begin with ``/``.
    fast
        Let the C core take the plain lines; the result is the same.
    on_error
        Is given every error, and reading goes on with the next line; without it the first error is raised.

    Raises
    ------
    ProgramError
        Where the reference rejects the program.
    """
    state = begin(work or WorkState(), start)
    _announce(state, sink)
    in_percent = _open(text, name)
    sink.on_reset()
    try:
        walk = _Walk(text, state, sink, name, axes.lower(), block_delete=block_delete, on_error=on_error)
        yield from walk.lines(FastPath(text, axes.lower()) if fast else None, in_percent=in_percent)
    finally:
        sink.on_reset()
        sink.on_reset()


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
        raw, offset = _next(text, offset)
        if len(raw) > LONGEST_LINE or raw.strip():
            return raw.strip() == b"%"
        line += 1
    raise Place(name, 1, b"").fault(ParseError, "the program is empty", hint=_HOW_TO_END)


def _next(text: bytes | mmap, offset: int) -> tuple[bytes, int]:
    """Return the line that begins at ``offset``, without its end, and where the next one begins."""
    end = text.find(b"\n", offset)
    end = len(text) if end < 0 else end
    return text[offset:end], end + 1


class _Walk:
    """One pass over a text."""

    def __init__(
        self,
        text: bytes | mmap,
        state: State,
        sink: Sink,
        name: str,
        axes: str,
        *,
        block_delete: bool,
        on_error: OnError | None,
    ) -> None:
        self._text = text
        self._state = state
        self._sink = sink
        self._name = name
        self._axes = axes
        self._block_delete = block_delete
        self._on_error = on_error

    def lines(self, fast: FastPath | None, *, in_percent: bool) -> Iterator[int]:
        """Run every line; yield the number of the last one done."""
        text, state = self._text, self._state
        offset, line, opened = 0, 1, not in_percent
        patience, retry = 0, 1  # after k tries in vain the fast path is next tried k lines later
        while offset < len(text):
            if fast is not None and opened and line >= retry:
                before = offset
                offset, line = fast.advance(state, self._sink, offset, line)
                patience = 0 if offset > before else min(patience + 1, _MOST_PATIENCE)
                retry = line + patience
                yield line - 1
                if offset >= len(text):
                    break
            raw, offset = _next(text, offset)
            if in_percent and raw.strip() == b"%":
                if opened:
                    sink_of(state, self._sink).finish()
                    return
                opened = True
            elif opened:
                self._run(Place(self._name, line, raw))
                if state.ended:
                    self._look_for_percent(offset, in_percent=in_percent)
                    yield line
                    return
            yield line
            line += 1
        self._unended(line - 1, in_percent=in_percent)

    def _run(self, place: Place) -> None:
        """Run one line, or hand its error over."""
        if self._block_delete and place.raw.lstrip()[:1] == b"/":
            return
        self._sink.line = place.line
        if self._state.compensation is not None:
            self._state.compensation.line = place.line
        block: Block | None = None
        try:
            block = sort_words(read_line(place), self._axes)
            check(block, self._state)
            execute(block, self._state, self._sink)
        except ProgramError as error:
            if self._on_error is None:
                raise
            self._on_error(error)
            _pretend_done(block, self._state)

    def _look_for_percent(self, offset: int, *, in_percent: bool) -> None:
        """Remark on a program that begins with ``%`` and has none after its end."""
        if in_percent and not any(line.strip() == b"%" for line in self._text[offset:].split(b"\n")):
            self._sink.comment("interpreter: percent sign missing from end of file")

    def _unended(self, line: int, *, in_percent: bool) -> None:
        """Refuse a program that stops without an end."""
        what = "no closing %" if in_percent else "no M2, M30 or %"
        last = self._text[:].rstrip(b"\n").rpartition(b"\n")[2]
        error = Place(self._name, line, last).fault(ParseError, f"the program has {what} at its end", hint=_HOW_TO_END)
        if self._on_error is None:
            raise error
        self._on_error(error)


def execute(block: Block, state: State, sink: Sink) -> None:
    """Let the parts of a checked line act in the order of execution."""
    if block.comment is not None:
        _comment(block.comment, sink_of(state, sink))
    parts: list[tuple[int, Code | WordCode]] = [(RANK[code.step], code) for code in block.codes]
    parts += [(RANK[word.step], word) for word in block.acting]
    if block.motion is not None and "motion" not in block.groups:
        parts.append((RANK["motion"], block.motion))
    if len(parts) > 1:
        parts.sort(key=_rank)
    for _, part in parts:
        if state.compensation is None:
            part.run(block, state, sink)
        else:
            run_compensated(part, block, state, sink)


def _rank(part: tuple[int, Code | WordCode]) -> int:
    return part[0]


def _comment(text: str, sink: Sink) -> None:
    """Send a comment, or a message to the operator: ``(MSG, text)``."""
    if text[:4].lower() == "msg,":
        sink.message(text[4:])
    else:
        sink.comment(text)


def _pretend_done(block: Block | None, state: State) -> None:
    """After an error, go on as if the line had been right, so that one mistake is not reported on every line."""
    if block is None:
        return
    if state.absolute:
        for axis, value in block.axes.items():
            state.position[axis] = value
    if "motion" in block.groups and block.motion is not None:
        state.motion = key_of(float(block.motion.name[1:]))
    elif block.axes and state.motion == NO_MOTION:
        state.motion = 0
    state.feed = state.feed or 1.0
    state.speed = state.speed or 1.0
