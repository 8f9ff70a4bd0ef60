"""Will it run?  In: a plan.  Out: its problems, errors first, each at its line.

Language is judged before there is a plan (:func:`trochia.languages.gcode.problems`); here it is what the machine says:
travel, torque, feeds it cannot reach, and legal mistakes.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.counting import missed_problems
from trochia.analysis.following import ServoUse, servo_problems, servo_use
from trochia.analysis.habits import locked_moves, warnings
from trochia.analysis.loops import unstable_problems
from trochia.analysis.margins import margins
from trochia.analysis.problems import Problem, Severity, from_error, more_lines
from trochia.analysis.shaped import warning as shaping_warning
from trochia.analysis.standstill import DROPS, standstill_problems
from trochia.analysis.torque import LOST, TorqueUse, lost_step_problems, torque_use
from trochia.analysis.travel import travel_error
from trochia.analysis.warmth import heat_problems

if TYPE_CHECKING:
    from typing import Any

    from numpy.typing import NDArray

    from trochia.analysis.plan import Plan


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """The answer to "will it run": problems, and the plan where there is one.

    Attributes
    ----------
    more
        How many errors there are beyond those in ``problems``.
    torque
        What the motors have to give, by joint; of joints that name motor and driver.
    servos
        The same of servo joints that name motor, amplifier and loop.
    """

    problems: tuple[Problem, ...]
    plan: Plan | None = None
    more: int = 0
    torque: dict[str, TorqueUse] = field(default_factory=dict[str, TorqueUse])
    servos: dict[str, ServoUse] = field(default_factory=dict[str, ServoUse])

    @property
    def ok(self) -> bool:
        """Whether nothing stops it; warnings do not."""
        return not any(problem.severity is Severity.ERROR for problem in self.problems)

    @property
    def movable(self) -> bool:
        """Whether the twin can run it: there is a plan, and at worst motors that would lose steps."""
        errors = {problem.code for problem in self.problems if problem.severity is Severity.ERROR}
        return self.plan is not None and errors <= {LOST, DROPS}

    @property
    def time_s(self) -> float | None:
        """Whole time [s]; None where there is no plan."""
        return None if self.plan is None else self.plan.time_s

    def figures(self) -> dict[str, Any]:
        """Return what `trochia check --json` prints."""
        return {
            "ok": self.ok,
            "time_s": self.time_s,
            "problems": [problem.figures() for problem in self.problems],
            "more_errors": self.more,
            "margins": {} if self.plan is None else margins(self.plan, self.torque, self.servos),
        }


def judge(plan: Plan) -> Verdict:
    """Return the verdict on a plan."""
    uses, servos = torque_use(plan), servo_use(plan)
    problems = [
        *lost_step_problems(plan, uses),
        *heat_problems(plan),
        *standstill_problems(plan),
        *unstable_problems(plan),
        *servo_problems(plan, servos),
        *missed_problems(plan, servos),
        *warnings(plan.program, plan.machine),
        *_slowed(plan),
    ]
    problems += shaping_warning(plan.deviation, plan.machine, plan.program.name)
    problems.sort(key=lambda problem: problem.severity is not Severity.ERROR)
    outside = travel_error(plan)
    if outside is not None:
        problems.insert(0, from_error(outside, plan.program.name))
    return Verdict(problems=tuple(problems), plan=plan, torque=uses, servos=servos)


def _slowed(plan: Plan) -> list[Problem]:
    """Return one warning for the feeds that the machine's velocity limits do not allow."""
    rows = plan.trajectory.slowed
    locked = np.isin(rows, locked_moves(plan.program))
    found = _lost_pitch(plan, plan.program.moves["line"][rows[locked]]) if locked.any() else []
    rows = rows[~locked]
    if not len(rows):
        return found
    lines = plan.program.moves["line"][rows]
    return [
        *found,
        Problem(
            severity=Severity.WARNING,
            code="feed-slowed",
            file=plan.program.name,
            line=int(lines[0]),
            message=f"the feed is above what the machine's velocity limits allow and is slowed{more_lines(lines)}",
            hint="Nothing is wrong with the part; only the time is longer than the feed says.",
        ),
    ]


def _lost_pitch(plan: Plan, lines: NDArray[np.uint32]) -> list[Problem]:
    """Return the error of moves locked to the spindle that cannot keep up with it."""
    return [
        Problem(
            severity=Severity.ERROR,
            code="lock-too-fast",
            file=plan.program.name,
            line=int(lines[0]),
            message=f"the spindle is faster than the axes can follow at this pitch{more_lines(lines)}",
            hint="Lower S: a move locked to the spindle cannot be slowed without losing its pitch.",
        )
    ]
