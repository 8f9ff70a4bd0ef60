"""The proof of a plan: run it on the twin, keep the recording, write the report and the picture.

In: a verdict with its plan and the program's text.  Out: a :class:`Proof`, and three files in a folder.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

from trochia import recorder
from trochia.analysis.compose import report_data
from trochia.analysis.counting import lost_problems
from trochia.analysis.errors import contour_error, following_error, lost_steps
from trochia.analysis.following import following_problems
from trochia.analysis.plots import path_picture
from trochia.analysis.problems import Severity
from trochia.analysis.report import write_report
from trochia.backends import Twin
from trochia.program.source import SourceText

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from trochia.analysis.check import Verdict
    from trochia.analysis.plan import Plan
    from trochia.recorder import Figures, Recording

    Blocks = Iterator[Mapping[str, NDArray[Any]]]
    Progress = Callable[[str, float], None]

MOST_SAMPLES = 2_000_000  #: of a recording whose sampling nobody chose: some 300 MB for three axes


@dataclass(frozen=True, slots=True, kw_only=True)
class Proof:
    """What the twin did with a plan.

    Attributes
    ----------
    verdict
        On the plan, with what the run has shown.
    following_error, contour_error
        Peak and rms of actual minus commanded, and of the distance to the commanded path [mm, degree].
    lost_steps
        Steps missing at the end, by stepper joint.
    files
        ``report``, ``picture`` and ``recording``.
    """

    plan: Plan
    verdict: Verdict
    recording: Recording
    following_error: dict[str, Figures]
    contour_error: Figures
    lost_steps: dict[str, int]
    files: dict[str, str]

    def figures(self) -> dict[str, Any]:
        """Return what `trochia simulate --json` prints."""
        return self.plan.figures() | {
            "ok": self.verdict.ok,
            "problems": [problem.figures() for problem in self.verdict.problems],
            "following_error": {axis: asdict(figures) for axis, figures in self.following_error.items()},
            "contour_error_mm": asdict(self.contour_error),
            "lost_steps": self.lost_steps,
            "files": self.files,
        }


def prove(
    verdict: Verdict, text: bytes, folder: Path, *, period: float | None = None, progress: Progress | None = None
) -> Proof:
    """Return the proof of a verdict's plan, with its files written into ``folder``.

    Parameters
    ----------
    period
        Time between samples [s]; without it the machine's servo period, or so many of them that a long program's
        recording has at most :data:`MOST_SAMPLES`.
    progress
        Is told the step and the fraction done.
    """
    plan = verdict.plan
    if plan is None:
        raise ValueError("only a verdict with a plan can be proved")
    folder.mkdir(parents=True, exist_ok=True)
    twin = Twin(machine=plan.machine, period=period or _period(plan))
    blocks = _told(twin.run(plan.trajectory), twin.tick / plan.time_s if plan.time_s else 1.0, progress)
    recorder.write(folder / "recording", twin.header(plan.trajectory, program=plan.program.name), blocks)
    recording = recorder.read(folder / "recording")
    verdict = _seen(verdict, plan, recording)
    data = report_data(verdict, plan, recording, SourceText(text))
    write_report(folder / "report.html", data)
    path_picture(folder / "path.png", data)
    return Proof(
        plan=plan,
        verdict=verdict,
        recording=recording,
        following_error=following_error(recording),
        contour_error=contour_error(recording),
        lost_steps=lost_steps(recording, plan.machine),
        files={
            name: str(folder / file)
            for name, file in (("report", "report.html"), ("picture", "path.png"), ("recording", "recording"))
        },
    )


def _seen(verdict: Verdict, plan: Plan, recording: Recording) -> Verdict:
    """Return the verdict with the problems that the run has shown, errors first."""
    found = [*verdict.problems, *following_problems(plan, recording), *lost_problems(plan, recording)]
    found.sort(key=lambda problem: problem.severity is not Severity.ERROR)
    return replace(verdict, problems=tuple(found))


def _period(plan: Plan) -> float:
    """Return the sampling of a recording nobody chose one for [s]."""
    servo = plan.machine.servo_period
    return servo * max(1, math.ceil(plan.time_s / servo / MOST_SAMPLES))


def _told(blocks: Blocks, fraction: float, progress: Progress | None) -> Blocks:
    """Yield the blocks and tell how much of the whole is done; ``fraction`` is that of one sample."""
    done = 0
    for block in blocks:
        yield block
        done += len(block["path.speed"])
        if progress is not None:
            progress("simulating", done * fraction)
