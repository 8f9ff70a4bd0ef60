"""``trochia excitation``: what a mode switches on step by step, as a table with latch bytes, and as a picture."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from trochia.cli import options
from trochia.cli.motor_options import named
from trochia.cli.step_units import positive, speed
from trochia.cli.tables import table
from trochia.files import write_whole

if TYPE_CHECKING:
    from trochia.analysis.phase_currents import PhaseCurrents
    from trochia.pulses.excitation_table import Step

_SHOWN = 33  # rows on a terminal; more are in --csv and --json
_SHIELD = ("one-phase", "two-phase", "half-step", "microstep-table")  # what the shield's latch and enables make


def _byte(_context: click.Context, _parameter: click.Parameter, value: str) -> int:
    """Return ``0xC0``, ``C0`` or ``192`` … as a byte."""
    try:
        byte = int(value, 0 if value.lower().startswith("0x") else 16)
    except ValueError:
        byte = -1
    if not 0 <= byte <= 0xFF:
        raise click.BadParameter(f"expected a byte, 00 to FF, not {value!r}")
    return byte


@click.command()
@click.argument("mode", metavar="[MODE]", required=False)
@click.option(
    "--phases",
    type=click.IntRange(2, 16),
    default=2,
    show_default=True,
    help="2: bipolar, A+ B+ A- B-; more: on or off, as from a ring counter.",
)
@click.option("--back", is_flag=True, help="Backwards: A+ B- A- B+.")
@click.option(
    "--image",
    callback=_byte,
    default="00",
    metavar="BYTE",
    help="What the shield's register holds: the bits of the other motor stay.",
)
@click.option("--motor", metavar="NAME", help="Draw the phase currents of this motor (with --supply and --speed).")
@click.option("--supply", metavar="VOLTAGE", help='Across a phase, the bridge\'s drop taken off, "9.4 V".')
@click.option("--series", metavar="RESISTANCE", help='A resistor before each phase, "20 ohm".')
@click.option("--speed", "rate", metavar="SPEED", help='"100 rpm" or "300 steps/s" (full steps).')
@click.option("--load-torque", "load", metavar="TORQUE", default="0 N·m", help="Under which it runs.")
@click.option(
    "-o",
    "--plot",
    type=click.Path(dir_okay=False, writable=True),
    metavar="FILE.png|FILE.svg",
    help="Draw levels, currents, and the way of the field.",
)
@click.option(
    "--bridge",
    type=click.Path(dir_okay=False, writable=True),
    metavar="FILE.png|FILE.svg",
    help="Draw a phase's bridge in its states, with the way of the current.",
)
@click.option(
    "--csv",
    "csv_file",
    type=click.Path(dir_okay=False, writable=True),
    metavar="FILE.csv",
    help="Write the whole table.",
)
@options.as_json
def command(*, mode: str | None, phases: int, back: bool, image: int, as_json: bool,
            **given: Any) -> None:  # noqa: ANN401 - click's  # fmt: skip
    """Tabulate and draw what each step switches on: levels, terminals, field, the motor shield's latch bytes.

    Without MODE the modes there are.

    Examples: trochia excitation half-step -o half.png;
    trochia excitation two-phase --motor SM-42BYG011-25 --supply "9.4 V" --speed "90 rpm" -o currents.svg
    """  # fmt: skip
    from trochia.pulses.excitation_table import steps_of  # noqa: PLC0415 - `trochia --help` must stay light

    _check_files(given)
    if given["bridge"] is not None:
        from trochia.pulses.bridge_picture import picture  # noqa: PLC0415 - it loads matplotlib

        write_whole(Path(given["bridge"]), picture(Path(given["bridge"]).suffix[1:]))
    files = [given[name] for name in ("csv_file", "plot", "bridge") if given[name] is not None]
    if mode is None:
        if given["csv_file"] or given["plot"]:
            raise click.UsageError("A table and a picture are those of a MODE: name one.")
        _modes(files, as_json=as_json)
        return
    steps = steps_of(mode, phases=phases, direction=-1 if back else 1)
    found = _currents(mode, phases, given, back=back)
    if given["csv_file"] is not None:
        write_whole(Path(given["csv_file"]), _csv(steps, image).encode())
    if given["plot"] is not None:
        write_whole(Path(given["plot"]), _picture(mode, steps, found, given, Path(given["plot"]).suffix[1:]))
    if as_json:
        options.print_json({"mode": mode, "phases": phases, "direction": -1 if back else 1,
                            "steps": [_figures(step, image) for step in steps], "files": files,
                            "currents": None if found is None else _current_figures(found)})  # fmt: skip
        return
    _show(mode, steps, image)
    if found is not None:
        peak = float(abs(found.currents).max())
        behind = math.degrees(found.load_angle)
        click.echo(f"  currents up to {peak:.3g} A; the rotor is {behind:.0f}° (electrical) behind the voltages' "
                   f"field, and has at most {found.torque:.3g} N·m at this speed")  # fmt: skip
    for file in files:
        click.echo(f"wrote {file}")


def _check_files(given: dict[str, Any]) -> None:
    """Refuse files that cannot be written, before anything is worked out."""
    for option, name in (("--csv", "csv_file"), ("--plot", "plot"), ("--bridge", "bridge")):
        file = given[name]
        if file is not None and not Path(file).parent.is_dir():
            raise click.BadParameter(f"there is no folder {Path(file).parent}", param_hint=option)
        if file is not None and name != "csv_file" and Path(file).suffix not in {".png", ".svg"}:
            raise click.BadParameter(f"expected a name that ends in .png or .svg, not {file}", param_hint=option)


def _modes(files: list[str], *, as_json: bool) -> None:
    """Print the modes there are."""
    from trochia.pulses.excitation import EXCITATIONS, excitation  # noqa: PLC0415 - `trochia --help` must stay light

    modes = [*EXCITATIONS.values(), excitation("microstep-8"), excitation("microstep-256")]
    if as_json:
        figures = [{"mode": mode.name, "steps_per_full_step": mode.steps_per_full_step, "holds_KI": mode.peak,
                    "fundamental": mode.fundamental} for mode in modes]  # fmt: skip
        options.print_json({"modes": figures, "files": files})
        return
    cells = [["mode", "steps a full step", "holds, in K I", "fundamental"]]
    cells += [
        [mode.name, str(mode.steps_per_full_step), f"{mode.peak:.3f}", f"{mode.fundamental:.3f}"] for mode in modes
    ]
    click.echo(table(cells))
    click.echo("  microstep-2 to microstep-256; microstep-table is the motor shield's, 17 duty values of 8 bits")
    for file in files:
        click.echo(f"wrote {file}")


def _currents(mode: str, phases: int, given: dict[str, Any], *, back: bool) -> PhaseCurrents | None:
    """Return the phase currents asked for, or None."""
    asked = [name for name in ("motor", "supply", "rate") if given[name] is not None]
    if not asked:
        return None
    if len(asked) < 3:
        raise click.UsageError("Phase currents need --motor, --supply and --speed.")
    if phases != 2 or back:
        raise click.UsageError("Phase currents are those of a motor of two phases that runs forwards.")
    from dataclasses import replace  # noqa: PLC0415 - `trochia --help` must stay light

    from trochia.analysis.phase_currents import phase_currents  # noqa: PLC0415
    from trochia.cli.step_units import quantity  # noqa: PLC0415
    from trochia.pulses.excitation import excitation  # noqa: PLC0415

    motor = named(given["motor"]).parameters()
    if given["series"] is not None:
        motor = replace(motor, resistance=motor.resistance + positive(given["series"], "resistance", "--series"))
    omega = motor.speed(speed(given["rate"], motor.full_steps, "--speed"))
    supply = positive(given["supply"], "voltage", "--supply")
    return phase_currents(motor, excitation(mode), supply, omega, quantity(given["load"], "torque", "--load-torque"))


def _picture(mode: str, steps: list[Step], found: PhaseCurrents | None, given: dict[str, Any], form: str) -> bytes:
    """Return the picture's bytes."""
    from trochia.cli.step_units import quantity  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.pulses.excitation_picture import picture  # noqa: PLC0415 - it loads matplotlib

    title = mode if len(steps[0].levels) == 2 else f"{mode}, {len(steps[0].levels)} phases"
    if found is None:
        return picture(steps, title, form=form)
    motor = named(given["motor"]).parameters()
    series = 0.0 if given["series"] is None else quantity(given["series"], "resistance", "--series")
    rest = quantity(given["supply"], "voltage", "--supply") / (motor.resistance + series)
    title = f"{title}: {given['motor']} at {given['rate']} on {given['supply']}, currents in parts of {rest:.3g} A"
    return picture(steps, title, (found.steps, found.currents / rest), form=form)


def _figures(step: Step, image: int) -> dict[str, Any]:
    """Return a step by JSON's keys."""
    two = len(step.levels) == 2
    return {
        "step": step.number, "sector": step.sector if two else None, "levels": step.levels, "terminals": step.terminals,
        "field_deg": math.degrees(step.angle), "holds_KI": step.length, "duty": step.duty,
        "latch": {str(motor): step.latch(motor, image) for motor in (1, 2)} if two else None,
    }  # fmt: skip


def _current_figures(found: PhaseCurrents) -> dict[str, Any]:
    """Return phase currents by JSON's keys."""
    return {"step": found.steps, "current_A": found.currents, "load_angle_deg": math.degrees(found.load_angle),
            "torque_Nm": found.torque}  # fmt: skip


def _cells(steps: list[Step], image: int) -> list[list[str]]:
    """Return the table's cells, its head first."""
    from trochia.pulses.excitation_table import LETTERS  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.pulses.latch import serial_bits  # noqa: PLC0415

    phases = len(steps[0].levels)
    names = list(LETTERS[:phases])
    if phases > 2:
        rows = [["step", *names, "on", "field", "holds"]]
        return rows + [[str(step.number), *(f"{level:g}" for level in step.levels), step.terminals,
                        f"{math.degrees(step.angle):.1f}°", f"{step.length:.3f}"] for step in steps]  # fmt: skip
    duty = any(level not in {-1.0, 0.0, 1.0} for step in steps for level in step.levels)
    head = ["step", "sector", *names, *(f"duty {name}" for name in names if duty), "on", "field", "holds", "motor 1",
            "motor 2", "shifted out, motor 1"]  # fmt: skip
    return [head] + [
        [str(step.number), str(step.sector), *(f"{level:+.4g}" if level else "0" for level in step.levels),
         *(str(value) for value in step.duty if duty), step.terminals, f"{math.degrees(step.angle):.1f}°",
         f"{step.length:.3f}", *(f"{step.latch(motor, image):02X}" for motor in (1, 2)),
         "".join(map(str, serial_bits(step.latch(1, image))))]
        for step in steps
    ]  # fmt: skip


def _csv(steps: list[Step], image: int) -> str:
    """Return the table as CSV."""
    rows = _cells(steps, image)
    return "\n".join(",".join(cell.rstrip("°") for cell in row) for row in rows) + "\n"


def _show(mode: str, steps: list[Step], image: int) -> None:
    """Print the table, and what its columns are."""
    rows = _cells(steps, image)
    on = rows[0].index("on")
    click.secho(f"{mode}, one electrical turn: {len(steps)} steps", bold=True)
    click.echo(table(rows[: _SHOWN + 1], left=(on,)))
    if len(rows) > _SHOWN + 1:
        click.echo(f"  … and {len(rows) - _SHOWN - 1} more, in --csv and --json")
    if len(steps[0].levels) > 2:
        click.echo("  field: of the sum of the phases; holds: in what one phase alone holds")
        return
    click.echo("  field: electrical; holds: in K I of one phase; motor 1, 2: the byte of the shield's shift register, "
               f"{'bit 7 first' if not image else f'the other motor left as in {image:02X}'}")  # fmt: skip
    if mode not in _SHIELD:
        click.echo("  the shield itself has 16 microsteps, microstep-table: such fine levels are a chopper's")
