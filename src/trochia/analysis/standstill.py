"""What a driver does to a motor that stands or goes slowly: whether it holds its load, and the current it is set to.

In: a plan.  Out: an error for each joint whose load would drop, a warning for each whose small currents are lost.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.problems import Problem, Severity
from trochia.machine.torque import drive

if TYPE_CHECKING:
    from trochia.analysis.plan import Plan
    from trochia.machine.drivers import Fed
    from trochia.machine.torque import Drive

DROPS = "hold-too-weak"  #: code of the problem


def standstill_problems(plan: Plan) -> list[Problem]:
    """Return what the motors of a machine do not hold at rest."""
    found: list[Problem] = []
    for i, joint in enumerate(plan.machine.joints):
        motor = drive(plan.machine, i)
        if motor is None:
            continue
        for code, severity, (message, hint) in (
            (DROPS, Severity.ERROR, _dropping(motor)),
            ("current-floor", Severity.WARNING, _coarse(motor.made)),
        ):
            if message:
                found.append(Problem(severity=severity, code=code, file=plan.program.name, line=0,
                                     message=f"joint {joint.name}: {message}", hint=hint))  # fmt: skip
    return found


def _dropping(motor: Drive) -> tuple[str, str]:
    """Return what is wrong, and a hint, where a load pulls the motor out of its place; detent torque is left out."""
    made, chopper = motor.made, motor.made.chopper
    asked = abs(motor.load.constant) - motor.load.friction - made.motor.friction
    part = 1.0 if chopper is None else chopper.hold_current
    there, full = made.hold_of(part), made.hold_of(1.0)
    if asked <= 0 or stays(asked, full, there):
        return "", ""
    how = "with its current switched off " if part == 0 else f"with {part:.0%} of its current " if part < 1 else ""
    last = "it lets go" if asked > there else "it swings out of its place as the current falls"
    message = f"at rest the motor holds {there:.3g} N·m {how}and its load asks {asked:.3g} N·m: {last}"
    enough = next(
        (n / 100 for n in range(math.ceil(100 * part), 101) if stays(asked, full, made.hold_of(n / 100))), None
    )
    if enough is not None:
        return message, f"hold_current = {enough:g} or more would hold it."
    return message, "More current, a stronger motor, a gear or a counterweight would hold it."


def stays(asked: float, before: float, after: float) -> bool:
    """Return whether a motor holds a load when its holding torque falls at once, all in N·m.

    The rotor is a pendulum at rest where the load meets the torque before, and must not climb over the unstable point
    of the torque after (equal areas); without damping, so the answer is on the safe side.
    """
    if asked > min(before, after):
        return False
    start, top = math.asin(asked / before), math.pi - math.asin(asked / after)
    return after * (math.cos(start) - math.cos(top)) >= asked * (top - start)


def _coarse(made: Fed) -> tuple[str, str]:
    """Return what is wrong, and a hint, where blanking in slow decay keeps more current than small microsteps ask."""
    chopper = made.chopper
    if chopper is None:
        return "", ""
    least = chopper.least_current(made.motor.resistance)
    quarter = np.abs(made.excitation.levels[: made.excitation.steps_per_full_step + 1, 0])
    asked = quarter[quarter > 0.5 / len(quarter)] * chopper.current
    lost = int((asked < least).sum())
    if not lost:
        return "", ""
    return (
        f"in slow decay a phase keeps {least:.3g} A whatever less is asked, as the blanking of "
        f"{chopper.blanking * 1e6:g} us drives it at {chopper.supply:g} V in every period: "
        f"{lost} of the {len(asked)} levels of a phase are lost"
    ), 'decay = "mixed" pulls the current down; a lower supply, a shorter blanking or a longer off_time lessens it.'
