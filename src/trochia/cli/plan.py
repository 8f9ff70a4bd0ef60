"""`trochia plan`: time, length, extents, and which lines cost the time."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import click
import numpy as np

from trochia.cli import options
from trochia.cli.job import judge
from trochia.cli.tables import clock, show_plan, show_verdict, table
from trochia.program.source import SourceText

if TYPE_CHECKING:
    from trochia.analysis.plan import Plan
    from trochia.languages.gcode import Reading


@click.command()
@options.common
@click.option("--lines", "line_count", type=click.IntRange(min=0), default=5, show_default=True,
              help="How many of the slowest lines to list; with --json, 0 lists all lines.")  # fmt: skip
def command(
    *, program: str, machine_name: str, place: dict[str, float], profile: str | None, as_json: bool, reading: Reading,
    line_count: int,
) -> None:  # fmt: skip
    """Time, length, extents and per-line timing of a program.

    Example: trochia plan part.ngc -m reference-mill --json
    """
    job = judge(program, machine_name, place, profile, reading=reading)
    plan = job.verdict.plan
    if plan is None or not job.verdict.ok:
        show_verdict(job.verdict)
        sys.exit(1)
    lines, seconds = _slowest(plan, line_count)
    if as_json:
        timing = [{"line": line, "time_s": s} for line, s in zip(lines.tolist(), seconds.tolist(), strict=True)]
        options.print_json(plan.figures() | {"line_times": timing})
        return
    for problem in job.verdict.problems:
        click.echo(str(problem), err=True)
    show_plan(plan)
    if len(lines):
        source = SourceText(job.text)
        rows = [
            [f"line {n}", clock(s), f"{source[n - 1].strip()[:60]}"]
            for n, s in zip(lines.tolist(), seconds.tolist(), strict=True)
        ]
        click.echo("the slowest lines:\n" + table(rows, left=(0, 2)))


def _slowest(plan: Plan, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the lines that take longest and their seconds, slowest first; all lines in order for a count of 0."""
    lines, seconds = plan.line_times()
    if not count:
        return lines, seconds
    order = np.argsort(-seconds, kind="stable")[:count]
    return lines[order], seconds[order]
