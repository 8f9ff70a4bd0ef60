"""Servo joints that fall behind: what a run on the twin shows, and what closed forms say before it.

In: a plan, and the recording of its run.  Out: problems at their lines; how much of each servo's torque is used.

Before a run the motion is looked at in samples a servo period apart, as for steppers (``torque.py``): inertia,
frictions and constant load against the current's limit and what the supply leaves over the back-EMF.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.problems import Problem, Severity, more_lines
from trochia.analysis.torque import samples_of
from trochia.machine.servos.drive import servo_drive

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.analysis.plan import Plan
    from trochia.analysis.torque import Samples
    from trochia.machine.joints import Joint
    from trochia.machine.servos.drive import ServoDrive
    from trochia.recorder import Recording

SHORT = "torque-short"  #: a servo would have to give more than it can
TRIPPED = "following-error"  #: a servo fell further behind than its joint allows
LATE = "following-late"  #: further than is told


@dataclass(slots=True)
class ServoUse:
    """What a servo has to give.

    Attributes
    ----------
    used
        Greatest part of the torque there is, 1 all; infinite where there is none.
    needed, velocity, line
        Torque along the motion [N·m] and velocity of the joint [mm/s or degree/s] there, and the source line.
    short
        Source lines in which more is asked than there is, in the order of time.
    square, seconds
        Integral of the square of the current over time [A²·s], and that time [s].
    way
        That the joint goes, to and fro [mm or degree].
    """

    joint: str
    used: float = 0.0
    needed: float = 0.0
    velocity: float = 0.0
    line: int = 0
    square: float = 0.0
    seconds: float = 0.0
    fastest: float = 0.0
    way: float = 0.0
    short: tuple[int, ...] = ()

    @property
    def effective(self) -> float:
        """Effective current [A]: what warms the winding."""
        return float(np.sqrt(self.square / self.seconds)) if self.seconds else 0.0


def servo_use(plan: Plan) -> dict[str, ServoUse]:
    """Return the use of every joint whose loop the file gives, by name."""
    drives = {i: found for i in range(len(plan.machine.joints)) if (found := servo_drive(plan.machine, i)) is not None}
    uses = {i: ServoUse(plan.machine.joints[i].name) for i in drives}
    before = 0.0
    for block in samples_of(plan) if drives else ():
        step = float(block.t[-1]) - before
        for i, drive in drives.items():
            _take(uses[i], drive, plan.machine.kinematics.matrix[i], block, step)
        before = float(block.t[-1])
    return {use.joint: use for use in uses.values()}


def _take(use: ServoUse, drive: ServoDrive, row: NDArray[np.float64], block: Samples, seconds: float) -> None:
    """Add a block of samples to a joint's use."""
    velocity, acceleration = block.velocity @ row, block.acceleration @ row
    used = drive.used(velocity, acceleration)
    needed = drive.needed(velocity, acceleration)
    current = needed / drive.plant.torque_constant
    use.square += float(np.mean(current * current)) * seconds
    use.seconds += seconds
    use.way += float(np.mean(np.abs(velocity))) * seconds
    use.fastest = max(use.fastest, float(np.abs(velocity).max(initial=0.0)))
    lines = np.unique(block.line[used > 1.0])
    use.short += tuple(int(line) for line in lines if line not in use.short)
    at = int(np.argmax(used))
    if used[at] > use.used:
        use.used, use.needed = float(used[at]), abs(float(needed[at]))
        use.velocity, use.line = float(velocity[at]), int(block.line[at])


def servo_problems(plan: Plan, uses: dict[str, ServoUse]) -> list[Problem]:
    """Return what the motors of servo joints cannot do: a warning each, naming the first line and what would do."""
    problems: list[Problem] = []
    for i, joint in enumerate(plan.machine.joints):
        use, drive = uses.get(joint.name), servo_drive(plan.machine, i)
        if use is None or drive is None:
            continue
        if use.short:
            problems.append(_short(plan, use))
        if use.effective > drive.current:
            problems.append(_hot(plan, use, drive.current))
    return problems


def _short(plan: Plan, use: ServoUse) -> Problem:
    what = f"{1 / use.used:.0%} of the acceleration would do" if np.isfinite(use.used) else "less velocity would do"
    return Problem(
        severity=Severity.WARNING, code=SHORT, file=plan.program.name, line=use.short[0],
        message=f"the motor of joint {use.joint} cannot follow{more_lines(np.array(use.short))}: the worst, on line "
        f"{use.line}, asks {use.needed:.3g} N·m at {abs(use.velocity):.4g} {plan.machine.axes[0].unit}/s",
        hint=f"It falls behind, and catches up if it may: {what}.",
    )  # fmt: skip


def _hot(plan: Plan, use: ServoUse, current: float) -> Problem:
    return Problem(
        severity=Severity.WARNING, code="motor-hot", file=plan.program.name, line=use.line,
        message=f"the motor of joint {use.joint} carries {use.effective:.3g} A on average, more than the "
        f"{current:.3g} A it may for ever",
        hint="A short program may be run now and then; a long one needs less acceleration, or a greater motor.",
    )  # fmt: skip


def following_problems(plan: Plan, recording: Recording) -> list[Problem]:
    """Return where servo joints fell further behind than their file allows, or tells: an error or a warning each."""
    problems: list[Problem] = []
    axes = [axis.name for axis in plan.machine.axes]
    for joint, row in zip(plan.machine.joints, plan.machine.kinematics.matrix, strict=True):
        name = f"joint.{joint.name}.measured"
        if name not in recording or joint.following_error is joint.following_warning is None:
            continue
        command = sum(c * recording[f"{axis}.commanded"][:] for axis, c in zip(axes, row, strict=True) if c)
        lag = np.abs(command - recording[name][:])
        problem = _behind(plan, joint, recording, lag)
        if problem is not None:
            problems.append(problem)
    return problems


def _behind(plan: Plan, joint: Joint, recording: Recording, lag: NDArray[np.float64]) -> Problem | None:
    """Return the problem of one joint's lag, or None."""
    unit, peak = plan.machine.axes[0].unit, float(lag.max())
    for limit, severity, code, said in (
        (joint.following_error, Severity.ERROR, TRIPPED, "is stopped there"),
        (joint.following_warning, Severity.WARNING, LATE, "is told of"),
    ):
        over = np.flatnonzero(lag > limit) if limit is not None else np.empty(0, np.int64)
        if limit is not None and over.size:
            at = int(over[0])
            return Problem(
                severity=severity, code=code, file=plan.program.name, line=int(recording["path.line"][at]),
                message=f"joint {joint.name} falls {limit:.4g} {unit} behind its command after "
                f"{recording.time[at]:.3f} s and {said}; at most it is {peak:.4g} {unit} behind",
                hint="Less velocity or acceleration, more gain, or feed-forward lets it follow closer.",
            )  # fmt: skip
    return None
