"""Encoders that miss edges: what is to be expected before a run, and what the run shows.

In: a plan with the ways its servo joints go; the recording of its run.  Out: problems.

An edge that is missed shifts the joint's zero by a count, and the loop follows the shifted one.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.problems import Problem, Severity

if TYPE_CHECKING:
    from collections.abc import Mapping

    from trochia.analysis.following import ServoUse
    from trochia.analysis.plan import Plan
    from trochia.machine.encoders import Encoder
    from trochia.recorder import Recording

MISSES = "encoder-misses"  #: edges will be missed, says the machine's file
LOST = "counts-lost"  #: counts were lost in the run


def missed_problems(plan: Plan, uses: Mapping[str, ServoUse]) -> list[Problem]:
    """Return a warning for each encoder that will miss an edge or more, by its file's ``missed``."""
    problems: list[Problem] = []
    for joint in plan.machine.joints:
        use, encoder, counts = uses.get(joint.name), joint.encoder, joint.counts_per_unit
        if use is None or encoder is None or counts is None or not encoder.missed:
            continue
        passed = use.way * abs(float(counts))
        expected = passed * encoder.missed
        if expected < 1.0:
            continue
        spread = 3.0 * math.sqrt(expected * (1.0 - encoder.missed)) / abs(float(counts))
        unit = plan.machine.axes[0].unit
        problems.append(Problem(
            severity=Severity.WARNING, code=MISSES, file=plan.program.name, line=use.line,
            message=f"the encoder of joint {joint.name} misses some {expected:.0f} of the {passed:.3g} edges that it "
            f"passes: ways to and fro cancel on average, and leave up to {spread:.3g} {unit}",
            hint=_hint(encoder),
        ))  # fmt: skip
    return problems


def lost_problems(plan: Plan, recording: Recording) -> list[Problem]:
    """Return a warning for each servo joint whose encoder stands elsewhere than its motor at the run's end."""
    problems: list[Problem] = []
    for joint in plan.machine.joints:
        encoder, counts = joint.encoder, joint.counts_per_unit
        name = f"joint.{joint.name}"
        if encoder is None or counts is None or encoder.edges is None or f"{name}.measured" not in recording:
            continue
        where = recording[f"{name}.{'actual' if encoder.on_load else 'motor'}"][-1:]
        off = (recording[f"{name}.measured"][-1:] - where) * abs(float(counts))
        lost = int(np.rint(off[0] + 0.5))  # a counter tells the count below: half a one on average
        if abs(lost) > (1 if encoder.jitter else 0):
            problems.append(Problem(
                severity=Severity.WARNING, code=LOST, file=plan.program.name, line=int(recording["path.line"][-1]),
                message=f"at the end the encoder of joint {joint.name} is {lost:+d} counts off, "
                f"{lost / abs(float(counts)):+.4g} {plan.machine.axes[0].unit}: so far is the joint from its command",
                hint=_hint(encoder),
            ))  # fmt: skip
    return problems


def _hint(encoder: Encoder) -> str:
    tells = "Its index pulses tell" if encoder.index else "It has no index pulse, so nothing tells"
    return f"{tells}; home again, or mend cable, disc or the speed at which its edges come."
