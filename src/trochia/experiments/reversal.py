"""Slow reversals, and the run against a limit switch: what a gap does to an axis with an encoder on its motor.

In: an axis, a loop, bounds.  Out: set-points and samples, or counts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from trochia.analysis.identification.backlash import gap_by_switch
from trochia.errors import LimitError
from trochia.experiments.perform import perform, powered
from trochia.experiments.signals import end_of, steady

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.experiments.protocol import AxisUnderTest, Bounds
    from trochia.servo.axis import Loop

    Array = NDArray[np.float64]

_REST = 0.5  # of standstill behind a brake [s]


class Reversals(NamedTuple):
    """Set-points (ticks, 3), where the motor was (ticks,), and the tick of the first turn."""

    wanted: Array
    measured: Array
    first: int


def reversals(
    axis: AxisUnderTest, loop: Loop, bounds: Bounds, *, speed: float, way: float, times: int = 4
) -> Reversals:
    """Go to and fro at an even speed; each turn crosses the gap.  The first way is twice as long, to settle."""
    ticks, place = round(way / speed / axis.period), axis.position
    parts: list[Array] = []
    for turn in range(times):
        parts.append(steady(place, -speed if turn % 2 else speed, ticks if turn else 2 * ticks, axis.period))
        place = end_of(parts[-1], axis.period)
    wanted = np.concatenate(parts)
    samples = perform(axis, loop, bounds, wanted)
    return Reversals(wanted, samples.measured, len(parts[0]))


class SwitchRun(NamedTuple):
    """Ways of the motor at the limit switch, and the gap they give."""

    slip: float
    back_length: float
    gap: float


def at_switch(axis: AxisUnderTest, loop: Loop, bounds: Bounds, *, speed: float, wind_up: float = 0.0) -> SwitchRun:
    """Run towards the limit until its switch closes, brake, and go back until it opens (the leadscrew's procedure).

    slip is the way from closing to standstill, back_length the way back; the gap is their difference, less the twist
    that friction gives the train.

    Raises
    ------
    LimitError
        When no switch closes within the bounds, or it does not open again.
    """
    with powered(axis, loop):
        closed = _until(axis, bounds, speed, closed=True)
        rest = steady(closed, 0.0, round(_REST / axis.period), axis.period)
        bounds.watch(axis.advance(rest))
        stood = axis.position
        opened = _until(axis, bounds, -speed, closed=False)
    slip, back = stood - closed, stood - opened
    return SwitchRun(slip, back, gap_by_switch(back, slip, wind_up=wind_up))


def _until(axis: AxisUnderTest, bounds: Bounds, speed: float, *, closed: bool) -> float:
    """Run tick by tick until the switch is as asked, and return where the motor was."""
    start, tick = axis.position, 0
    while axis.limit_closed is not closed:
        wanted = steady(start + speed * tick * axis.period, speed, 1, axis.period)
        if not bounds.low <= wanted[0, 0] <= bounds.high:
            raise LimitError(f"the limit switch did not {'close' if closed else 'open'} within the travel",
                             hint="Is it connected, and the travel to it inside the bounds?")  # fmt: skip
        bounds.watch(axis.advance(wanted))
        tick += 1
    return axis.position
