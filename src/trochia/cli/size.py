"""``trochia size``: whether the motor of a joint is right for what it has to do."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from trochia.cli import options
from trochia.cli.motor_options import joint_motor
from trochia.cli.step_units import positive
from trochia.cli.tables import table

if TYPE_CHECKING:
    from trochia.analysis.sizing import Sizing
    from trochia.cli.motor_options import Asked


@click.command()
@options.machine
@click.option("--joint", metavar="NAME", help="One joint; without it all that name motor and driver.")
@click.option(
    "--program",
    type=click.Path(exists=True, dir_okay=False),
    metavar="PROGRAM",
    help="Judge by what a program asks; without it by the limits of the machine's axes, all the time.",
)
@click.option("--move", metavar="LENGTH", help='Judge by one move, "200 mm" (with --time).')
@click.option("--time", metavar="TIME", help='In which the move is made, "0.5 s".')
@click.option("--rest", metavar="TIME", help='Between two moves, "1 s".')
@options.as_json
def command(*, machine_name: str, joint: str | None, as_json: bool, **given: Any) -> None:  # noqa: ANN401 - click's
    """Is the motor strong, fast and cool enough: torque, speed, inertia ratio, margin and heat of a joint.

    Exit code 1 where a motor will not do; what would is told.

    Example: trochia size -m stage.toml --joint X --move "200 mm" --time "0.4 s" --rest "1 s"
    """  # fmt: skip
    from trochia import api  # noqa: PLC0415 - `trochia --help` must stay light

    machine = api.load(machine_name)
    names = [one.name for one in machine.joints if one.fed is not None]
    chosen = [joint] if joint is not None or not names else names
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


def _size(one: Asked, given: dict[str, Any]) -> Sizing:
    """Return the sizing of a joint by program, move or limits."""
    from trochia import api  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.analysis.sizing import Duty, duty_of_move, size_by_duty, size_by_points  # noqa: PLC0415
    from trochia.analysis.sweep import operating_points  # noqa: PLC0415
    from trochia.machine.rates import joint_velocity  # noqa: PLC0415

    assert one.machine is not None
    assert one.drive is not None
    if (given["move"] is None) != (given["time"] is None):
        raise click.UsageError("A move needs its time: give --move and --time.")
    row = one.machine.kinematics.matrix[one.joint]
    if given["program"] is not None:
        verdict = api.check(Path(given["program"]).read_bytes(), one.machine, name=given["program"])
        if verdict.plan is None:
            raise click.BadParameter(str(verdict.problems[0]), param_hint="--program")
        return size_by_points(one.drive, operating_points(verdict.plan, one.joint, one.drive))
    if given["move"] is not None:
        rotary = any(axis.rotary for axis, c in zip(one.machine.axes, row, strict=True) if c)
        distance = positive(given["move"], "angle" if rotary else "length", "--move")
        rest = 0.0 if given["rest"] is None else positive(given["rest"], "time", "--rest")
        return size_by_duty(one.drive, duty_of_move(distance, positive(given["time"], "time", "--time"), rest))
    acceleration = sum(abs(float(c)) * axis.acceleration for c, axis in zip(row, one.machine.axes, strict=True))
    return size_by_duty(one.drive, Duty(velocity=joint_velocity(one.machine, one.joint), acceleration=acceleration))


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
