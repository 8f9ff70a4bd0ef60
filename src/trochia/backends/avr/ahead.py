"""The spans of a whole plan, before anything is sent.

In: a motion and a board.  Out: its spans as the board would be sent them, at 100 % feed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.backends.avr.spans import LONGEST, SpanMaker
from trochia.backends.avr.wiring import BOARDS, steps_per_unit
from trochia.backends.queue import Queue
from trochia.backends.segments import sampled
from trochia.pulses.steps import CLOCK

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from numpy.typing import NDArray

    from trochia.backends.avr.spans import Span
    from trochia.machine.machine import Machine
    from trochia.planner import Trajectory

ROW = 0.004  #: longest time of a row [s]
SHORTEST = 1e-6  #: rows that are shorter belong to the one before [s]
PIECE = 2048  #: rows taken at once
LEFT = 2 * LONGEST / CLOCK  #: motion in hand for a span to be as long as it can [s]
STEEPEST = 1000.0  #: greatest slew [1/s]: at rest any would do
_INSIDE = np.array([0.02, 0.5, 0.98])  #: where in a row its slew is looked at


def spans_ahead(trajectory: Trajectory, machine: Machine, board: str) -> Iterator[Span]:
    """Yield the spans of a motion; see :func:`spans_of`."""
    yield from spans_of(rows_of(trajectory), trajectory, machine, board)


def spans_of(
    rows: Iterable[tuple[NDArray[np.float64], bool]], trajectory: Trajectory, machine: Machine, board: str
) -> Iterator[Span]:
    """Yield the spans of a stretch of a motion, from tick 0 on, by the times at which its rows begin and end.

    Raises
    ------
    ConfigError
        When the machine is not one for this board.
    LimitError
        For steps of a motor that are closer than the board can make them.
    """
    kind = BOARDS[board]
    full = machine.beam.full_power if machine.beam else 1.0
    maker = SpanMaker(
        steps_per_unit(machine, kind.motors), CLOCK,
        lambda power: round(255 * min(max(power / full, 0.0), 1.0)), kind.closest,
    )  # fmt: skip
    matrix = machine.kinematics.matrix
    queue: Queue | None = None
    for times, last in rows:
        if queue is None:
            start = trajectory.position(times[:1])[0] @ matrix.T
            queue, maker.offset = Queue(start), start.copy()
            maker.restart(float(times[0]))
        queue.add(sampled(trajectory, matrix, times, _slews(trajectory, times)), float(times[0]), maker.time(maker.at))
        while last or queue.end - maker.time(maker.at) > LEFT:
            span = maker.make(queue, [], lambda _: 0)
            if span is None:
                break
            yield span
        queue.forget(maker.time(maker.at) - ROW)


def rows_of(trajectory: Trajectory) -> Iterator[tuple[NDArray[np.float64], bool]]:
    """Yield the times at which rows begin, and where the last one ends [s], piece by piece; whether it is the last."""
    kept = np.zeros(0)
    for phases in trajectory.planned_blocks():
        counts = np.maximum(np.ceil(phases["duration"] / ROW - 1e-9), 1).astype(np.intp)
        phase = np.repeat(np.arange(len(counts)), counts)
        within = np.arange(len(phase)) - np.repeat(np.cumsum(counts) - counts, counts)
        kept = np.concatenate([kept, phases["t"][phase] + within * (phases["duration"] / counts)[phase]])
        kept = kept[np.append(True, np.diff(kept) > SHORTEST)]
        while len(kept) > PIECE + 1:
            yield kept[: PIECE + 1], False
            kept = kept[PIECE:]
    kept = np.append(kept[kept < trajectory.duration - SHORTEST], trajectory.duration)
    if len(kept) > 1:
        yield kept, True


def _slews(trajectory: Trajectory, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how fast the rate may fall in each row so that every acceleration stays within its limit [1/s]."""
    limits, h = trajectory.limits, np.diff(times)
    at = (times[:-1, None] + h[:, None] * _INSIDE).ravel()
    v, a = trajectory.velocity(at) @ limits.matrix.T, trajectory.acceleration(at) @ limits.matrix.T
    most = limits.acceleration_at(np.abs(v))
    room = np.where(v * a < 0.0, most - np.abs(a), most)
    with np.errstate(divide="ignore", invalid="ignore"):
        slew = np.where(np.abs(v) > 1e-9, np.maximum(room, 0.0) / np.abs(v), STEEPEST)
    return np.minimum(slew.min(axis=1).reshape(len(h), -1).min(axis=1), STEEPEST)
