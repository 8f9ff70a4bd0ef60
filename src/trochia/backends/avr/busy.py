"""Where a motion may ask much of a board, found quickly: only there its spans are worth making beforehand.

In: a motion, a board.  Out: stretches of rows in which the steps, each at the dearest it can be, might be too many,
with the feed overridden as well; and how fast its fastest motor is.

Legend: row, a few thousandths of a second of motion; cost, cycles of the chip.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.backends.avr.ahead import ROW, rows_of
from trochia.backends.avr.load import COSTS, FULL, PIXEL
from trochia.backends.avr.wiring import BOARDS, steps_per_unit
from trochia.pulses.steps import CLOCK

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from trochia.machine.machine import Machine
    from trochia.planner import Trajectory

MOST_FEED = 2.0  #: override of the feed
_AROUND = 25  #: rows before and behind a busy one that are taken with it
_STEADY = 50  #: rows of one speed after which it asks no more than before
_SAME = 1e-6  #: parts of a rate that tell no two apart
_SLOW = 1.0  #: a motor below that counts for none [steps/s]


@dataclass(frozen=True, slots=True)
class Stretch:
    """Some rows that follow each other.

    Attributes
    ----------
    times
        At which they begin, and the last ends [s].
    feed
        Whether a programmed feed rules each of them (rows,).
    on
        Whether what was left out before them asks as much as the end of the stretch before.
    """

    times: NDArray[np.float64]
    feed: NDArray[np.bool_]
    on: bool = False


@dataclass(slots=True)
class Fastest:
    """The greatest rates of one motor: of all, and where a programmed feed rules [steps/s]."""

    all: float = 0.0
    feed: float = 0.0


def stretches(trajectory: Trajectory, machine: Machine, board: str, fastest: Fastest) -> Iterator[Stretch]:
    """Yield the stretches that may be too much; ``fastest`` is filled on the way.

    Raises
    ------
    ConfigError
        When the machine is not one for this board.
    """
    scale = np.abs(steps_per_unit(machine, BOARDS[board].motors))
    turn = machine.kinematics.matrix.T * scale
    feeds = np.isfinite(trajectory.path.segments["speed_limit"])
    for times, _ in rows_of(trajectory):
        middles = 0.5 * (times[:-1] + times[1:])
        ends = np.abs(trajectory.velocity(times) @ turn)
        rates = np.maximum(np.maximum(ends[:-1], ends[1:]), np.abs(trajectory.velocity(middles) @ turn))
        feed = feeds[trajectory.states(middles)["segment"]]
        fastest.all = max(fastest.all, float(rates.max()))
        fastest.feed = max(fastest.feed, float(rates[feed].max(initial=0.0)))
        part = _dearest(rates, np.diff(times), board)
        much, steady = part * np.where(feed, MOST_FEED, 1.0) > FULL, _steady(ends)
        for first, last in _runs(_around(much & ~steady)):
            on = first > 0 and bool((much & steady)[first - 1])
            yield Stretch(times[first : last + 1], feed[first:last], on)


def _dearest(rates: NDArray[np.float64], lengths: NDArray[np.float64], board: str) -> NDArray[np.float64]:
    """Return what part of the processor's time each row asks for at most (rows,), each step with a bend of its own."""
    costs = COSTS[board]
    single = np.max(np.array(costs[:2]), axis=0)
    by_motors = np.array([single, single, *costs[2:]])
    cost = by_motors[np.minimum((rates > _SLOW).sum(axis=1), len(by_motors) - 1)]
    spans = (cost[:, 2] + PIXEL) / np.minimum(lengths, ROW)
    asked: NDArray[np.float64] = (rates.sum(axis=1) * (cost[:, 0] + cost[:, 1]) + spans) / CLOCK
    return asked


def _steady(ends: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return the rows (rows,) whose rates are those of all the many before: they ask what those have asked."""
    same = np.all(np.abs(np.diff(ends, axis=0)) <= _SAME * (1.0 + ends[1:]), axis=1)
    last = np.maximum.accumulate(np.where(same, -1, np.arange(len(same))))
    steady: NDArray[np.bool_] = np.arange(len(same)) - last > _STEADY
    return steady


def _around(busy: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the rows with their neighbours."""
    wide: NDArray[np.bool_] = np.convolve(busy, np.ones(2 * _AROUND + 1), mode="full")[_AROUND:-_AROUND] > 0.0
    return wide


def _runs(marked: NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """Yield first and one behind the last of each run of marked rows."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], marked, [False]]).astype(np.int8)))
    yield from zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)
