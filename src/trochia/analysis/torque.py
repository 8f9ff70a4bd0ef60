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
from trochia.analysis.swing import Swing
from trochia.machine.torque import drive

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from trochia.analysis.plan import Plan
    from trochia.machine.torque import Drive

MOST_ANGLE = 60.0  #: load angle up to which a stepper holds like a spring [electrical degree]
LOST = "steps-lost"  #: code of the problem
BLOCK = 65_536  #: samples at a time
MOST = 1_000_000  #: samples of a program; longer ones are looked at in coarser steps


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
    swing, swing_line
        Greatest load angle as the rotor swings, by linear theory [electrical degree], and the source line; at 90
        degrees it gives its most.
    """

    joint: str
    used: float
    time: float
    line: int
    velocity: float
    needed: float
    available: float
    lost: NDArray[np.uint32]
    swing: float = 0.0
    swing_line: int = 0


def torque_use(plan: Plan) -> dict[str, TorqueUse]:
    """Return the use of every joint that names motor and driver, by name."""
    drives = {i: found for i in range(len(plan.machine.joints)) if (found := drive(plan.machine, i)) is not None}
    worst: dict[int, TorqueUse] = {}
    swings = {i: Swing(found, sample_step(plan)) for i, found in drives.items()}
    if drives:
        for block in samples_of(plan):
            for i, motor in drives.items():
                name = plan.machine.joints[i].name
                worst[i] = _worse(worst.get(i), _use(name, motor, plan.machine.kinematics.matrix[i], block))
                swings[i].take(block.velocity @ plan.machine.kinematics.matrix[i],
                               block.acceleration @ plan.machine.kinematics.matrix[i], block.line)  # fmt: skip
    return {
        plan.machine.joints[i].name: replace(use, swing=swings[i].peak, swing_line=swings[i].line)
        for i, use in worst.items()
    }


def lost_step_problems(plan: Plan, uses: dict[str, TorqueUse]) -> list[Problem]:
    """Return one error for each joint whose motor would fall out of step, naming the first line and what would do.

    Where the torque suffices but the rotor would swing too far, it is a warning: damping that no file names decides.
    """
    errors = [_problem(plan, use) for use in uses.values() if use.lost.size]
    return errors + [_swinging(plan, use) for use in uses.values() if not use.lost.size and use.swing > MOST_ANGLE]


def _swinging(plan: Plan, use: TorqueUse) -> Problem:
    return Problem(
        severity=Severity.WARNING,
        code="rotor-swings",
        file=plan.program.name,
        line=use.swing_line,
        message=f"the motor of joint {use.joint} may lose steps: where acceleration jumps its rotor would swing to "
        f"{use.swing:.0f} degrees of load angle, and beyond {MOST_ANGLE:g} it holds less and less",
        hint=f"{MOST_ANGLE / use.swing:.0%} of the acceleration, or an s-curve, swings less; damping helps.",
    )


def _problem(plan: Plan, use: TorqueUse) -> Problem:
    unit = plan.machine.axes[0].unit
    enough = (
        f"A motor with {use.needed:.3g} N·m at that speed would do, or {1 / use.used:.0%} of the acceleration."
        if math.isfinite(use.used)
        else "At that speed the motor has no torque at all: less feed would do, or a higher supply."
    )
    return Problem(
        severity=Severity.ERROR,
        code=LOST,
        file=plan.program.name,
        line=int(use.lost[0]),
        message=f"the motor of joint {use.joint} would lose steps{more_lines(use.lost)}: "
        f"the worst, on line {use.line}, asks {use.needed:.3g} N·m at {use.velocity:.4g} {unit}/s, "
        f"of {max(use.available, 0.0):.3g} N·m",
        hint=enough,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Samples:
    """Samples of a plan: times (n,), velocities and accelerations of the axes (n, axes), source lines (n,)."""

    t: NDArray[np.float64]
    velocity: NDArray[np.float64]
    acceleration: NDArray[np.float64]
    line: NDArray[np.uint32]


def sample_step(plan: Plan) -> float:
    """Return the time between samples [s]."""
    return plan.machine.servo_period * max(1.0, plan.time_s / plan.machine.servo_period / MOST)


def samples_of(plan: Plan) -> Iterator[Samples]:
    """Yield the samples of a plan, block by block, in the middle of even steps of time."""
    motion, duration = plan.trajectory, plan.time_s
    step = sample_step(plan)
    samples = math.ceil(duration / step)
    for first in range(0, samples, BLOCK):
        # in the middle of each step: at its borders acceleration jumps
        t = (np.arange(first, min(first + BLOCK, samples), dtype=np.float64) + 0.5) * step
        t = np.minimum(t, duration)
        lines = np.asarray(motion.line_at(t), np.uint32)
        yield Samples(t=t, velocity=motion.velocity(t), acceleration=motion.acceleration(t), line=lines)


def _use(name: str, motor: Drive, row: NDArray[np.float64], block: Samples) -> TorqueUse:
    """Return a joint's use in one block."""
    velocity, acceleration = block.velocity @ row, block.acceleration @ row
    used = motor.used(velocity, acceleration)
    used[(velocity == 0) & (acceleration == 0)] = 0.0  # at rest the holding torque does, and it is more
    at = int(np.argmax(used))
    needed = motor.needed(velocity[at], acceleration[at])
    there = motor.braking(velocity[at]) if needed < 0 else motor.available(velocity[at])
    return TorqueUse(
        joint=name,
        used=float(used[at]),
        time=float(block.t[at]),
        line=int(block.line[at]),
        velocity=float(velocity[at]),
        needed=abs(float(needed)),
        available=float(there),
        lost=block.line[used > 1.0],
    )


def _worse(before: TorqueUse | None, now: TorqueUse) -> TorqueUse:
    """Return the worse of two uses, with the lost lines of both in order."""
    if before is None:
        return now
    lost = np.concatenate([before.lost, now.lost])
    best = before if before.used >= now.used else now
    return TorqueUse(
        joint=best.joint, used=best.used, time=best.time, line=best.line, velocity=best.velocity, needed=best.needed,
        available=best.available, lost=lost,
    )  # fmt: skip
