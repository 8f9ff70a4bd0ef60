"""Numbers as a person reads them: times, lengths, and columns that line up."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from collections.abc import Sequence

    from trochia.analysis.check import Verdict
    from trochia.analysis.plan import Plan

_MINUTE, _HOUR = 60.0, 3600.0
_COLOURS = {"error": "red", "warning": "yellow", "note": "cyan"}


def clock(seconds: float) -> str:
    """Return a time as ``12.345 s``, ``3 min 04.5 s`` or ``2 h 03 min 04 s``."""
    if seconds < _MINUTE:
        return f"{seconds:.3f} s"
    if seconds < _HOUR:
        minutes, rest = divmod(round(seconds, 1), _MINUTE)
        return f"{minutes:.0f} min {rest:04.1f} s"
    hours, rest = divmod(round(seconds), _HOUR)
    return f"{hours:.0f} h {rest // _MINUTE:02.0f} min {rest % _MINUTE:02.0f} s"


def table(rows: Sequence[Sequence[str]], left: Sequence[int] = (0,)) -> str:
    """Return rows with columns aligned: those in ``left`` to the left, the others to the right."""
    widths = [max(len(cell) for cell in column) for column in zip(*rows, strict=True)]
    return "\n".join(
        "  "
        + "  ".join(
            cell.ljust(width) if i in left else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    )


def show_verdict(verdict: Verdict) -> None:
    """Print the problems and, last, the answer."""
    for problem in verdict.problems:
        kind, colon, rest = str(problem).partition(":")
        click.echo(click.style(kind, fg=_COLOURS[kind], bold=True) + colon + rest)
    if verdict.more:
        click.echo(f"… and {verdict.more} more line{'s' if verdict.more > 1 else ''} with errors")
    if not verdict.ok:
        click.secho("It will not run.", fg="red", bold=True)
    elif verdict.problems:
        click.secho("It will run, with warnings.", fg="yellow", bold=True)
    else:
        click.secho("It will run.", fg="green", bold=True)


def show_plan(plan: Plan) -> None:
    """Print time, size and peaks of a plan."""
    parts = ", ".join(f"{cause} {clock(s)}" for cause, s in plan.trajectory.times.items() if s)
    click.echo(f"time     {clock(plan.time_s)}" + (f"  ({parts})" if parts else ""))
    click.echo(
        f"length   {plan.feed_length_mm:.3f} mm in {plan.size.feed_moves} feed moves, "
        f"{plan.rapid_length_mm:.3f} mm in {plan.size.moves - plan.size.feed_moves} rapids, {plan.program.lines} lines"
    )
    if plan.trajectory.shaping is not None and plan.deviation is not None:
        from trochia.analysis.shaped import words  # noqa: PLC0415 - `trochia --help` must stay light

        click.echo(f"shaping  {words(plan.machine)}: up to {plan.deviation.peak:.3f} mm off the path, "
                   f"ends {1000 * plan.trajectory.shaping.delay:.1f} ms later")  # fmt: skip
    rows = [["axis", "from", "to", "peak velocity", "of", "peak acceleration", "of"]]
    extents, all_peaks = plan.extents, plan.trajectory.peaks
    for axis in plan.machine.axes:
        unit = "mm" if axis.kind.value == "linear" else "deg"
        low, high = extents[axis.name]
        peaks = all_peaks[axis.name]
        rows.append([axis.name, f"{low:.3f}", f"{high:.3f} {unit}", f"{peaks['velocity'] or 0.0:.2f}",
                     f"{axis.velocity:g} {unit}/s", f"{peaks['acceleration'] or 0.0:.1f}",
                     f"{axis.acceleration:g} {unit}/s²"])  # fmt: skip
    click.echo(table(rows))
