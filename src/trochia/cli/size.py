"""``trochia size``: whether a motor is right for what it has to do, and which of the library would be."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from trochia.cli import options
from trochia.cli.motor_options import joint_motor, motor_options, of_motor, of_row
from trochia.cli.step_units import positive
from trochia.cli.tables import table
from trochia.errors import TrochiaError

if TYPE_CHECKING:
    from trochia.analysis.sizing import Duty, Sizing
    from trochia.cli.motor_options import Asked

_MOST = 12  # suggestions that are told


@click.command()
@motor_options
@click.option(
    "--program",
    type=click.Path(exists=True, dir_okay=False),
    metavar="PROGRAM",
    help="Judge by what a program asks (with -m); without it, or a duty, by the limits of the axes, all the time.",
)
@click.option("--move", metavar="LENGTH", help='Judge by one move, "200 mm" or "90 deg" (with --time).')
@click.option("--time", metavar="TIME", help='In which the move is made, "0.5 s".')
@click.option("--rest", metavar="TIME", help='Between two moves, "1 s".')
@click.option("--speed", metavar="SPEED", help='Judge by speed and acceleration, "100 mm/s" or "300 rpm".')
@click.option("--acceleration", metavar="A", help='"2000 mm/s2" or "500 rad/s2" (with --speed).')
@click.option("--suggest", is_flag=True, help="List the motors of the library that would do behind this driver.")
@options.as_json
def command(*, as_json: bool, **given: Any) -> None:  # noqa: ANN401 - click's
    """Is the motor strong, fast and cool enough: torque, speed, inertia ratio, margin and heat.

    Of the joints of a machine (-m; without --joint all that name motor and driver), or of a motor with driver and load.

    Exit code 1 where a motor will not do; what would is told.

    Example: trochia size -m stage.toml --joint X --move "200 mm" --time "0.4 s" --rest "1 s"

    Example: trochia size --suggest --supply "24 V" --current "2 A" --travel-per-turn "5 mm" --mass "10 kg" --vertical
    --speed "50 mm/s" --acceleration "500 mm/s2"
    """
    if (given["move"] is None) != (given["time"] is None):
        raise click.UsageError("A move needs its time: give --move and --time.")
    if (given["speed"] is None) != (given["acceleration"] is None):
        raise click.UsageError("A speed needs its acceleration: give --speed and --acceleration.")
    if given["machine_name"] is None and given["motor"] is None and not given["suggest"]:
        raise click.UsageError("Give a machine (-m), a motor (--motor), or --suggest.")
    if given["machine_name"] is not None:
        _machine(given, as_json=as_json)
    else:
        _motors(given, as_json=as_json)


def _machine(given: dict[str, Any], *, as_json: bool) -> None:
    """Size the joints of a machine."""
    from trochia import api  # noqa: PLC0415 - `trochia --help` must stay light

    if given["motor"] is not None or given["suggest"]:
        raise click.UsageError("Give a machine (-m), or a motor and its load by options (--motor, --suggest).")
    machine = api.load(given["machine_name"])
    names = [one.name for one in machine.joints if one.fed is not None]
    chosen = [given["joint"]] if given["joint"] is not None or not names else names
    asked = [joint_motor(machine, name) for name in chosen]
    sizings = [_size(one, given) for one in asked]
    if as_json:
        options.print_json({
            one.machine.joints[one.joint].name: sizing.figures()
            for one, sizing in zip(asked, sizings, strict=True) if one.machine is not None
        })  # fmt: skip
    else:
        for one, sizing in zip(asked, sizings, strict=True):
            _show(one.title, sizing)
    if not all(sizing.ok for sizing in sizings):
        raise SystemExit(1)


def _motors(given: dict[str, Any], *, as_json: bool) -> None:
    """Size a motor by options, list those of the library that would do, or both."""
    asked = None if given["motor"] is None else of_motor(given)
    sizing = None if asked is None else _size(asked, given)
    would = _suggested(given) if given["suggest"] else []
    if as_json:
        listed = [{"motor": name, **found.figures()} for name, found in would] if given["suggest"] else None
        options.print_json((sizing.figures() if sizing is not None else {"ok": bool(would)}) | {"would_do": listed})
    else:
        if asked is not None and sizing is not None:
            _show(asked.title, sizing)
        if given["suggest"]:
            _show_suggested(would)
    if not (sizing.ok if sizing is not None else would):
        raise SystemExit(1)


def _suggested(given: dict[str, Any]) -> list[tuple[str, Sizing]]:
    """Return the motors of the library that do it behind the driver, at their rated current at most; weakest first.

    Raises
    ------
    click.UsageError
        For options that are at fault whatever the motor.
    """
    from trochia.machine.motors import library  # noqa: PLC0415 - `trochia --help` must stay light

    found: list[tuple[float, str, Sizing]] = []
    for name, row in library().items():
        own = dict(given)
        if own["current"] is not None and row.current < positive(own["current"], "current", "--current"):
            own["current"] = f"{row.current:g} A"
        try:
            one = of_row(name, row, own)
            sizing = _size(one, given)
        except TrochiaError:  # a supply too low for it, a wiring it has not: it will not do
            continue
        if sizing.ok:
            found.append((one.made.holding, f"{name} at {one.made.current:.3g} A", sizing))
    return [(name, sizing) for _, name, sizing in sorted(found, key=lambda row: row[:2])]


def _size(one: Asked, given: dict[str, Any]) -> Sizing:
    """Return the sizing by program, move, speed or limits."""
    from trochia.analysis.sizing import size_by_duty, size_by_points  # noqa: PLC0415 - `trochia --help` must stay light

    motor = one.drive
    if motor is None:
        travel = one.travel or 360.0
        motor = replace(one.shaft, per_radian=travel / math.tau)
    if given["program"] is None:
        return size_by_duty(motor, _duty(one, given))
    from trochia import api  # noqa: PLC0415 - as above
    from trochia.analysis.sweep import operating_points  # noqa: PLC0415

    if one.machine is None:
        raise click.BadParameter("a program needs a machine: give -m", param_hint="--program")
    verdict = api.check(Path(given["program"]).read_bytes(), one.machine, name=given["program"])
    if verdict.plan is None:
        raise click.BadParameter(str(verdict.problems[0]), param_hint="--program")
    return size_by_points(motor, operating_points(verdict.plan, one.joint, motor))


def _duty(one: Asked, given: dict[str, Any]) -> Duty:
    """Return the duty in the joint's own travel: mm, or degrees where it turns, or nobody said what a turn moves."""
    from trochia.analysis.sizing import Duty, duty_of_move  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.cli.step_units import StepScale  # noqa: PLC0415
    from trochia.machine.rates import joint_velocity  # noqa: PLC0415

    turn = one.travel or 360.0
    scale = StepScale(per_turn=one.pulses_per_turn, travel=one.travel, rotary=one.rotary)
    unit = turn / one.pulses_per_turn
    if given["move"] is not None:
        rest = 0.0 if given["rest"] is None else positive(given["rest"], "time", "--rest")
        distance = scale.length(given["move"], "--move") * unit
        return duty_of_move(distance, positive(given["time"], "time", "--time"), rest)
    if given["speed"] is not None:
        return Duty(
            velocity=scale.speed(given["speed"], "--speed") * unit,
            acceleration=scale.acceleration(given["acceleration"], "--acceleration") * unit,
        )
    if one.machine is None:
        raise click.UsageError("Say what it has to do: --move and --time, or --speed and --acceleration.")
    row = one.machine.kinematics.matrix[one.joint]
    acceleration = sum(abs(float(c)) * axis.acceleration for c, axis in zip(row, one.machine.axes, strict=True))
    return Duty(velocity=joint_velocity(one.machine, one.joint), acceleration=acceleration)


def _show(title: str, sizing: Sizing) -> None:
    """Print what is asked, what there is, and the verdict."""
    figures = sizing.figures()
    click.secho(title, bold=True)
    click.echo(table([
        ["greatest speed", f"{figures['speed_rpm']:.0f} rpm", f"usable torque up to {figures['reach_rpm']:.0f} rpm"],
        ["torque where it is tightest", f"{sizing.torque:.3g} N·m", f"of {sizing.available:.3g} N·m"],
        ["margin", f"{figures['margin']:.0%}", ""],
        ["effective torque", f"{sizing.effective:.3g} N·m", ""],
        ["inertia, load to rotor", f"{sizing.inertia_ratio:.3g}", ""],
        ["heat of the motor", f"{sizing.motor_heat:.3g} W", f"rated {sizing.rated_heat:.3g} W"],
        ["heat of the driver", f"{sizing.driver_heat:.3g} W", ""],
    ], left=(0, 2)))  # fmt: skip
    for remark in sizing.remarks:
        click.echo(f"  {remark}")
    click.secho(f"  {'It will do' if sizing.ok else 'It will not do'}", fg="green" if sizing.ok else "red")
    for problem in sizing.problems:
        click.echo(f"  {problem}")


def _show_suggested(would: list[tuple[str, Sizing]]) -> None:
    """Print the motors that would do, the weakest first."""
    if not would:
        click.secho("No motor of the library does it behind this driver: a higher supply, more current, a gear or a "
                    "lighter load would help.", fg="red")  # fmt: skip
        return
    click.secho(f"{len(would)} of the library would do, the weakest first", bold=True)
    rows = [["motor", "asked N·m", "there N·m", "left", "load to rotor", "heat W"]]
    rows += [
        [name, f"{one.torque:.3g}", f"{one.available:.3g}", f"{one.figures()['margin']:.0%}",
         f"{one.inertia_ratio:.3g}", f"{one.motor_heat:.3g} of {one.rated_heat:.3g}"] for name, one in would[:_MOST]
    ]  # fmt: skip
    click.echo(table(rows))
    if len(would) > _MOST:
        click.echo(f"  … and {len(would) - _MOST} stronger ones")
