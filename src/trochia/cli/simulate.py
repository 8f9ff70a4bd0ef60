"""`trochia simulate`: the program on the digital twin, with recording, report and picture."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from trochia import units
from trochia.cli import options
from trochia.cli.job import judge, place_of
from trochia.cli.tables import show_plan, show_verdict
from trochia.errors import UnitError

if TYPE_CHECKING:
    from trochia.analysis.contouring import CircleTest
    from trochia.languages.gcode import Reading
    from trochia.recorder import Recording


def _period(_context: click.Context, _parameter: click.Parameter, value: str | None) -> float | None:
    """Return a sampling period from a text like ``1 ms`` or ``2 kHz`` [s]."""
    if value is None:
        return None
    for dimension in ("time", "frequency"):
        try:
            number = units.parse(value, dimension)
        except UnitError:
            continue
        if number > 0:
            return number if dimension == "time" else 1 / number
    raise click.BadParameter(f'expected a time or rate above zero with its unit, like "1 ms" or "2 kHz", not {value!r}')


def _circle(recording: Recording, output: Path) -> CircleTest:
    """Return the circle test of a recording, its picture beside the report."""
    from trochia.analysis.contouring import circle_test  # noqa: PLC0415 - asked for only
    from trochia.analysis.contouring.picture import circle_picture  # noqa: PLC0415

    test = circle_test(recording)
    circle_picture(output / "circle.png", test)
    return test


@click.command()
@options.common
@click.option("-o", "--output", type=click.Path(file_okay=False, path_type=Path), default=Path("out"),
              show_default=True, help="Folder for recording, report and picture.")  # fmt: skip
@click.option("--circle", is_flag=True, help="Tell what became of the program's longest circle in X and Y.")
@click.option("--rate", "period", callback=_period, metavar="TIME|FREQUENCY",
              help="Sampling of the recording; else the servo period, longer for long programs.")  # fmt: skip
def command(
    *, program: str, machine_name: str, place: dict[str, float], profile: str | None, as_json: bool, reading: Reading,
    output: Path, circle: bool, period: float | None,
) -> None:  # fmt: skip
    """Run a program on the digital twin: recording and report.

    Writes OUTPUT/report.html, OUTPUT/path.png and OUTPUT/recording; logs of the program (LOGOPEN) beside it.

    Example: trochia simulate programs/contour.ngc -m xy-table -o out
    """
    from trochia.analysis.prove import prove  # noqa: PLC0415 - plots and twin load only when asked for
    from trochia.cli.progress import Progress  # noqa: PLC0415
    from trochia.program.logs import logs_of, write_logs  # noqa: PLC0415

    job = judge(program, machine_name, place, profile, reading=reading)
    if job.verdict.plan is None or not job.verdict.movable:
        if as_json:
            options.print_json(job.verdict.figures())
        else:
            show_verdict(job.verdict)
        sys.exit(1)
    logs_of(job.verdict.plan.program.actions, place_of(program))  # told before the twin has run, if it cannot be
    with Progress() as progress:
        proof = prove(job.verdict, job.text, output, period=period, progress=progress)
    logs = write_logs(proof.plan.program.actions, place_of(program))
    test = _circle(proof.recording, output) if circle else None
    if as_json:
        figures = proof.figures() | ({} if test is None else {"circle": test.figures()})
        options.print_json(figures | ({"logs": [str(path) for path in logs]} if logs else {}))
        sys.exit(0 if proof.verdict.ok else 1)
    show_plan(job.verdict.plan)
    contour = proof.contour_error
    click.echo(f"contour error at most {contour.peak * 1000:.2f} µm, rms {contour.rms * 1000:.2f} µm")
    if test is not None:
        low, high = (1000 * deviation for deviation in test.radial_deviation)
        click.echo(f"circle   radius {test.radius:.4g} mm: circular deviation {1000 * test.circular_deviation:.2f} µm, "
                   f"radial deviation {low:.2f} to {high:.2f} µm, {output / 'circle.png'}")  # fmt: skip
    lost = {joint: n for joint, n in proof.lost_steps.items() if n}
    if lost:
        click.echo("lost steps: " + ", ".join(f"{joint} {n}" for joint, n in lost.items()))
    late = {axis: figures for axis, figures in proof.following_error.items() if figures.peak > 0}
    if late:
        units_of = {axis.name: axis.unit for axis in proof.plan.machine.axes}
        click.echo("following error at most " + ", ".join(
            f"{axis} {figures.peak:.4g} {units_of[axis]}" for axis, figures in late.items()))  # fmt: skip
    show_verdict(proof.verdict)
    every, servo = (1000 * seconds for seconds in (proof.recording.period, job.verdict.plan.machine.servo_period))
    if every > servo and period is None:
        click.echo(f'recorded every {every:g} ms, for it is long; --rate "{servo:g} ms" records every servo period')
    for path in logs:
        click.echo(f"log      {path}")
    click.echo(f"report   {proof.files['report']}")
    sys.exit(0 if proof.verdict.ok else 1)
