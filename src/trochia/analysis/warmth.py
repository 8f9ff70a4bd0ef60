"""Whether the motors and drivers of a machine stay cool.  In: a plan.  Out: a warning for each that does not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.analysis.problems import Problem, Severity
from trochia.machine.drivers import heat

if TYPE_CHECKING:
    from trochia.analysis.plan import Plan


def heat_problems(plan: Plan) -> list[Problem]:
    """Return a warning for each motor or driver that its full current heats beyond its rating."""
    return [
        Problem(
            severity=Severity.WARNING,
            code="too-hot",
            file=plan.program.name,
            line=0,
            message=f"joint {joint.name}: {said}",
            hint="Nothing is lost by it at once; the machine's file gives current, resistance and ratings.",
        )
        for joint in plan.machine.joints
        if joint.fed is not None
        for said in heat(joint.fed).problems()
    ]
