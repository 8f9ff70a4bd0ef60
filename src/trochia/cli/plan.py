"""`trochia plan`: time, length, extents, and which lines cost the time."""

from __future__ import annotations

import csv
import io
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np

from trochia.cli import options
from trochia.cli.job import judge
from trochia.cli.mover import board_of, for_board
from trochia.cli.tables import clock, show_plan, show_verdict, table
from trochia.files import write_whole
from trochia.program.source import SourceText

if TYPE_CHECKING:
    from trochia.analysis.explain import Explanation
    from trochia.analysis.plan import Plan
    from trochia.languages.gcode import Reading

_WORTH = 0.0005  #: a limit that binds for less of the time is not worth a line


@click.command()
@options.common
@for_board
@click.option("--lines", "line_count", type=click.IntRange(min=0), default=5, show_default=True,
              help="How many of the slowest lines to list; with --json, 0 lists all lines.")  # fmt: skip
@click.option("--explain", "explained", is_flag=True, help="Tell which limits bind, for how long, and in which lines.")
@click.option("--csv", "csv_file", type=click.Path(dir_okay=False, path_type=Path), metavar="FILE",
              help="Write the time of every line, and the limit that binds there longest, to FILE.")  # fmt: skip
def command(
    *, program: str, machine_name: str, place: dict[str, float], profile: str | None, as_json: bool, reading: Reading,
    line_count: int, explained: bool, csv_file: Path | None, board: str | None, baud: int | None,
) -> None:  # fmt: skip
    """Time, length, extents and per-line timing of a program.

    Example: trochia plan part.ngc -m reference-mill --explain
    """
    job = judge(
        program, machine_name, place, profile, reading=reading, board_of=lambda machine: board_of(machine, board, baud)
    )
    plan = job.verdict.plan
    if plan is None or not job.verdict.ok:
        show_verdict(job.verdict)
        sys.exit(1)
    why = _explain(plan) if explained or csv_file is not None else None
    if csv_file is not None and why is not None:
        write_whole(csv_file, line_csv(plan, why, SourceText(job.text)).encode())
    lines, seconds = _slowest(plan, line_count)
    if as_json:
        timing = [
            {"line": line, "time_s": s} | ({"binding": why.line_figures(line)} if why is not None else {})
            for line, s in zip(lines.tolist(), seconds.tolist(), strict=True)
        ]
        reasons = {} if why is None else why.figures()
        options.print_json(plan.figures() | reasons | {"line_times": timing})
        return
    for problem in job.verdict.problems:
        click.echo(str(problem), err=True)
    show_plan(plan)
    if explained and why is not None:
        _show_shares(why, plan.time_s)
    if len(lines):
        source = SourceText(job.text)
        rows = [
            [f"line {n}", clock(s), *([_reasons(why, n)] if explained and why is not None else []),
             f"{source[n - 1].strip()[:60]}"]
            for n, s in zip(lines.tolist(), seconds.tolist(), strict=True)
        ]  # fmt: skip
        click.echo("the slowest lines:\n" + table(rows, left=(0, 2, 3)))


def _explain(plan: Plan) -> Explanation:
    """Return which limits bind; the room is loaded only when asked for."""
    from trochia.analysis.explain import explain  # noqa: PLC0415 - a plan without --explain needs none of it

    return explain(plan)


def line_csv(plan: Plan, why: Explanation, source: SourceText) -> str:
    """Return all lines that move as comma-separated text: number, time, what binds longest and for how long, source."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["line", "time_s", "limit", "limit_time_s", "source"])
    for line, seconds in zip(*(column.tolist() for column in plan.line_times()), strict=True):
        limit, part = next(iter(why.of_line(line)), ("", 0.0))
        writer.writerow([line, f"{seconds:.6f}", limit, f"{part:.6f}", source[line - 1].strip()])
    return text.getvalue()


def _show_shares(why: Explanation, total: float) -> None:
    """Print how long each limit binds."""
    rows = [["limit", "binds for", "of the time", "beside stops", "used"]]
    rows += [
        [share.limit, clock(share.seconds), f"{100 * share.seconds / total:.1f} %",
         clock(share.beside_stops) if share.beside_stops else "", f"{100 * share.used:.0f} %" if share.used else ""]
        for share in why.shares
        if share.seconds > _WORTH * total
    ]  # fmt: skip
    click.echo("what binds:\n" + table(rows))


def _reasons(why: Explanation, line: int) -> str:
    """Return the one or two limits that cost a line its time."""
    found = why.of_line(line)
    total = sum(seconds for _, seconds in found)
    return ", ".join(f"{limit} {100 * seconds / total:.0f} %" for limit, seconds in found[:2])


def _slowest(plan: Plan, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the lines that take longest and their seconds, slowest first; all lines in order for a count of 0."""
    lines, seconds = plan.line_times()
    if not count:
        return lines, seconds
    order = np.argsort(-seconds, kind="stable")[:count]
    return lines[order], seconds[order]
