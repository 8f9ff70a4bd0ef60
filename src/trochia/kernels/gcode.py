"""Plain G-code lines into rows, rows into canonical text: the face of ``core/host/gcode.h``.

In: the bytes of a program and the modal state.  Out: batches of rows, moves in program units and coordinates, with
rows for comments, F and S words among them.  numpy is imported only where rows are wanted as an array, because the
whole of ``trochia canon`` on a short program is the start of the process.
"""

from __future__ import annotations

from struct import Struct
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, cast

from trochia._core import ffi, lib

if TYPE_CHECKING:
    from collections.abc import Iterator, MutableSequence
    from mmap import mmap

    from numpy.typing import NDArray

SPEED_ROW = 253  #: kind of a row that is an S word
COMMENT_ROW = 254  #: kind of a row that is a comment
FEED_ROW = 255  #: kind of a row that is an F word
OTHER_MOTION = 255  #: ``Modal.motion`` where axis words without G0-G3 on the line are not plain
STOP_END, STOP_LINE, STOP_FULL = range(3)  #: why reading stopped: end of text, a line that is not plain, no more room

_MOVE = Struct("=9d2dd2dfiIBBBB")  # trochia_move
_CAPACITY = 4096  # rows a batch: rows and their text stay in the second-level cache
_ROWS_PER_LINE = 4
_TEXT_PER_ROW = 512
_unset = ffi.new_allocator(should_clear_after_alloc=False)  # C writes what is read; most programs need little of it


class Modal(Protocol):
    """The C struct ``trochia_modal``: what plain lines depend on and change; program units and coordinates.

    ``position`` (9,), ``feed`` per minute, ``speed`` as S gave it, ``least_radius``, ``spiral``, ``spiral_share`` and
    ``spiral_most`` of arcs,
    ``offset`` of the first unread byte and the number of the ``line`` there, ``axes`` as a mask of allowed axis words,
    ``motion`` 0-3 or OTHER_MOTION, ``plane``, ``incremental`` (G91), ``centre_absolute`` (G90.1), and ``stop``.
    """

    position: MutableSequence[float]
    feed: float
    speed: float
    least_radius: float
    spiral: float
    spiral_share: float
    spiral_most: float
    offset: int
    line: int
    axes: int
    motion: int
    plane: int
    incremental: int
    centre_absolute: int
    stop: int


class PlainRow(NamedTuple):
    """A row as Python values: its kind, its target (9), centre, rate, turns, and source line."""

    kind: int
    target: list[float]
    centre: tuple[float, float]
    rate: float
    turns: int
    line: int


class Rows:
    """A batch of rows of one text; valid until its reader reads on."""

    __slots__ = ("_count", "_out", "_rows", "_text")

    def __init__(self, rows: Any, count: int, text: Any, out: Any) -> None:  # noqa: ANN401 - cffi arrays
        self._rows, self._count, self._text, self._out = rows, count, text, out

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, index: int) -> Any:  # noqa: ANN401 - a C struct with the fields of trochia_move
        """Return one row, with the fields of ``trochia_move`` as attributes."""
        if not 0 <= index < self._count:
            raise IndexError(index)
        return self._rows[index]

    def array(self) -> NDArray[Any]:
        """Return the rows as a structured array of ``MOVE`` (rows,), without copying."""
        import numpy as np  # noqa: PLC0415 - see the module's text

        from trochia.kernels.layout import MOVE  # noqa: PLC0415 - likewise

        return np.frombuffer(ffi.buffer(self._rows, self._count * MOVE.itemsize), dtype=MOVE)

    def values(self) -> Iterator[PlainRow]:
        """Yield the rows as Python values; ten times faster than one by one by their index."""
        buffer = ffi.buffer(self._rows, self._count * _MOVE.size)
        for x, y, z, a, b, c, u, v, w, first, second, rate, _, _, _, turns, line, kind, *_ in _MOVE.iter_unpack(buffer):
            yield PlainRow(kind, [x, y, z, a, b, c, u, v, w], (first, second), rate, turns, line)

    def comment(self, index: int) -> str:
        """Return the text of a comment row; plain comments are ASCII."""
        row = self[index]
        start = int(row.target[0])
        return bytes(ffi.buffer(self._text + start, row.turns)).decode("ascii")

    def canon(self, first: int = 0) -> tuple[bytes, int]:
        """Return canonical text of rows from ``first`` on, and the index of the first row C leaves to Python.

        That is ``len(rows)`` unless a number of 1e11 or more is in the way.
        """
        if not 0 <= first <= self._count:
            raise IndexError(first)
        done = ffi.new("uint64_t *")
        size = lib.trochia_canon_format(
            self._rows + first, self._count - first, self._text, len(self._text), self._out, len(self._out), done
        )
        return bytes(ffi.buffer(self._out, size)), first + done[0]


class PlainReader:
    """Walks the plain lines of one text; ``modal`` says where and in which modes.

    Parameters
    ----------
    text
        The whole program; its buffer is kept.
    capacity
        Greatest number of rows a batch holds (at least 4: a line makes up to four).

    """

    __slots__ = ("_out", "_rows", "_text", "modal")

    def __init__(self, text: bytes | mmap, capacity: int = _CAPACITY) -> None:
        if capacity < _ROWS_PER_LINE:
            raise ValueError(f"a batch must hold at least {_ROWS_PER_LINE} rows, not {capacity}")
        self._text = ffi.from_buffer("uint8_t[]", text)
        self._rows = _unset("trochia_move[]", capacity)
        self._out = _unset("uint8_t[]", capacity * _TEXT_PER_ROW)
        self.modal = cast("Modal", ffi.new("trochia_modal *"))

    def read(self) -> Rows:
        """Consume plain lines from ``modal.offset`` on and return their rows; ``modal.stop`` says why it stopped."""
        modal = self.modal
        if modal.offset > len(self._text):
            raise ValueError(f"offset {modal.offset} lies behind the text's {len(self._text)} bytes")
        if not 0 <= modal.plane <= 2:
            raise ValueError(f"there is no plane {modal.plane}")
        count = lib.trochia_gcode_plain(self._text, len(self._text), modal, self._rows, len(self._rows))
        return Rows(self._rows, count, self._text, self._out)
