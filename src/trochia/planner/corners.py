"""Corners that cost more time passed than stopped at.  In: a Program, its machine, a profile.  Out: a Toolpath.

What a corner is worth is first decided beside it alone, where the path is made.  But how fast motion comes to it, and
goes on, depends on what lies around.  Between two stops of a path, motion does not depend on the rest of it: so each
such *section* of few moves is planned by itself, blended and with a stop at every corner, and takes the quicker form.
A section says nothing of another, and so a path that is built piece by piece comes out the same.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from trochia.planner.limits import Limits
from trochia.planner.rests import Rests
from trochia.program import Dwell, MoveKind, PathMode
from trochia.toolpath import Toolpath, build, rests_before

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.kernels.path import Room
    from trochia.machine.machine import Machine
    from trochia.planner.schedule import Profile
    from trochia.program import Program

MOST = 48  #: moves of a section that is weighed: longer ones gain from passing, and a piece built by itself knows them
SAME = 1e-10  #: part of a time by which a section is slower only by rounding
_ROUNDS = 4  #: a joint between two sections may leave more room once one of them stops


def path_of(
    program: Program, machine: Machine, profile: Profile, *, room: Room | None = None, first_row: int = 0
) -> Toolpath:
    """Return the path of a program for a profile, with stops where passing the corners between two stops is slower.

    Parameters
    ----------
    room, first_row
        As in :func:`trochia.toolpath.build`.

    Raises
    ------
    PlanningError, LimitError
        As :func:`trochia.toolpath.build`; LimitError also where the machine lacks what the profile needs.
    """
    path = build(program, machine, continuity=profile.continuity, room=room, first_row=first_row)
    for _ in range(_ROUNDS):
        slower = _slower(program, machine, profile, path)
        if not slower.any():
            break
        moves = program.moves.copy()
        moves["path_mode"][slower] = PathMode.EXACT_PATH
        program = replace(program, moves=moves)
        path = build(program, machine, continuity=profile.continuity, room=room, first_row=first_row)
    return path


def paced(path: Toolpath, limits: Limits) -> Toolpath:
    """Return the path with no segment faster than the drive takes it: at most its length over the least time."""
    if not limits.segment_time > 0.0:
        return path
    segments = path.segments.copy()
    np.minimum(segments["speed_limit"], segments["length"] / limits.segment_time, out=segments["speed_limit"])
    return replace(path, segments=segments)


def _slower(program: Program, machine: Machine, profile: Profile, path: Toolpath) -> NDArray[np.bool_]:
    """Return which moves are blended in a section that takes less time with stops (moves,)."""
    slower = np.zeros(len(program.moves), dtype=np.bool_)
    firsts, bounds = _sections(path, len(slower))
    weighed = np.diff(bounds) <= MOST
    if not weighed.any():
        return slower
    blended = _blended(program, machine)
    own = weighed & (np.diff(np.concatenate([[0], np.cumsum(blended)])[bounds]) > 0)
    if not own.any():
        return slower
    beside = np.concatenate([[False], own, [False]])  # a line that Q has bent may have made the stop between two
    weighed &= own | beside[2:] | beside[:-2]
    owner = np.repeat(np.arange(len(firsts)), np.diff(np.append(firsts, len(path))))
    kept = weighed[owner]
    limits = Limits.of(machine, motors=profile.by_curves)
    number = np.cumsum(weighed) - 1
    passing = _times(replace(path, segments=path.segments[kept]), number[owner[kept]], profile, limits)
    begins, ends = bounds[:-1][weighed], bounds[1:][weighed]
    stopping, joined = _stopping(program, machine, profile, np.stack([begins, ends]), limits)
    group = np.cumsum(np.concatenate([[True], ~joined[:-1]])) - 1
    lost = np.bincount(group, passing) > np.bincount(group, stopping) * (1.0 + SAME)
    lost &= np.bincount(group, ends - begins) <= MOST
    for begin, end in zip(begins[lost[group]], ends[lost[group]], strict=True):
        slower[begin:end] = blended[begin:end]
    return slower


def _blended(program: Program, machine: Machine) -> NDArray[np.bool_]:
    """Return which moves may be blended with others (moves,)."""
    mode = program.moves["path_mode"]
    return (mode == PathMode.BLEND) | ((mode == PathMode.BLEND_DEFAULT) & (machine.path_tolerance > 0.0))


def _sections(path: Toolpath, moves: int) -> tuple[NDArray[np.intp], NDArray[np.int64]]:
    """Return the first segment of each section (k,), and the moves between which they lie (k + 1,)."""
    firsts = np.flatnonzero(np.concatenate([[True], path.segments["stop"][:-1] != 0])[: len(path)])
    return firsts, np.append(path.segments["move"][firsts].astype(np.int64), moves)


def _times(path: Toolpath, owner: NDArray[np.intp], profile: Profile, limits: Limits) -> NDArray[np.float64]:
    """Return the time each section takes (k,) [s]; ``owner`` says to which each segment belongs, in order."""
    nothing = Rests(segments=np.zeros(0, dtype=np.uint64), seconds=np.zeros(0), times={})
    times = np.zeros(int(owner[-1]) + 1)
    for phases in profile(paced(path, limits), limits, nothing).phases(1 << 16):
        times += np.bincount(owner[phases["segment"]], phases["duration"], len(times))
    return times


def _stopping(program: Program, machine: Machine, profile: Profile, edges: NDArray[np.int64],
              limits: Limits) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:  # fmt: skip
    """Return the time of each section, from the first of its moves up to the second (2, k), with stops (k,) [s].

    And whether it then goes on into the next one (k,): where Q has bent a line so that it begins with a corner.
    """
    begins, ends = edges
    led = np.concatenate([[True], begins[1:] != ends[:-1]])  # by a move that is not counted
    heads = np.concatenate([[0], np.cumsum(ends - begins + led)])
    number = np.repeat(np.arange(len(begins)), np.diff(heads))
    inside = np.arange(heads[-1]) - heads[number]
    rows, leading = begins[number] - led[number] + inside, led[number] & (inside == 0)
    moves = program.moves[np.maximum(rows, 0)]
    moves["path_mode"][moves["path_mode"] != PathMode.EXACT_STOP] = PathMode.EXACT_PATH
    moves["kind"][leading], moves["path_mode"][leading] = MoveKind.RAPID, PathMode.EXACT_STOP
    if begins[0] == 0:
        moves["target"][0] = program.start
    still = led | (rests_before(program, machine)[begins] != 0)
    at = np.sort(np.concatenate([heads[:-1][still], heads[:-1][led] + 1])).tolist()
    alone = replace(program, moves=moves, actions=tuple(Dwell(at=row, line=0, seconds=0.0) for row in at))
    path = build(alone, machine, continuity=profile.continuity)
    kept = ~leading[path.segments["move"]]
    segments = path.segments[kept]
    owner = number[segments["move"]]
    last = np.searchsorted(owner, np.arange(len(begins)), side="right") - 1
    joined = (segments["stop"][last] == 0) & ~np.append(led[1:], True)
    return _times(replace(path, segments=segments), owner, profile, limits), joined
