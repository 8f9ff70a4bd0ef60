"""``trochia sweep``: a stepper's torque-speed curve behind its driver, and where a program works on it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from trochia.cli import options
from trochia.cli.motor_options import KINDS, Asked, asked, motor_options
from trochia.cli.tables import table
from trochia.files import write_whole

if TYPE_CHECKING:
    from trochia.analysis.sweep import Curve, OperatingPoints

_TIMINGS = ("exact", "millisecond", "shield")  # those of `analysis.sweep.TIMINGS`
_BESIDES = 5  # curves over the first
_COMPARE = "compare"  # full steps with one phase and with both, timed by the shield and exactly
_ROWS = 12  # of the curve on a terminal


@dataclass(frozen=True, slots=True, kw_only=True)
class _Found:
    """A curve, and the operating points of a program on it."""

    asked: Asked
    curve: Curve
    points: OperatingPoints | None = None
    others: tuple[_Found, ...] = ()

    def figures(self) -> dict[str, Any]:
        """Return what ``--json`` prints, files apart."""
        from trochia.machine.drivers import heat  # noqa: PLC0415 - `trochia --help` must stay light

        warm = heat(self.asked.made)
        return {
            "motor": self.asked.title,
            "excitation": self.asked.made.excitation.name,
            **self.curve.figures(),
            "heat_W": {"motor": warm.motor, "motor_rated": warm.rated, "driver": warm.driver},
            "problems": warm.problems(),
            "program": None if self.points is None else _points_figures(self.points),
            "others": [one.figures() for one in self.others],
        }


@click.command()
@motor_options
@click.option(
    "--program", type=options.type_program, metavar="PROGRAM", help="Draw the operating points of a program (with -m)."
)
@click.option("--also-supply", multiple=True, metavar="VOLTAGE", help='Draw it besides at another supply, "48 V".')
@click.option("--also-driver", multiple=True, type=click.Choice(KINDS, case_sensitive=False), help="Behind another.")
@click.option("--also-excitation", multiple=True, metavar="NAME", help="With another excitation.")
@click.option("--also-motor", multiple=True, metavar="MOTOR", help="Draw another motor behind the same driver.")
@click.option("--top", metavar="SPEED", help='Greatest speed, "1500 rpm"; else where a fifth of the torque is left.')
@click.option("--points", type=click.IntRange(2, 500), default=40, show_default=True, help="Speeds of the curve.")
@click.option(
    "--measure", is_flag=True, help="Also measure pull-out and pull-in torque on the twin; takes some seconds."
)
@click.option(
    "--limits",
    type=click.Choice((*_TIMINGS, _COMPARE)),
    metavar="|".join((*_TIMINGS, _COMPARE)),
    help="Also search pull-out and start/stop speed on the twin, with pulses timed so; compare: both full steps, timed "
    "by the shield's library and exactly.",
)
@click.option(
    "-o", "--plot", type=click.Path(dir_okay=False, writable=True), metavar="FILE.png|FILE.svg", help="Draw the curve."
)
@click.option(
    "--csv", "csv_file", type=click.Path(dir_okay=False, writable=True), metavar="FILE.csv", help="Write the curve."
)
@options.as_json
def command(*, plot: str | None, csv_file: str | None, as_json: bool, **given: Any) -> None:  # noqa: ANN401 - click's
    """Torque over speed of a stepper behind its driver: by closed forms at once, on the twin where asked.

    Exit code 1 where a program given would lose steps.

    Example: trochia sweep --motor QSH5718-55 --supply "12 V" --also-supply "24 V" --current "2.5 A" -o torque.png
    """  # fmt: skip
    for option, file in (("--plot", plot), ("--csv", csv_file)):
        if file is not None and not Path(file).parent.is_dir():
            raise click.BadParameter(f"there is no folder {Path(file).parent}", param_hint=option)
    if plot is not None and Path(plot).suffix not in {".png", ".svg"}:
        raise click.BadParameter(f"expected a name that ends in .png or .svg, not {plot}", param_hint="--plot")
    found = _find(given)
    if csv_file is not None:
        write_whole(Path(csv_file), _csv(found.curve).encode())
    if plot is not None:
        from trochia.analysis.sweep.picture import picture  # noqa: PLC0415 - it loads matplotlib

        drawn = picture(found.curve, _title(found.asked), found.points, margin=found.asked.margin,
                        others=[(_title(one.asked), one.curve) for one in found.others],
                        form=Path(plot).suffix[1:])  # fmt: skip
        write_whole(Path(plot), drawn)
    files = [file for file in (csv_file, plot) if file is not None]
    if as_json:
        options.print_json(found.figures() | {"files": files})
    else:
        for one in (found, *found.others):
            _show(one)
        for file in files:
            click.echo(f"wrote {file}")
    if found.points is not None and _over(found) > 0:
        raise SystemExit(1)


def _find(given: dict[str, Any]) -> _Found:
    """Return the curve and the points that the options ask for."""
    from trochia.analysis.sweep import TIMINGS, curve  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.analysis.sweep.curve import FALLEN  # noqa: PLC0415
    from trochia.cli.progress import Progress  # noqa: PLC0415
    from trochia.cli.step_units import speed  # noqa: PLC0415

    wanted, *besides = _cases(given)
    top = None
    if given["top"] is not None:
        full = wanted.made.motor.full_steps
        top = math.tau * speed(given["top"], full, "--top") / full
    elif besides:
        top = max(one.made.top(FALLEN) for one in (wanted, *besides))
    with Progress() as progress:
        made, *others = (
            curve(
                one.made, one.load, top=top, points=given["points"], measure=given["measure"],
                timing=TIMINGS.get(given["limits"]), compared=given["limits"] == _COMPARE, progress=progress,
            ) for one in (wanted, *besides)
        )  # fmt: skip
    return _Found(
        asked=wanted, curve=made, points=_points(wanted, given["program"]),
        others=tuple(_Found(asked=one, curve=found) for one, found in zip(besides, others, strict=True)),
    )  # fmt: skip


def _cases(given: dict[str, Any]) -> list[Asked]:
    """Return the motor asked for, and what is to be drawn besides, each with one thing changed."""
    first = asked(given)
    changes = [(name, value) for name in ("supply", "driver", "excitation", "motor") for value in given[f"also_{name}"]]
    if changes and first.machine is not None:
        raise click.UsageError("What is drawn besides a motor of a machine is not known: give --motor and its driver.")
    if len(changes) > _BESIDES:
        raise click.UsageError(f"At most {_BESIDES} curves are drawn besides, not {len(changes)}.")
    return [first, *(asked(given | {name: value}) for name, value in changes)]


def _title(one: Asked) -> str:
    """Return what to call a curve."""
    mode = one.made.excitation.name
    return f"{one.title}, {mode}" + (f", {one.made.current:.3g} A" if one.made.driver.current is not None else "")


def _points(wanted: Asked, program: str | None) -> OperatingPoints | None:
    """Return the operating points of a program, read as `check` reads it without options."""
    if program is None:
        return None
    from trochia import api  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.analysis.sweep import operating_points  # noqa: PLC0415

    if wanted.machine is None or wanted.drive is None:
        raise click.BadParameter("a program needs a machine: give -m", param_hint="--program")
    verdict = api.check(Path(program).read_bytes(), wanted.machine, name=program)
    if verdict.plan is None:
        problem = verdict.problems[0]
        raise click.BadParameter(str(problem), param_hint="--program")
    return operating_points(verdict.plan, wanted.joint, wanted.drive)


def _show_compared(rows: list[dict[str, Any]]) -> None:
    """Print the limits of both full steps, as asked for and as turned."""
    cells = [["limits on the twin [rpm]", "timing", "pull-out", "turned", "start/stop", "turned", "first loss"]]
    names = ("pull_out_rpm", "pull_out_turned_rpm", "start_stop_rpm", "start_stop_turned_rpm", "start_stop_first_rpm")
    cells += [[row["excitation"], row["timing"], *(f"{row[name]:.0f}" for name in names)] for row in rows]
    click.echo(table(cells, left=(0, 1)))


def _over(found: _Found) -> int:
    """Return how many operating points lie above the curve."""
    import numpy as np  # noqa: PLC0415 - `trochia --help` must stay light

    assert found.points is not None
    there = found.asked.made.pull_out(found.points.speed)
    return int(np.count_nonzero(found.points.torque > there))


def _points_figures(points: OperatingPoints) -> dict[str, Any]:
    """Return a program's points by JSON's keys."""
    from trochia.analysis.sweep.curve import RPM  # noqa: PLC0415 - `trochia --help` must stay light

    rows = zip((points.speed * RPM).tolist(), points.torque.tolist(), points.line.tolist(), strict=True)
    return {
        "rms_torque_Nm": points.rms,
        "duty": points.duty,
        "points": [{"speed_rpm": speed, "torque_Nm": torque, "line": line} for speed, torque, line in rows],
    }


def _csv(made: Curve) -> str:
    """Return the curve as CSV, which ``trochia profile --torque-curve`` reads where it has two columns."""
    rows = made.figures()["curve"]
    columns: list[str] = [name for name in rows[0] if rows[0][name] is not None and name != "speed_steps_s"]
    names: dict[str, str] = {"pull_out_Nm": "torque_Nm"} if len(columns) == 2 else {}
    lines = [",".join(names.get(name, name) for name in columns)]
    # the closed form may fall below zero: no torque is left there
    lines += [",".join(f"{max(row[name], 0.0):.9g}" for name in columns) for row in rows]
    return "\n".join(lines) + "\n"


def _show(found: _Found) -> None:
    """Print the curve's rows and what limits it."""
    figures = found.figures()
    click.secho(f"{found.asked.title}, {figures['excitation']}", bold=True)
    rows = figures["curve"]
    shown = rows[:: max(1, len(rows) // _ROWS)]
    columns = [name for name in shown[0] if shown[0][name] is not None]
    heads = {"speed_rpm": "rpm", "speed_steps_s": "full steps/s", "pull_out_Nm": "pull-out N·m",
             "measured_Nm": "measured N·m", "pull_in_Nm": "pull-in N·m"}  # fmt: skip
    cells = [[heads[name] for name in columns]]
    cells += [[f"{row[name]:.{0 if name.startswith('speed') else 4}f}" for name in columns] for row in shown]
    click.echo(table(cells, left=()))
    click.echo(f"  holds {figures['holding_torque_Nm']:.3g} N·m at rest with {figures['current_A']:.3g} A a phase; "
               f"swings at {figures['resonance_Hz']:.0f} Hz")  # fmt: skip
    for name, words in (("corner_rpm", "the supply drives the full current up to {:.0f} rpm"),
                        ("start_stop_rpm", "starts without a ramp below some {:.0f} rpm (an estimate from energy)"),
                        ("fastest_rpm", "of use up to {:.0f} rpm, a fifth of its torque")):  # fmt: skip
        if figures[name] is not None:
            click.echo(f"  {words.format(figures[name])}")
    for low, high in figures["unstable_rpm"]:
        click.echo(f"  hunts from {low:.0f} to {high:.0f} rpm by linear theory; damping or a higher supply helps")
    for name, value in figures["limits_rpm"].items():
        said = f"{value:.0f} rpm"
        click.echo(f"  {name.replace('_', '/' if name == 'start_stop' else '-')} speed on the twin: {said}")
    if figures["limits_compared"]:
        _show_compared(figures["limits_compared"])
    for problem in figures["problems"]:
        click.secho(f"  too hot: {problem}", fg="red")
    if found.points is not None:
        over = _over(found)
        click.secho("  the program stays below the curve" if not over else "  the program asks more than the motor has",
                    fg="green" if not over else "red")  # fmt: skip
