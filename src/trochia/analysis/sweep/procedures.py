"""Measuring a stepper on the twin, as one measures a real one.

In: a motor behind its driver, its load, how pulses are timed.  Out: the greatest speeds [rad/s] and torques [N·m] at
which it loses no steps.

- pull-out speed: from rest, a turn at each speed, then faster, without a stop (S1-F04, sketch 06)
- start/stop speed: a turn at each speed from rest, then stopped, released and at rest (S1-F04, sketch 07)
- pull-out torque: run at a known speed, raise the load until synchronism is lost; three times, the mean (S1-F07)
- pull-in torque: the greatest load under which it starts at a speed from rest
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.sweep.timing import TIMINGS, Timing
from trochia.backends.stepper_twin import MEAN, STEP, Levels, StepperTwin
from trochia.machine.motors.hybrid import FREE
from trochia.machine.motors.shaft import CREEP, ShaftLoad

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from trochia.machine.drivers import Fed

EXACT = TIMINGS["exact"]
LOOK = 2e-3  #: the rotor is looked at as often [s]
SETTLE = 0.1  #: at rest before a run [s]
REST = 0.3  #: at rest after a turn [s]; the sketch waits 3 s, the rotor stands after a tenth of it
ASTRAY = 0.75  #: full steps from its place at which steps are lost; a motor released from two phases falls half a step
HOLD = 0.05  #: at a load before it is raised [s]
COARSE, FINE = 0.05, 0.005  #: rises of the load, parts of the torque expected
REPEATS = 3
CONFIRMED = 2  #: speeds in a row that cost steps in starting or stopping, until that is a limit
STOOD = 0.5  #: part of a turn's steps whose loss is no resonance: the rotor stood
PATIENCE = 25  #: speeds in a row that cost steps, until a motor has stalled


def twin_of(made: Fed, load: ShaftLoad, levels: Levels = MEAN) -> StepperTwin:
    """Return a motor at rest, its tick short enough for its friction."""
    drag = (made.motor.friction + load.friction) / CREEP + made.motor.viscous + load.viscous
    inertia = made.motor.inertia + load.inertia
    shortest = min(made.motor.time_constant, inertia / drag if drag else math.inf)
    return StepperTwin(made, load, levels=levels, step=min(STEP, 0.4 * shortest))


def pull_out_speed(
    made: Fed, speeds: Iterable[float], load: ShaftLoad = FREE, timing: Timing = EXACT, *, turns: float = 1.0
) -> float:
    """Return the greatest of some rising speeds [rad/s] at which a turn costs no steps; 0 where the first one does.

    Each speed is held for ``turns``, the next follows without a stop.  A motor that lost steps, at a resonance say, may
    recover at a higher speed; one that lost half a turn's, or some at :data:`PATIENCE` speeds in a row, has stalled.
    """
    stood = STOOD * turns * made.motor.full_steps
    twin = twin_of(made, load)
    twin.run(SETTLE)
    held, failed, lost = 0.0, 0, 0
    for speed in speeds:
        before, lost = lost, _turn(twin, made, speed, timing, turns)
        failed = failed + 1 if abs(lost - before) >= 4 else 0
        if failed > PATIENCE or abs(lost - before) >= stood:
            break
        held = held if failed else speed
    return held


def start_stop_speed_measured(
    made: Fed, speeds: Iterable[float], load: ShaftLoad = FREE, timing: Timing = EXACT, *, turns: float = 1.0
) -> float:
    """Return the greatest of some rising speeds [rad/s] before steps are lost in starting or stopping.

    A speed alone that costs steps is taken for a resonance; two in a row are the limit.  0 where the first ones do.
    """
    return start_stop_speeds(made, speeds, load, timing, turns=turns)[0]


def start_stop_speeds(
    made: Fed, speeds: Iterable[float], load: ShaftLoad = FREE, timing: Timing = EXACT, *, turns: float = 1.0
) -> tuple[float, float]:
    """Return the same, and the speed before the very first that costs a step [rad/s].

    Each turn begins and ends at rest.  A bridge that shorts a released motor lets it go as soon as the last step's time
    is over, as the sketch does, and the next turn begins with windings without current; such a rotor may run on for a
    step or more: it has started, but not stopped where it should.
    """
    twin, held, lost = twin_of(made, load), 0.0, 0
    kept: list[bool] = []
    first = None
    release = made.driver.released == "short"
    twin.run(SETTLE)
    for speed in speeds:
        twin.set_enabled(True)
        _turn(twin, made, speed, timing, turns)
        twin.set_enabled(not release)
        behind = float(twin.run(REST, every=100).load_angle[-1]) / (0.5 * math.pi)
        kept.append(abs(behind - lost) <= ASTRAY)
        lost = 4 * round(behind / 4)
        if first is None and not kept[-1]:
            first = held
        if not any(kept[-CONFIRMED:]) and len(kept) >= CONFIRMED:
            break
        held = speed if kept[-1] else held
    return held, held if first is None else first


def _turn(twin: StepperTwin, made: Fed, speed: float, timing: Timing, turns: float) -> int:
    """Play some turns at a speed, and return the full steps the rotor has lost at their end, before them included."""
    rate = made.motor.full_steps * made.excitation.steps_per_full_step
    times = twin.now + timing.times(math.tau / speed / rate, round(turns * rate))
    twin.queue(times[:-1])
    run = twin.run(times[-1] - twin.now, every=100)
    return int(run.lost_steps[-1]) if len(run.lost_steps) else 0


def pull_out_torque_measured(
    made: Fed, speed: float, load: ShaftLoad = FREE, *, repeats: int = REPEATS, levels: Levels = MEAN
) -> float:
    """Return the greatest constant load carried at a speed [N·m]: the mean of some tries; 0 where it gets none.

    The load rises in steps of 1/200 of the torque expected; a try begins a third of a step higher than the one before.
    """
    expected = max(float(made.pull_out(np.array(speed), load)), 0.02 * made.holding)
    twins = [twin_of(made, load, levels) for _ in range(repeats)]
    found = [_one_pull_out(twin, speed, load, expected, i / repeats) for i, twin in enumerate(twins)]
    return sum(found) / repeats


def _one_pull_out(twin: StepperTwin, speed: float, load: ShaftLoad, expected: float, share: float) -> float:
    """Return the last load carried in one try."""
    made = twin.made
    twin.run(SETTLE)
    rise = 0.3 * expected / (made.motor.inertia + load.inertia)
    steps = made.motor.full_steps * made.excitation.steps_per_full_step / math.tau  # a radian
    ramp = speed / rise
    seconds = ramp + HOLD * (2.0 / COARSE + 1.2 / FINE)
    times = twin.now + _ramp(speed * steps, rise * steps, seconds)
    twin.queue(times)
    twin.run(ramp + 4 * HOLD, every=50)
    carried, torque, step = 0.0, share * FINE * expected, COARSE
    while torque < 1.5 * expected:
        twin.set_load(_with(load, torque))
        run = twin.run(HOLD, every=50)
        if np.abs(run.lost_steps).max(initial=0) >= 4:
            break
        carried = torque
        step = FINE if torque > 0.8 * expected else COARSE
        torque += step * expected
    return carried


def _ramp(rate: float, acceleration: float, seconds: float) -> NDArray[np.float64]:
    """Return the pulses of an even rise to a rate [1/s], held until ``seconds`` (pulses,) [s]."""
    rise = rate * rate / (2 * acceleration)
    n = np.arange(1.0, rise + rate * max(seconds - rate / acceleration, 0.0))
    return np.where(n < rise, np.sqrt(2 * n / acceleration), rate / acceleration + (n - rise) / rate)


def pull_in_torque(made: Fed, speed: float, load: ShaftLoad = FREE, *, halvings: int = 7) -> float:
    """Return the greatest constant load under which it starts at a speed from rest [N·m]; 0 where it does not."""

    def starts(torque: float) -> bool:
        twin = twin_of(made, _with(load, torque))
        twin.run(SETTLE)
        return abs(_turn(twin, made, speed, EXACT, max(0.25, speed * 0.2 / math.tau))) < 4

    if not starts(0.0):
        return 0.0
    low, high = 0.0, made.holding
    for _ in range(halvings):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if starts(middle) else (low, middle)
    return low


def _with(load: ShaftLoad, torque: float) -> ShaftLoad:
    """Return a load with a constant torque besides its own."""
    return ShaftLoad(
        inertia=load.inertia, friction=load.friction, viscous=load.viscous, constant=load.constant + torque
    )
