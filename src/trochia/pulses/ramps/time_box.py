"""A move that must end in a given time: the deceleration (or both ramps alike) that makes it so (S1-F44).

In: a demand, a law and a time.  Out: the demand with accelerations that meet it.  The whole time falls as the
deceleration grows, so the law itself is asked until the time fits.  The source counts the time left from the symmetric
braking point while braking begins later, and so ends late (S1 section 6, item 6).
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from trochia.errors import LimitError
from trochia.pulses.ramps.demand import shown_up

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.pulses.ramps.demand import Demand

_ROUNDS = 40  # of halving the logarithm: to 4e-11 of the acceleration
_WIDEST = 1e12  # steps/s²: an acceleration that is none any more


def into_box(demand: Demand, duration: Callable[[Demand], float], time: float) -> Demand:
    """Return the demand with the accelerations that end the move as near to ``time`` [s] as the law can.

    A given acceleration is kept and the deceleration chosen; without one both ramps are alike.

    Raises
    ------
    LimitError
        When no deceleration, however great, ends in time; it names what would do.
    """
    if not 0.0 < time < math.inf:
        raise LimitError(f"a time box must be more than 0 s, not {time:g} s")
    shortest = demand.steps / demand.speed
    if time <= shortest:
        raise LimitError(
            f"{demand.steps} steps in {time:g} s is {demand.said(demand.steps / time)} all the way, and the speed is "
            f"limited to {demand.said(demand.speed)}",
            hint=f"{_in_time(demand)} would do, or a motor that runs well above {demand.said(demand.steps / time)}.",
        )
    if demand.acceleration is None:
        return _solved(lambda a: replace(demand, acceleration=a, deceleration=a), duration, time)
    best = duration(replace(demand, deceleration=_WIDEST))
    if best > time:
        alike = _solved(lambda a: replace(demand, acceleration=a, deceleration=a), duration, time)
        raise LimitError(
            f"{demand.steps} steps do not end in {time:g} s with an acceleration of "
            f"{demand.said_acceleration(demand.acceleration)}: braking in no time at all they take {best:.4g} s",
            hint=f"{shown_up(alike.rising)} steps/s² ({shown_up(alike.rising * demand.step_angle)} rad/s²) up and down "
            f"would do; with the acceleration asked for, {_in_time(demand)}.",
        )
    return _solved(lambda a: replace(demand, deceleration=a), duration, time)


def _in_time(demand: Demand) -> str:
    """Return a time that is met at this speed: with the acceleration given up and down, else a third each for ramps."""
    shortest = demand.steps / demand.speed
    with_ramps = shortest + demand.speed / demand.acceleration if demand.acceleration else 1.5 * shortest
    return f"{shown_up(with_ramps)} s"


def _solved(made: Callable[[float], Demand], duration: Callable[[Demand], float], time: float) -> Demand:
    """Return the demand whose duration is nearest to ``time``, by halving the logarithm of the acceleration."""
    low, high = 1e-6, _WIDEST
    if duration(made(low)) < time:  # the slowest ramp there is still ends early
        return made(low)
    for _ in range(_ROUNDS):
        middle = math.sqrt(low * high)
        if not low < middle < high:
            break
        late = duration(made(middle)) - time
        if abs(late) <= 1e-12 * time:
            return made(middle)
        low, high = (middle, high) if late > 0.0 else (low, middle)
    return min((made(low), made(high)), key=lambda demand: abs(duration(demand) - time))
