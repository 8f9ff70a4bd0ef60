"""What cannot be: refused before it is made, with the number that fails and the one that would do."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from trochia.errors import LimitError
from trochia.pulses.ramps.demand import floor_to, shown_up
from trochia.pulses.ramps.torque import refuse_speed

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

    from trochia.pulses.ramps.demand import Demand
    from trochia.pulses.ramps.profile import Profile

_HAIR = 1.0 + 1e-9  # what rounding may add
_TRIES = 40  # of a lower acceleration


def check_torque(demand: Demand, peak: float) -> None:
    """Refuse a constant acceleration that the torque curve, where one is given, does not allow up to ``peak``.

    Raises
    ------
    LimitError
        For a speed out of reach, an acceleration or a deceleration that takes more torque than there is.
    """
    curve, inertia = demand.curve, demand.inertia
    if curve is None:
        return
    reach = curve.reach(demand.load)
    if peak > reach or curve.torque(peak) <= demand.load:
        refuse_speed(demand, reach)
    if inertia is None:
        return
    least = curve.least(peak)
    for name, wanted, spare in (("acceleration", demand.rising, least - demand.load),
                                ("deceleration", demand.falling, least + demand.load)):  # fmt: skip
        needed = inertia * demand.step_angle * wanted
        if needed > spare * _HAIR:
            most = spare / (inertia * demand.step_angle)
            raise LimitError(
                f"the {name} of {demand.said_acceleration(wanted)} takes {needed:.4g} N·m for {inertia:g} kg·m², and "
                f"up to {demand.said(peak)} only {spare:.4g} N·m are left for it",
                hint=f"At most {demand.at_most_acceleration(most)} would do, or the law `torque`, made for the curve.",
            )


def check_start_stop(profile: Profile, delays: Callable[[Demand], NDArray[np.float64]]) -> None:
    """Refuse a first or last step that is faster than the start/stop speed (S1-F38); ``delays`` is the profile's law.

    Raises
    ------
    LimitError
        It names an acceleration that would do.
    """
    demand, limit = profile.demand, profile.demand.start_stop
    if limit is None:
        return
    for row, name, verb, cure in ((0, "first", "start", "acceleration"), (-1, "last", "stop", "deceleration")):
        speed = float(profile.speeds[row])
        if speed > limit * _HAIR:
            if profile.law == "torque":
                remedy = (
                    f"{shown_up((speed / limit) ** 2)} times the inertia would do, or the law `exact` with less {cure}."
                )
            elif (value := _cure(demand, delays, cure, row)) is not None:
                remedy = f"A{'n' * (not row)} {cure} of {demand.at_most_acceleration(value)} would do."
            else:
                remedy = f"A lower speed would do: {demand.at_most(limit)}."
            raise LimitError(
                f"the {name} step is made at {demand.said(speed)}, above the {demand.said(limit)} at which the motor "
                f"can {verb}",
                hint=remedy,
            )


def _cure(demand: Demand, delays: Callable[[Demand], NDArray[np.float64]], key: str, row: int) -> float | None:
    """Return a value of ``key`` with which the law makes that step no faster than start/stop, or None."""
    limit = demand.start_stop or 0.0
    value = demand.rising if key == "acceleration" else demand.falling
    for _ in range(_TRIES):
        made = delays(replace(demand, **{key: value}))
        # one acceleration for both ramps must suit both ends
        speed = 1.0 / float(made[row] if demand.deceleration is not None else min(made[0], made[-1]))
        if speed <= limit * _HAIR:
            return value
        # the speed of the first step goes with the root of the acceleration, that of the last one nearly so
        value = floor_to(value * min((limit / speed) ** 2, 0.98))
    return None
