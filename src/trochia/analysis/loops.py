"""Servo loops whose gains are unstable on their plant: told before anything runs.

In: a plan.  Out: an error for each such joint, by the poles of its loop as it is sampled.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.problems import Problem, Severity
from trochia.machine.servos.drive import servo_drive
from trochia.servo.nominal import nominal_loop
from trochia.servo.sampled import closed_poles

if TYPE_CHECKING:
    from trochia.analysis.plan import Plan

UNSTABLE = "loop-unstable"
_EDGE = 1e-9  # of the unit circle


def unstable_problems(plan: Plan) -> list[Problem]:
    """Return an error for every servo joint whose loop swings up by itself."""
    problems: list[Problem] = []
    for i, joint in enumerate(plan.machine.joints):
        drive = servo_drive(plan.machine, i)
        if drive is None:
            continue
        poles = closed_poles(drive.plant, nominal_loop(drive))
        worst = poles[int(np.argmax(np.abs(poles)))]
        if abs(worst) > 1.0 + _EDGE:
            hertz = abs(math.atan2(worst.imag, worst.real)) / math.tau / drive.period
            problems.append(Problem(
                severity=Severity.ERROR, code=UNSTABLE, file=plan.program.name, line=0,
                message=f"the gains of joint {joint.name} are unstable on its plant: it swings up at {hertz:.4g} Hz",
                hint=f"Lower joints.{joint.name}.loop's gains, or let `trochia tune --joint {joint.name}` find others.",
            ))  # fmt: skip
    return problems
