"""A path built piece by piece.  In: blocks of a program, as an interpreter yields them.  Out: stretches of its path.

What a joint becomes depends on a few moves around it, and where Q merges lines, on where the run began.  So a piece is
built with :data:`REACH` runs before and behind it, from the beginning of a run, and what lies there is thrown away.
Where chords grow evenly, one blend can depend on the last for hundreds of them: so the first segment of each piece is
compared with what the piece before had made of it, and where they differ, it is built once more with a long history.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import deque
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import PlanningError
from trochia.kernels.path import Room
from trochia.planner.corners import path_of
from trochia.planner.live.held import Held
from trochia.planner.live.road import Stretch
from trochia.planner.rests import rests_of
from trochia.program import MoveKind, Program, Spindle

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from numpy.typing import NDArray

    from trochia.machine.machine import Machine
    from trochia.planner.schedule import Profile
    from trochia.program import Action
    from trochia.toolpath import Toolpath

REACH = 64  #: runs on either side that a joint may depend on, with much room
HISTORIES = (REACH, 512, 4_096)  #: runs before a piece that it is built with, the first that will do
_CHUNK = 16_384  #: moves at a time: their path stays in the cache
_SAME = 1e-9  #: mm, degree
_FIRST = 1_024  #: and at the start, so that motion begins soon
_GROWTH = 4  #: times the moves of the piece before


def pave(blocks: Iterable[Program], machine: Machine, profile: Profile, *, room: Room | None = None
         ) -> Iterator[Stretch]:  # fmt: skip
    """Yield the path of a program whose blocks follow each other; each counts moves and actions from its own start.

    A stretch is gone when the next one is asked for, but for the coefficients where the room's keeper keeps them.

    Raises
    ------
    PlanningError, LimitError
        As :func:`trochia.planner.corners.path_of`.
    """
    return _Paver(machine, profile, room or Room()).run(iter(blocks))


class _Paver:
    """Moves in hand: those not yet built, and those before them that are needed to build on."""

    def __init__(self, machine: Machine, profile: Profile, room: Room) -> None:
        self._machine, self._profile = machine, profile
        self._held, self._room = Held(), room
        self._program: Program | None = None
        self._splines: NDArray[np.float64] = np.zeros((0, 4, 3))  # those of the moves in hand
        self._actions: list[Action] = []  # `at` counts from the program's start
        self._done = 0  # all that moves before this one have become is out
        self._starts = [0] * len(HISTORIES)  # moves at which runs begin, that the next piece can be built from,
        self._level = 0  # and which of them is taken
        self._seam: tuple[float, NDArray[np.float64]] | None = None  # what the next piece must begin with
        self._spindle: Spindle | None = None  # as it turns at the first move in hand

    def run(self, blocks: Iterator[Program]) -> Iterator[Stretch]:
        size = _FIRST
        self._room.reserve(_CHUNK + 4 * REACH, len(self._machine.axes), self._profile.continuity)
        for block in blocks:
            actions, first, count = deque(block.actions), 0, len(block.moves)
            self._begin(block)
            while True:
                wanted = max(self._done + size + 2 * REACH - self._held.end, 1)
                end = min(first + wanted, count)
                self._take(block, first, end, actions)
                first = end
                if self._held.end - self._done >= size + 2 * REACH:
                    stretch = self._build(last=False)
                    size = min(_GROWTH * size, _CHUNK) if stretch else _GROWTH * size
                    if stretch is not None:
                        yield stretch
                if first == count:
                    break
        if self._program is not None and (stretch := self._build(last=True)) is not None:
            yield stretch

    def _begin(self, block: Program) -> None:
        if self._program is None:
            self._program = replace(block, moves=block.moves[:0], actions=(), splines=block.splines[:0])

    def _take(self, block: Program, first: int, end: int, actions: deque[Action]) -> None:
        """Take the moves ``first`` up to ``end`` of a block, and off its actions those that stand before them."""
        base = self._held.end - first
        while actions and (actions[0].at < end or end == len(block.moves)):
            action = actions.popleft()
            self._actions.append(replace(action, at=action.at + base))
        moves = block.moves
        if len(block.splines):
            own = _own_splines(replace(block, moves=moves[first:end]), len(self._splines))
            self._splines = np.concatenate([self._splines, own.splines])
            moves, first, end = own.moves, 0, end - first
        self._held.take(moves, first, end)

    def _build(self, *, last: bool) -> Stretch | None:
        """Return what can be said of the moves in hand; None where that is nothing."""
        program, path, first = self._path(self._starts[self._level])
        while not self._fits(path, first):
            if self._level + 1 == len(self._starts):
                raise PlanningError("the path cannot be built piece by piece: its joints depend on too many before")
            self._level += 1
            program, path, first = self._path(self._starts[self._level])
        moves, base = path.segments["move"], self._starts[self._level]
        ahead = moves[first:first] if last else _runs_from_end(moves[first:], 2 * REACH + 1)
        run = int(ahead[-REACH]) if len(ahead) > 2 * REACH else None
        if run is None and not last:
            return None
        cut = len(program.moves) + 1 if run is None else run
        end = len(path) if run is None else bisect_left(moves, cut)
        stretch = self._stretch(program, path, first, end, last=last, base=base)
        if not last:
            self._seam, self._done = _look(path, end), base + cut
            runs = _runs_from_end(moves[:end], HISTORIES[-1])
            self._starts = [self._starts[-1] if k > len(runs) else base + int(runs[-k]) for k in HISTORIES]
            self._drop()
        return stretch

    def _path(self, base: int) -> tuple[Program, Toolpath, int]:
        """Return the moves in hand from ``base`` on as a program, its path, and its first segment that is not out."""
        assert self._program is not None, "a path is built of at least one block"
        held, moves = self._held, self._held.since(base)
        turning = [a for a in self._actions if isinstance(a, Spindle) and a.at < base]
        before = [turning[-1]] if turning else [self._spindle] if self._spindle else []
        actions = [replace(a, at=max(a.at - base, 0)) for a in (*before, *(a for a in self._actions if a.at >= base))]
        start = self._program.start if base == held.base else held.since(base - 1)["target"][0].copy()
        program = replace(self._program, start=start, moves=moves, actions=tuple(actions), splines=self._splines)
        program = _own_splines(program, 0) if len(self._splines) else program
        path = path_of(program, self._machine, self._profile, room=self._room, first_row=base)
        return program, path, bisect_left(path.segments["move"], max(self._done - base, 0))

    def _fits(self, path: Toolpath, first: int) -> bool:
        """Return whether a piece begins with what the one before said would come."""
        if self._seam is None or first == len(path):
            return True
        length, head = _look(path, first)
        return bool(abs(length - self._seam[0]) <= _SAME and (np.abs(head - self._seam[1]) <= _SAME).all())

    def _stretch(self, program: Program, path: Toolpath, first: int, end: int, *, last: bool,
                 base: int) -> Stretch:  # fmt: skip
        rests = rests_of(program, self._machine, path)
        kept = (rests.segments >= first) & ((rests.segments < end) | last)
        rows = path.segments[first:end]
        low = int(rows["data"][0]) if len(rows) else 0
        high = int(path.segments["data"][end]) if end < len(path) else len(path.pool)
        return Stretch(segments=rows, pool=path.pool[low:high], moves=program.moves, first_move=base,
                       rests=rests.segments[kept] - np.uint64(first), seconds=rests.seconds[kept],
                       start=path.start)  # fmt: skip

    def _drop(self) -> None:
        """Drop the moves that no further piece is built from."""
        base, held = self._starts[-1], self._held
        if base == held.base:
            return
        assert self._program is not None, "moves are dropped of a program"
        turning = [a for a in self._actions if isinstance(a, Spindle) and a.at < base]
        self._spindle = turning[-1] if turning else self._spindle
        self._actions = [action for action in self._actions if action.at >= base]
        self._program = replace(self._program, start=held.since(base - 1)["target"][0].copy())
        held.drop(base)
        if len(self._splines):
            kept = _own_splines(replace(self._program, moves=held.since(base), splines=self._splines), 0)
            self._held, self._splines = Held.of(kept.moves, base), kept.splines


def _runs_from_end(moves: NDArray[np.uint32], count: int) -> NDArray[np.uint32]:
    """Return the last ``count`` or more of numbers that rise or stay, each once; all, where there are not so many."""
    look, most = 2 * count, len(moves)
    while True:
        runs = _runs(moves[max(most - look, 0) :])
        if len(runs) >= count or look >= most:
            return runs
        look *= 4


def _runs(moves: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """Return each of some numbers that rise or stay once."""
    fresh = np.ones(len(moves), dtype=np.bool_)
    np.not_equal(moves[1:], moves[:-1], out=fresh[1:])
    return moves[fresh]


def _own_splines(program: Program, first: int) -> Program:
    """Return a program with only the splines its moves follow, numbered from ``first``."""
    moves = program.moves.copy()
    curved = moves["kind"] == MoveKind.SPLINE
    used, rows = np.unique(moves["turns"][curved], return_inverse=True)
    moves["turns"][curved] = rows + first
    return replace(program, moves=moves, splines=program.splines[used])


def _look(path: Toolpath, row: int) -> tuple[float, NDArray[np.float64]]:
    """Return length and first coefficients of a segment."""
    at = int(path.segments["data"][row])
    return float(path.segments["length"][row]), path.pool[at : at + 2 * len(path.axes)].copy()
