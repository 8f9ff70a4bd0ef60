"""Whether a motor behind its driver makes a move: does it start, does it follow, where would it lose steps.

In: a velocity profile step by step, a motor behind its driver with its load.  Out: :class:`MoveUse`, by closed forms;
what would do where it does not.

What is shorter than a quarter of the rotor's own swing moves it by next to nothing, so accelerations are taken over as
long at least: a law that sets its speed in jumps is not blamed for each of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.analysis.stability import growth_rate
from trochia.analysis.swing import Swing
from trochia.errors import LimitError
from trochia.machine.drivers import heat
from trochia.pulses.ramps import TorqueCurve, one_acceleration, profile
from trochia.pulses.ramps.demand import floor_to

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from trochia.machine.torque import Drive
    from trochia.pulses.ramps import Profile

    Floats = NDArray[np.float64]

SAFE = 0.95  #: of a speed at which the torque is used up: nearer to it ramps have no end
POINTS = 400  #: of a motor's torque curve as the law `torque` takes it
_HAIR = 1.0 + 1e-9
_NOTHING = 1e-9  # of the holding torque
_ROUGH = 5e-3  # of the margin: the last digit a person is shown
_TRIES = 60  # of a lower acceleration
_FEWER = 0.9  # what is left of a speed or an acceleration from try to try
_SLOW, _SLOWER, _SOFTER = 0.8, 10, 3  # part left of a speed, speeds tried, down to a tenth,and
# accelerations at each, half the one before


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveUse:
    """What a move asks of its motor, and what there is.

    Attributes
    ----------
    needed, available
        Torque for inertia and load at each step, negative where the motor brakes, and what there is for it, frictions
        taken off (steps,) [N·m].
    used
        Part of it, 1 all (steps,); infinite where there is none.
    margin
        Part that is to be left unused.
    start_stop
        Greatest speed to start at and stop from, an estimate from energy [steps/s]; 0: it does not start.
    stalls, usable
        Greatest speed under this load without acceleration, with all torque and with the part that is to be used
        [steps/s]; infinite where a voltage without frictions keeps some torque at any speed.
    hunts
        Speed from which a small disturbance grows, below the greatest of the move [steps/s]; None: nowhere.
    swing
        Greatest swing of the rotor, by linear theory, as a part of what is safe; 0 where it cannot be told.
    resonance
        Speed at which full steps follow each other as fast as the rotor swings [steps/s].
    first, last, peak
        Speeds of the first and last step, and the greatest [steps/s].
    """

    needed: Floats
    available: Floats
    used: Floats
    margin: float
    start_stop: float
    stalls: float
    usable: float
    hunts: float | None
    swing: float
    resonance: float
    first: float
    last: float
    peak: float
    too_hot: tuple[str, ...]

    @property
    def starts(self) -> bool:
        """Whether the first and the last step are no faster than it starts and stops."""
        return max(self.first, self.last) <= self.start_stop * _HAIR

    @property
    def worst(self) -> int:
        """The step that uses most."""
        return int(np.argmax(self.used))

    @property
    def lost_at(self) -> int | None:
        """The first step that asks for more torque than there is; None: it follows."""
        over = np.flatnonzero(self.used > _HAIR)
        return int(over[0]) if over.size else None

    @property
    def left(self) -> float:
        """Part of the torque that is left where it is tightest; below zero it is short of it."""
        return 1.0 - float(self.used[self.worst])

    @property
    def ok(self) -> bool:
        """Whether it starts and follows."""
        return self.starts and self.lost_at is None

    @property
    def easy(self) -> bool:
        """Whether it also keeps the margin."""
        return self.ok and self.left >= self.margin - _ROUGH


def move_use(made: Profile, shaft: Drive) -> MoveUse:
    """Return what a profile, its steps those of the excitation, asks of a motor; ``shaft`` is in radians."""
    angle, motor = made.demand.step_angle, shaft.made.motor
    natural = math.sqrt(motor.teeth * shaft.made.holding / shaft.inertia) / math.tau
    speed, acceleration = _motion(made, 0.25 / natural)
    omega, alpha = speed * angle, acceleration * angle
    alpha[np.abs(alpha) * shaft.inertia < _NOTHING * shaft.made.holding] = 0.0  # what rounding leaves of even speed
    needed = shaft.needed(omega, alpha)
    there = np.where(needed < 0, shaft.braking(omega), shaft.available(omega))
    fastest = shaft.made.fastest(shaft.load)
    return MoveUse(
        needed=needed,
        available=there,
        used=shaft.used(omega, alpha),
        margin=shaft.margin,
        start_stop=shaft.made.start_stop(shaft.load) / angle,
        stalls=fastest / angle,
        usable=min(shaft.greatest_velocity, fastest) / angle,
        hunts=_hunts(shaft, made.peak * angle, angle),
        swing=_swing(made, shaft, natural),
        resonance=natural * made.demand.steps_per_turn / motor.full_steps,
        first=float(made.speeds[0]),
        last=float(made.speeds[-1]),
        peak=made.peak,
        too_hot=tuple(heat(shaft.made).problems()),
    )


def torque_curve(shaft: Drive, steps_per_turn: int) -> tuple[TorqueCurve, float]:
    """Return what planning may use of a motor's torque over speed, frictions taken off, and its constant load [N·m].

    Up to where a fiftieth of it is left.

    Raises
    ------
    LimitError
        When the load leaves no torque at any speed.
    """
    end = min(shaft.greatest_velocity, shaft.made.top(0.02)) * 1.01
    if not shaft.acceleration(np.array(0.0)) > 0:
        weight, there = abs(shaft.load.constant), (1 - shaft.margin) * float(shaft.available(np.array(0.0)))
        raise LimitError(f"the load of {weight:.4g} N·m holds the motor: of its torque {there:.4g} N·m are to be used",
                         hint="Take a stronger motor, a gear, or a lighter load.")  # fmt: skip
    omega = np.linspace(0.0, end, POINTS)
    torque = np.maximum((1 - shaft.margin) * shaft.available(omega), 0.0)
    speeds = omega * steps_per_turn / math.tau
    return TorqueCurve(speeds=tuple(speeds.tolist()), torques=tuple(torque.tolist())), abs(shaft.load.constant)


def easier(
    made: Profile, shaft: Drive, holds: Callable[[Profile], bool] | None = None, *, slower: bool = False
) -> Profile | None:
    """Return the move at the speed and accelerations, none greater than asked, that the motor makes with its margin.

    None where no such move is found.  ``holds`` says of a move whether the twin loses no steps in it: lower speeds, and
    lower accelerations at each, are tried until it does.  ``slower``: the speed itself was too much, as where steps
    were lost while it was held; then none as fast is tried, which luck might let pass.
    """
    demand, angle = made.demand, made.demand.step_angle
    usable = min(shaft.greatest_velocity, shaft.made.fastest(shaft.load)) / angle
    speed = min(demand.speed, SAFE * usable)
    if holds is not None and (hunts := _hunts(shaft, speed * angle, angle)) is not None:
        speed = min(speed, SAFE * hunts)  # where it runs unsteadily one move may do and the next not
    if slower:
        speed = min(speed, _SLOW * demand.speed)
    if not speed > 0.0:
        return None
    for _ in range(1 if holds is None else _SLOWER):
        found = _gentler(made, shaft, _kept(speed, demand.speed))
        for _ in range(0 if found is None or holds is None else _SOFTER):
            assert found is not None
            if holds is None or holds(found):
                return found
            found = _gentler(found, shaft, found.demand.speed, 0.5)
            if found is None:
                break
        if holds is None:
            return found
        speed *= _SLOW
    return None


def _gentler(made: Profile, shaft: Drive, speed: float, part: float = 1.0) -> Profile | None:
    """Return the move at a speed, as quick as the margin allows and with ``part`` of what was asked at most."""
    law = made.law if one_acceleration(made) else "exact"
    demand, angle = made.demand, made.demand.step_angle
    most = float(shaft.acceleration(np.array(speed * angle))) / angle
    rising = min(part * (demand.acceleration or most), most)
    falling = min(part * demand.falling if demand.acceleration is not None else most, most)
    for _ in range(_TRIES):
        if not rising > 0.0:
            return None
        cured = replace(demand, speed=speed, acceleration=_kept(rising, demand.acceleration),
                        deceleration=None if demand.deceleration is None else _kept(falling, demand.deceleration),
                        curve=None, start_stop=None)  # fmt: skip
        found = profile(cured, law)
        if move_use(found, shaft).easy:
            return found
        rising, falling = _FEWER * rising, min(falling, _FEWER * rising)
    return None


def _kept(value: float, asked: float | None) -> float:
    """Return an acceleration as it was asked for, or rounded down to what a person types."""
    return value if value == asked else floor_to(value)


def _motion(made: Profile, shortest: float) -> tuple[Floats, Floats]:
    """Return speed and acceleration about each step, over ``shortest`` [s] at least (steps,) each."""
    speeds, middles = made.speeds, made.times - 0.5 * made.delays
    if speeds.size == 1:
        return speeds, np.zeros(1)
    last = speeds.size - 1
    rows = np.minimum(np.arange(speeds.size), last - 1)
    before = np.minimum(np.searchsorted(middles, middles - 0.5 * shortest), rows)
    after = np.clip(np.searchsorted(middles, middles + 0.5 * shortest), rows + 1, last)
    acceleration = (speeds[after] - speeds[before]) / (middles[after] - middles[before])
    return 0.5 * (speeds[before] + speeds[after]), acceleration


def _hunts(shaft: Drive, peak: float, angle: float) -> float | None:
    """Return the lowest speed up to ``peak`` [rad/s] at which a voltage-fed motor does not run steadily [steps/s]."""
    if shaft.made.chopper is not None:
        return None
    for omega in np.linspace(0.02, 1.0, 50) * peak:
        try:
            if growth_rate(shaft.made.motor, float(omega), shaft.made.amplitude, shaft.load) > 0:
                return float(omega) / angle
        except LimitError:
            return None
    return None


def _swing(made: Profile, shaft: Drive, natural: float) -> float:
    """Return the greatest swing by linear theory, as a part of what is safe; 0 where it cannot be told."""
    step = max(0.05 / natural, made.duration / 200_000)
    count = math.ceil(made.duration / step)
    if count < 2 or step * natural > 0.1:
        return 0.0
    instants = (np.arange(count) + 0.5) * step
    middles, angle = made.times - 0.5 * made.delays, made.demand.step_angle
    speed, acceleration = _motion(made, 0.25 / natural)
    row = np.clip(np.searchsorted(middles, instants, side="right") - 1, 0, speed.size - 1)
    place = np.interp(instants, np.concatenate([[0.0], made.times]), np.arange(made.times.size + 1)) * angle
    swing = Swing(shaft, step, made.peak * angle, 1.0 / angle)
    swing.take(place, speed[row] * angle, acceleration[row] * angle, row.astype(np.uint32))
    return swing.part


def figures(use: MoveUse, turn: float) -> dict[str, Any]:
    """Return what ``trochia profile --json`` says of the motor; ``turn`` is its steps a turn."""
    rpm = 60.0 / turn
    return {
        "starts": use.starts,
        "follows": use.lost_at is None,
        "margin": max(use.left, -99.0),
        "margin_wanted": use.margin,
        "tightest_step": use.worst,
        "lost_from_step": use.lost_at,
        "first_step_rpm": use.first * rpm,
        "last_step_rpm": use.last * rpm,
        "start_stop_rpm": use.start_stop * rpm,
        "stalls_rpm": use.stalls * rpm if math.isfinite(use.stalls) else None,
        "usable_rpm": use.usable * rpm if math.isfinite(use.usable) else None,
        "hunts_from_rpm": None if use.hunts is None else use.hunts * rpm,
        "swing": use.swing,
        "resonance_rpm": use.resonance * rpm,
        "problems": list(use.too_hot),
    }
