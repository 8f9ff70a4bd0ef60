"""How much of its motor's torque a plan uses, by closed forms.

In: a plan on a machine whose joints name motor, driver and load.  Out: for each such joint the greatest part used, and
where the motor would first fall out of step.

The motion is looked at in samples a servo period apart (of a long program further); what is shorter than a sample moves
a rotor by next to nothing, so it loses no steps.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.problems import Problem, Severity, more_lines
from trochia.analysis.swing import Swing, natural
from trochia.machine.torque import drive

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from numpy.typing import NDArray

    from trochia.analysis.plan import Plan
    from trochia.machine.torque import Drive

LOST = "steps-lost"  #: code of the problem
UNSTEADY = "motor-unsteady"  #: of motors that swing more and more at a steady speed
SAMPLES = 24  #: of a swing
BLOCK = 65_536  #: samples at a time
MOST = 12_000_000  #: samples of a program; longer ones are looked at in coarser steps


@dataclass(frozen=True, slots=True, kw_only=True)
class TorqueUse:
    """What a joint's motor has to give.

    Attributes
    ----------
    used
        Greatest part of the pull-out torque that is used, 1 all; infinite where there is none.
    time, line
        When [s], and the source line of it.
    velocity, needed, available
        Of the joint there [mm/s or degree/s]; torque asked and there [N·m].
    lost
        Source lines in which more is asked than there is (n,), in the order of time.
    rpm
        Of the motor's shaft there.
    part
        Of the acceleration, that would do wherever more is asked than there is; 0: the load alone is too much.
    swing
        Greatest swing of the rotor, by linear theory, as a part of what is safe.
    swing_line, swing_velocity, swing_grows
        Source line in which it first passes what is safe, velocity of the joint there, whether swings grow by
        themselves at that speed.
    """

    joint: str
    used: float
    time: float
    line: int
    velocity: float
    needed: float
    available: float
    lost: NDArray[np.uint32]
    rpm: float = 0.0
    part: float = 1.0
    swing: float = 0.0
    swing_line: int = 0
    swing_velocity: float = 0.0
    swing_grows: bool = False


def torque_use(plan: Plan) -> dict[str, TorqueUse]:
    """Return the use of every joint that names motor and driver, by name."""
    drives = {i: found for i in range(len(plan.machine.joints)) if (found := drive(plan.machine, i)) is not None}
    worst: dict[int, TorqueUse] = {}
    step = sample_step(plan, drives.values())
    swings = {i: _swing(plan, i, found, step) for i, found in drives.items()}
    if drives:
        for block in samples_of(plan, step):
            for i, motor in drives.items():
                name, row = plan.machine.joints[i].name, plan.machine.kinematics.matrix[i]
                worst[i] = _worse(worst.get(i), _use(name, motor, row, block))
                swings[i].take(block.position @ row, block.velocity @ row, block.acceleration @ row, block.line)
    return {plan.machine.joints[i].name: _with_swing(use, swings[i]) for i, use in worst.items()}


def _swing(plan: Plan, joint: int, motor: Drive, step: float) -> Swing:
    """Return the swing of a joint at the start of a plan."""
    row = np.abs(plan.machine.kinematics.matrix[joint])
    peaks = np.array([plan.trajectory.peaks[axis.name]["velocity"] or 0.0 for axis in plan.machine.axes])
    steps = float(plan.machine.joints[joint].steps_per_unit or 0)
    return Swing(motor, step, float(row @ peaks), steps)


def _with_swing(use: TorqueUse, swing: Swing) -> TorqueUse:
    return replace(use, swing=swing.part, swing_line=swing.line, swing_velocity=swing.velocity, swing_grows=swing.grows)


def lost_step_problems(plan: Plan, uses: dict[str, TorqueUse]) -> list[Problem]:
    """Return one error for each joint whose motor would fall out of step, naming the first line and what would do.

    Where the rotor would swing too far before that, or where the torque suffices, it is a warning: damping that no file
    names decides.
    """
    errors = [_problem(plan, use) for use in uses.values() if use.lost.size]
    return errors + [_swinging(plan, use) for use in uses.values() if _swings_first(use)]


def _swings_first(use: TorqueUse) -> bool:
    """Whether a rotor swings too far, and not only behind the line that loses steps anyway."""
    return use.swing > 1.0 and not (use.lost.size and use.lost[0] <= use.swing_line)


def _swinging(plan: Plan, use: TorqueUse) -> Problem:
    unit = plan.machine.axes[0].unit
    speed = f"{abs(use.swing_velocity):.4g} {unit}/s"
    if use.swing_grows:
        message = (f"the motor of joint {use.joint} may lose steps: at {speed} its rotor does not run steadily, "
                   "a swing grows by itself")  # fmt: skip
        hint = "A lower speed, another decay of the chopper or a higher supply; a damper on the shaft helps too."
    else:
        message = (f"the motor of joint {use.joint} may lose steps: its rotor would swing at {speed} to "
                   f"{use.swing:.3g} times what is safe")  # fmt: skip
        hint = f"{1.0 / use.swing:.0%} of the acceleration, an s-curve, or finer steps swing less; friction damps."
    return Problem(
        severity=Severity.WARNING, code=UNSTEADY if use.swing_grows else "rotor-swings", file=plan.program.name,
        line=use.swing_line, message=message, hint=hint,
    )  # fmt: skip


def _problem(plan: Plan, use: TorqueUse) -> Problem:
    unit = plan.machine.axes[0].unit
    percent = math.floor(100 * use.part)
    enough = (
        f"A motor with {use.needed:.3g} N·m at that speed would do, or {percent}% of the acceleration."
        if percent > 0
        else "At that speed the motor has not the torque for its load alone: less feed would do, or a higher supply."
    )
    return Problem(
        severity=Severity.ERROR,
        code=LOST,
        file=plan.program.name,
        line=int(use.lost[0]),
        message=f"the motor of joint {use.joint} would lose steps{more_lines(use.lost)}: "
        f"the worst, on line {use.line}, asks {use.needed:.3g} N·m at {use.velocity:.4g} {unit}/s ({use.rpm:.0f} rpm), "
        f"of {max(use.available, 0.0):.3g} N·m",
        hint=enough,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Samples:
    """Samples of a plan: times (n,), places, velocities, accelerations of the axes (n, axes), source lines (n,)."""

    t: NDArray[np.float64]
    position: NDArray[np.float64]
    velocity: NDArray[np.float64]
    acceleration: NDArray[np.float64]
    line: NDArray[np.uint32]


def sample_step(plan: Plan, drives: Iterable[Drive] = ()) -> float:
    """Return the time between samples [s]: a servo period, or less to follow how motors swing."""
    fastest = max((natural(motor) for motor in drives), default=0.0)
    step = min(plan.machine.servo_period, math.tau / (SAMPLES * fastest) if fastest else math.inf)
    return step * max(1.0, plan.time_s / step / MOST)


def samples_of(plan: Plan, step: float | None = None) -> Iterator[Samples]:
    """Yield the samples of a plan, block by block, in the middle of even steps of time."""
    motion, duration = plan.trajectory, plan.time_s
    step = step or sample_step(plan)
    samples = math.ceil(duration / step)
    for first in range(0, samples, BLOCK):
        # in the middle of each step: at its borders acceleration jumps
        t = (np.arange(first, min(first + BLOCK, samples), dtype=np.float64) + 0.5) * step
        t = np.minimum(t, duration)
        lines = np.asarray(motion.line_at(t), np.uint32)
        yield Samples(t=t, position=motion.position(t), velocity=motion.velocity(t),
                      acceleration=motion.acceleration(t), line=lines)  # fmt: skip


def _use(name: str, motor: Drive, row: NDArray[np.float64], block: Samples) -> TorqueUse:
    """Return a joint's use in one block."""
    velocity, acceleration = block.velocity @ row, block.acceleration @ row
    used = motor.used(velocity, acceleration)
    used[(velocity == 0) & (acceleration == 0)] = 0.0  # at rest the holding torque does, and it is more
    at = int(np.argmax(used))
    needed = motor.needed(velocity[at], acceleration[at])
    there = motor.braking(velocity[at]) if needed < 0 else motor.available(velocity[at])
    lost = used > 1.0
    return TorqueUse(
        joint=name,
        used=float(used[at]),
        time=float(block.t[at]),
        line=int(block.line[at]),
        velocity=float(velocity[at]),
        needed=abs(float(needed)),
        available=float(there),
        lost=block.line[lost],
        rpm=abs(float(velocity[at] / motor.per_radian)) * 60 / math.tau,
        part=_part(motor, velocity[lost], acceleration[lost]),
    )


def _part(motor: Drive, velocity: NDArray[np.float64], acceleration: NDArray[np.float64]) -> float:
    """Return the part of some accelerations that the motor makes (n,), the least; the load's constant part stays."""
    if not len(velocity):
        return 1.0
    needed, steady = motor.needed(velocity, acceleration), motor.needed(velocity, np.zeros_like(velocity))
    there = np.where(needed < 0, -motor.braking(velocity), motor.available(velocity))
    own = needed - steady
    part = np.where(own != 0.0, (there - steady) / np.where(own != 0.0, own, 1.0), 0.0)
    return float(np.clip(part, 0.0, 1.0).min())


def _worse(before: TorqueUse | None, now: TorqueUse) -> TorqueUse:
    """Return the worse of two uses, with the lost lines of both in order."""
    if before is None:
        return now
    worse = before if before.used >= now.used else now
    return replace(worse, lost=np.concatenate([before.lost, now.lost]), part=min(before.part, now.part))
