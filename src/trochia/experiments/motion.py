"""First acquaintance with an axis nobody knows: its inertia from pulses, a soft loop, friction at steady speeds.

In: an axis and its bounds.  Out: estimates.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from trochia.analysis.identification.estimate import Estimate, least_squares
from trochia.analysis.identification.inverse_dynamics import inverse_dynamics
from trochia.errors import LimitError, RecordingError
from trochia.experiments.perform import joined, perform, powered
from trochia.experiments.signals import change_speed, end_of, parabolic, steady
from trochia.servo import Loop, Pid

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from trochia.experiments.protocol import AxisUnderTest, Bounds
    from trochia.kernels.servo import ServoSamples

    Array = NDArray[np.float64]

_LOOK = 2e-3  # how often a pulse looks where it is [s]
_ABOVE = 2.5  # times the command that moved it
_RAMP = 0.5  # time of a change of speed [s]


class Pulse(NamedTuple):
    """What torque pulses tell: inertia of all that moves, and the torque from which on it did."""

    inertia: float
    torque: float


def feel(axis: AxisUnderTest, bounds: Bounds, *, reach: float, first: float, most_time: float = 0.5) -> Pulse:
    """Return the inertia, by pushing on and back ever more strongly until the axis moves.

    J = 2 T / (acceleration when driven - acceleration when braked): friction cancels.

    Parameters
    ----------
    reach
        How far it may go for this.
    first
        Command of the first pulse; each next is half as much again.

    Raises
    ------
    LimitError
        When the axis does not move within its bounds.
    """
    command, moved = first, 0.0
    while command <= bounds.command:
        accelerations = _pulse(axis, bounds, command, reach, most_time)
        if accelerations is not None:
            moved = moved or command
            forth, back = accelerations
            # well above friction, which else stops it before the brake can tell anything
            if command >= _ABOVE * moved and forth > 0.0 > back:
                return Pulse(2.0 * command * axis.torque / (forth - back), moved * axis.torque)
        command *= 1.5
    raise LimitError(f"the axis does not move under a command of {bounds.command:.4g}",
                     hint="Is it clamped, or the drive not on?  Else allow more command.")  # fmt: skip


def _pulse(
    axis: AxisUnderTest, bounds: Bounds, command: float, reach: float, most_time: float
) -> tuple[float, float] | None:
    """Return the accelerations when driven and braked; None where the axis hardly moved."""
    ticks = max(8, round(_LOOK / axis.period))
    start, there = axis.position, np.tile([axis.position, 0.0, 0.0], (ticks, 1))
    if not (bounds.low + reach <= start <= bounds.high - reach):
        raise LimitError(f"{reach:.4g} of way on either side are needed; the axis is at {start:.4g}",
                         hint="Nothing has moved.  Move away from the end of travel.")  # fmt: skip
    driven: list[ServoSamples] = []
    braked: list[ServoSamples] = []
    with powered(axis, Loop(period=axis.period)):
        while abs(axis.position - start) < 0.4 * reach and len(driven) * ticks * axis.period < most_time:
            driven.append(axis.advance(there, np.full(ticks, command)))
            bounds.watch(driven[-1])
        if abs(axis.position - start) < 0.2 * reach:
            return None
        before = -math.inf
        while len(braked) < 2 * len(driven) and axis.position > before:
            before = axis.position
            braked.append(axis.advance(there, np.full(ticks, -command)))
            bounds.watch(braked[-1])
    # the last look at the brake may hold the turn, where friction changes its sign
    one, two = (joined(part[: max(2, len(part) - 1)]).measured for part in (driven, braked))
    return _acceleration(one, axis.period), _acceleration(two, axis.period)


def _acceleration(position: Array, period: float) -> float:
    t = period * np.arange(len(position))
    return float(2.0 * np.polyfit(t, position, 2)[0])


def soft_loop(inertia: float, axis: AxisUnderTest, bounds: Bounds, *, bandwidth: float = 4.0) -> Loop:
    """Return a loop of a low bandwidth [Hz] that an inertia alone suffices for.

    Seen from the motor a resonance does not make it unstable as long as its delays are short.
    """
    w = 2.0 * math.pi * bandwidth
    gain = inertia * w / axis.torque
    return Loop(period=axis.period, position=Pid(kp=w / 4.0), speed=Pid(kp=gain, ki=gain * w / 4.0,
                limit=bounds.command), speed_forward=1.0, averaged=4, limit=bounds.command)  # fmt: skip


def go(axis: AxisUnderTest, loop: Loop, bounds: Bounds, to: float, *, speed: float) -> None:
    """Move to a position, no faster than a speed."""
    distance = to - axis.position
    duration = max(1.5 * abs(distance) / speed, 0.3)
    move = parabolic(axis.position, distance, duration, axis.period)
    perform(axis, loop, bounds, np.concatenate([move, np.repeat(move[-1:], round(0.3 / axis.period), axis=0)]))


def out_and_back(axis: AxisUnderTest, loop: Loop, bounds: Bounds, distance: float, duration: float) -> Estimate:
    """Return inertia and friction from a move out and back, by inverse dynamics."""
    there = parabolic(axis.position, distance, duration, axis.period)
    back = parabolic(axis.position + distance, -distance, duration, axis.period)
    samples = perform(axis, loop, bounds, np.concatenate([there, back] * 2))
    return inverse_dynamics(samples.measured, samples.command * axis.torque, axis.period, cutoff=15.0)


def steady_speeds(
    axis: AxisUnderTest, loop: Loop, bounds: Bounds, speeds: Sequence[float], *, settle: float = 1.0,
    listen: float = 1.0,
) -> Estimate:  # fmt: skip
    """Return Coulomb and viscous friction and offset, from the mean command at steady speeds both ways.

    Raises
    ------
    LimitError
        As :func:`~trochia.experiments.perform.perform`.
    """
    settling, listening = (round(seconds / axis.period) for seconds in (settle, listen))
    ramp = round(_RAMP / axis.period)
    seen: list[tuple[float, float]] = []
    for speed in [s for size in speeds for s in (size, -size)]:
        up = change_speed(axis.position, 0.0, speed, ramp, axis.period)
        even = steady(end_of(up, axis.period), speed, settling + listening, axis.period)
        down = change_speed(end_of(even, axis.period), speed, 0.0, ramp, axis.period)
        samples = perform(axis, loop, bounds, np.concatenate([up, even, down]))
        part = slice(ramp + settling, ramp + settling + listening)
        if np.abs(samples.command[part]).max() >= min(loop.limit, bounds.command):
            raise RecordingError(f"at {speed:.4g} the command is at its limit: nothing can be said of friction there",
                                 hint="Ask for slower speeds.")  # fmt: skip
        way = samples.measured[part]
        seen.append(((way[-1] - way[0]) / ((listening - 1) * axis.period),
                     float(samples.command[part].mean()) * axis.torque))  # fmt: skip
    rows = np.array(seen)
    columns = np.stack([rows[:, 0], np.sign(rows[:, 0]), np.ones(len(rows))], axis=1)
    names = (("viscous", "N·m·s/rad"), ("coulomb", "N·m"), ("offset", "N·m"))
    return least_squares(columns, rows[:, 1], names, "friction")
