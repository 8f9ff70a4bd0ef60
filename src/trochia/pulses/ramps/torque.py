"""As fast as the torque allows: df/dt = (T(f) - T_L)/(J alpha), over the straight pieces of the curve (S1 E6 to E10).

t(f) = alpha J ∫ df/(T - T_L) and s(f) = alpha J ∫ f df/(T - T_L), piece by piece in closed form; braking the load
helps, so there it is T + T_L (S1-F33).  The source leaves the load out above the knee (S1 section 6, item 2): 37.7 ms
in place of 45.7 ms at 200 steps/s of its example.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import LimitError
from trochia.pulses.ramps.leg import step_times

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.pulses.ramps.curve import TorqueCurve
    from trochia.pulses.ramps.demand import Demand

    Floats = NDArray[np.float64]

SAFE = 0.95  #: of the pull-out speed: nearer to it the time to get there has no bound
_SMALL = 1e-2  # below it the series is the exacter form
_HALVINGS = 60  # of a piece, to find the speed at a place: to the last bit


def _log_ratio(x: Floats) -> Floats:
    """Return ln(1 + x)/x, 1 at 0."""
    safe = np.where(np.abs(x) < _SMALL, 1.0, x)
    series = 1.0 - x * (1 / 2 - x * (1 / 3 - x * (1 / 4 - x * (1 / 5 - x * (1 / 6 - x * (1 / 7 - x / 8))))))
    return np.where(np.abs(x) < _SMALL, series, np.log1p(safe) / safe)


def _log_rest(x: Floats) -> Floats:
    """Return (x - ln(1 + x))/x², 1/2 at 0."""
    safe = np.where(np.abs(x) < _SMALL, 1.0, x)
    series = 1 / 2 - x * (1 / 3 - x * (1 / 4 - x * (1 / 5 - x * (1 / 6 - x * (1 / 7 - x * (1 / 8 - x / 9))))))
    return np.where(np.abs(x) < _SMALL, series, (safe - np.log1p(safe)) / safe**2)


@dataclass(frozen=True, slots=True, kw_only=True)
class Pieces:
    """The leg of a torque curve: where each straight piece starts, and time and way up to there.

    Attributes
    ----------
    scale
        alpha J [kg·m²·rad].
    speeds, spare, slopes
        Start of each piece [steps/s], torque left for acceleration there [N·m], its slope [N·m·s/step].
    clock, way
        Time [s] and way [steps] from rest to the start of each piece.
    reach
        Where the last piece ends [steps/s].
    """

    scale: float
    speeds: Floats
    spare: Floats
    slopes: Floats
    clock: Floats
    way: Floats
    reach: float

    @classmethod
    def of(cls, curve: TorqueCurve, load: float, scale: float, reach: float) -> Pieces:
        """Return the leg up to ``reach`` that has the curve's torque less ``load`` (negative: the load helps) [N·m]."""
        knots = sorted({0.0, *(at for at in curve.speeds if at < reach), reach})
        speeds = np.array(knots)
        spare = np.array([curve.torque(at) - load for at in knots])
        gaps = np.diff(speeds)
        slopes = np.diff(spare) / gaps
        leg = cls(scale=scale, speeds=speeds[:-1], spare=spare[:-1], slopes=slopes,
                  clock=np.zeros(gaps.size), way=np.zeros(gaps.size), reach=reach)  # fmt: skip
        # the last piece is never gone through to its end: there the time may have no bound
        index = np.arange(gaps.size - 1)
        time, way = leg._within(index, gaps[:-1])
        clock_sums = np.concatenate(((0.0,), np.cumsum(time)))
        way_sums = np.concatenate(((0.0,), np.cumsum(way)))
        return cls(scale=scale, speeds=speeds[:-1], spare=spare[:-1], slopes=slopes,
                   clock=clock_sums, way=way_sums, reach=reach)  # fmt: skip

    def _within(self, index: NDArray[np.intp], rise: Floats) -> tuple[Floats, Floats]:
        """Return time [s] and way [steps] from the start of a piece until the speed has risen so much there."""
        x = self.slopes[index] * rise / self.spare[index]
        share = self.scale * rise / self.spare[index]
        time = share * _log_ratio(x)
        return time, self.speeds[index] * time + share * rise * _log_rest(x)

    def _at(self, speed: float) -> tuple[float, float]:
        """Return time and way from rest to a speed."""
        index = np.searchsorted(self.speeds, [speed], side="right") - 1
        time, way = self._within(index, speed - self.speeds[index])
        return float((self.clock[index] + time)[0]), float((self.way[index] + way)[0])

    def length(self, speed: float) -> float:
        """Return the way until a speed below the reach [steps]."""
        return self._at(speed)[1]

    def duration(self, speed: float) -> float:
        """Return the time until a speed below the reach [s]."""
        return self._at(speed)[0]

    def times(self, places: Floats) -> Floats:
        """Return when each place (n,) [steps] is reached [s]: the speed there by halving its piece, then the time."""
        index = np.searchsorted(self.way, places, side="right") - 1
        ends = np.append(self.speeds[1:], self.reach)
        left = places - self.way[index]
        low = np.zeros(places.size)
        high = np.minimum(ends[index] - self.speeds[index], self._highest(index))
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            short = self._within(index, middle)[1] < left
            low, high = np.where(short, middle, low), np.where(short, high, middle)
        return self.clock[index] + self._within(index, high)[0]

    def _highest(self, index: NDArray[np.intp]) -> Floats:
        """Return how far the speed may rise in a piece: until no torque is left."""
        slopes = self.slopes[index]
        falling = slopes < 0.0
        room = self.spare[index] / np.where(falling, -slopes, 1.0)
        return np.where(falling, room * (1.0 - 1e-15), np.inf)


def legs(demand: Demand) -> tuple[Pieces, Pieces]:
    """Return the legs up and down.

    Raises
    ------
    LimitError
        For what is not given, and for a speed the torque does not reach.
    """
    if demand.curve is None or demand.inertia is None:
        missing = "a torque curve" if demand.curve is None else "an inertia"
        raise LimitError(f"the law `torque` needs {missing}", hint="Give curve and inertia (rotor and load).")
    reach = demand.curve.reach(demand.load)
    known = reach == demand.curve.speeds[-1]
    if demand.speed >= reach and not (known and demand.speed == reach and demand.curve.torque(reach) > demand.load):
        refuse_speed(demand, reach)
    scale = demand.step_angle * demand.inertia
    up = Pieces.of(demand.curve, demand.load, scale, reach)
    return up, Pieces.of(demand.curve, -demand.load, scale, reach)


def refuse_speed(demand: Demand, reach: float) -> None:
    """Raise the error of a speed that the torque does not reach."""
    if reach == 0.0:
        raise LimitError(
            f"the load torque of {demand.load:g} N·m holds the motor: at rest it has "
            f"{demand.curve.torque(0.0) if demand.curve else 0.0:g} N·m",
            hint="Take a stronger motor or a lighter load.",
        )
    raise LimitError(
        f"the speed of {demand.said(demand.speed)} is out of reach: under {demand.load:g} N·m the torque curve "
        f"reaches {demand.said(reach)}",
        hint=f"At most {demand.at_most(SAFE * reach)} would do ({SAFE:.0%} of it).",
    )


def delays(demand: Demand) -> Floats:
    """Return the delay before each step (steps,) [s]; errors as in :func:`legs`."""
    up, down = legs(demand)
    return np.diff(step_times(up, down, demand.steps, demand.speed))
