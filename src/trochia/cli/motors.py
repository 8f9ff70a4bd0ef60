"""``trochia motors``: the library of real steppers, and what follows from a motor's numbers."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import click

from trochia.cli import options
from trochia.cli.motor_options import named, own_motors
from trochia.cli.step_units import positive
from trochia.cli.tables import table

if TYPE_CHECKING:
    from trochia.machine.motors import CatalogueStepper, HybridStepper

#: key, words, factor from the base unit, unit as catalogues print it
_PRINTED = (
    ("holding_torque", "holding torque", 1.0, "N·m"), ("current", "current, rated", 1.0, "A"),
    ("voltage", "voltage, rated", 1.0, "V"), ("resistance", "resistance", 1.0, "ohm"),
    ("inductance", "inductance", 1e-3, "mH"), ("inertia", "rotor inertia", 1e-7, "g·cm²"),
    ("detent_torque", "detent torque", 1e-3, "mN·m"), ("friction", "friction", 1e-3, "mN·m"),
)  # fmt: skip
_SUPPLIES = (12.0, 24.0, 36.0, 48.0)  # [V], where none is given


@click.command()
@click.argument("names", metavar="[NAME]...", nargs=-1)
@click.option("--find", metavar="TEXT", help="List those with this in name, frame, kind, source or note.")
@click.option("--torque", metavar="TORQUE", help='List those that hold at least this, "0.4 N·m" or "4 kgf·cm".')
@click.option(
    "--supply", "supplies", multiple=True, metavar="VOLTAGE", help='Speeds on this supply, "24 V"; again for more.'
)
@click.option("--wiring", type=click.Choice(("unipolar", "series", "parallel")), help="Of rows for half windings.")
@click.option(
    "--file",
    type=click.Path(exists=True, dir_okay=False),
    metavar="FILE.toml",
    help="Your own motors, in place of the library.",
)
@options.as_json
def command(*, names: tuple[str, ...], as_json: bool, **given: Any) -> None:  # noqa: ANN401 - click's
    """List the library of real steppers; with NAME (or my.toml:NAME) show one, and what follows from its numbers.

    Exit code 1 where nothing is found.

    Examples: trochia motors --find "NEMA 17" --supply "24 V"; trochia motors QSH4218-51-10-049
    """  # fmt: skip
    rows = _chosen(names, given)
    supplies = [positive(text, "voltage", "--supply") for text in given["supplies"]]
    if as_json:
        shown = supplies or list(_SUPPLIES)
        options.print_json({"motors": {name: _figures(row, given["wiring"], shown) for name, row in rows.items()}})
    elif names:
        for i, (name, row) in enumerate(rows.items()):
            click.echo("" if i else None, nl=bool(i))
            _show(name, row, given["wiring"], supplies or list(_SUPPLIES))
    elif rows:
        _list(rows, given["wiring"], supplies)
    if not rows:
        click.echo("No motor is like that.", err=True)
        raise SystemExit(1)


def _chosen(names: tuple[str, ...], given: dict[str, Any]) -> dict[str, CatalogueStepper]:
    """Return the rows asked for: by name, or all that fit, the weakest first."""
    from trochia.machine.motors import library  # noqa: PLC0415 - `trochia --help` must stay light

    file, find, torque = given["file"], given["find"], given["torque"]
    if names:
        if find or torque:
            raise click.UsageError("--find and --torque search the list: leave them or the names out.")
        return {name: named(f"{file}:{name}" if file else name) for name in names}
    rows = library() if file is None else own_motors(file)
    least = 0.0 if torque is None else positive(torque, "torque", "--torque")
    found = {
        name: row for name, row in rows.items()
        if row.holding_torque >= least and (find is None or _squeezed(find) in _squeezed(_words(name, row)))
    }  # fmt: skip
    return dict(sorted(found.items(), key=lambda item: item[1].holding_torque))


def _words(name: str, row: CatalogueStepper) -> str:
    """Return all a search looks at."""
    return " ".join(filter(None, (name, row.frame, row.kind, row.source, row.note)))


def _squeezed(text: str) -> str:
    """Return a text as a search compares it: "NEMA17", "nema 17" and "Nema-17" are the same."""
    return "".join(c for c in text.casefold() if c.isalnum())


def _wired(row: CatalogueStepper, wiring: str | None) -> HybridStepper:
    """Return the motor as wired."""
    from trochia.machine.motors.wiring import wired  # noqa: PLC0415 - `trochia --help` must stay light

    return wired(row.parameters(), wiring)


def _list(rows: dict[str, CatalogueStepper], wiring: str | None, supplies: list[float]) -> None:
    """Print a line a motor."""
    from trochia.machine.motors.facts import RPM, reach  # noqa: PLC0415 - as above

    cells = [["motor", "frame", "steps", "holds N·m", "A", "ohm", "mH", "L/R ms", "g·cm²", "K N·m/A", "numbers",
              *(f"full at {v:g} V" for v in supplies)]]  # fmt: skip
    for name, row in rows.items():
        motor = _wired(row, wiring)
        corners = [reach(motor, v).corner for v in supplies]
        cells.append([
            name, row.frame or "", str(row.full_steps), _round(row.holding_torque if wiring is None else
                                                               math.sqrt(2) * motor.torque_constant * motor.current),
            _round(motor.current), _round(motor.resistance), _round(motor.inductance * 1e3),
            _round(motor.time_constant * 1e3), _round(motor.inertia * 1e7), _round(motor.torque_constant),
            _origin(row), *("-" if corner is None else f"{corner * RPM:.0f} rpm" for corner in corners),
        ])  # fmt: skip
    click.echo(table(cells, left=(0, 1, 10)))
    click.echo(f"\n{len(rows)} motors.  One in full: trochia motors {next(iter(rows))}")


def _round(value: float) -> str:
    """Return three digits, without a power of ten."""
    return f"{value:.3g}" if value < 1000.0 else f"{value:.0f}"


def _origin(row: CatalogueStepper) -> str:
    """Return how far the numbers go back to a source."""
    return ("checked" if row.checked else "not checked") + (f", {row.assumed} assumed" if row.assumed else "")


def _show(name: str, row: CatalogueStepper, wiring: str | None, supplies: list[float]) -> None:
    """Print a motor's numbers, and what follows from them."""
    from trochia.machine.motors.facts import derived  # noqa: PLC0415 - as above

    degrees = 360 / row.full_steps
    head = [row.frame, row.kind, f"{row.full_steps} full steps a turn ({degrees:g}°)", wiring and f"wired {wiring}"]
    click.secho(f"{name}: {', '.join(part for part in head if part)}", bold=True)
    printed = [
        [words, f"{getattr(row, key) / factor:.6g} {unit}", "assumed" if key in row.assumed_keys else ""]
        for key, words, factor, unit in _PRINTED
        if getattr(row, key)
    ]
    click.echo(table(printed, left=(0, 2)))
    _show_constant(row)
    _show_derived(derived(_wired(row, wiring)), _wired(row, wiring), supplies)
    click.echo(f"  source: {row.source or 'not told'}")
    click.echo("  " + (f"read again on {row.read}, number by number" if row.checked else "not read again by anyone"))
    if row.note:
        click.echo(f"  note: {row.note}")


def _show_constant(row: CatalogueStepper) -> None:
    """Print how the torque constant follows, with the rule of √2."""
    both = row.phases_on == 2
    over = f"({'√2 · ' if both else ''}{row.current:g} A)"
    click.echo(f"  K = {row.holding_torque:.4g} N·m/{over} = {row.torque_constant:.4g} N·m/A, as the holding torque is "
               f"that of {'both phases' if both else 'one phase'} on")  # fmt: skip
    if both:
        click.echo("  (both: their torque curves, a quarter of a tooth pitch apart, add up to √2 of one; had the sheet "
                   f"meant one, K were {math.sqrt(2) * row.torque_constant:.4g})")  # fmt: skip


def _show_derived(facts: dict[str, float], motor: HybridStepper, supplies: list[float]) -> None:
    """Print derived numbers and the speeds on each supply."""
    from trochia.machine.motors.facts import RPM, reach  # noqa: PLC0415 - as above

    click.echo(table([
        ["holds", f"{facts['one_phase_Nm']:.3g} N·m", "one phase on, or microsteps"],
        ["", f"{facts['two_phase_Nm']:.3g} N·m", "both phases on"],
        ["back-EMF", f"{facts['back_emf_V_krpm']:.3g} V", "at 1000 rpm, amplitude of a phase"],
        ["current lags", f"{facts['time_constant_ms']:.3g} ms", "L/R"],
        ["R I", f"{facts['rated_voltage_V']:.3g} V", f"{facts['copper_heat_W']:.3g} W of heat with both phases on"],
        ["rotor alone", f"{facts['acceleration_rad_s2']:,.0f} rad/s²", f"swings at {facts['resonance_Hz']:.0f} Hz"],
    ], left=(0, 2)))  # fmt: skip
    cells = [["supply", "full current up to", "half the torque at"]]
    for supply in supplies:
        found = reach(motor, supply)
        speeds = ["-" if speed is None else f"{speed * RPM:.0f} rpm" for speed in (found.corner, found.half)]
        cells.append([f"{supply:g} V", *speeds])
    click.echo(table(cells, left=(0,)))


def _figures(row: CatalogueStepper, wiring: str | None, supplies: list[float]) -> dict[str, Any]:
    """Return a motor by JSON's keys."""
    from trochia.machine.motors.facts import RPM, derived, reach  # noqa: PLC0415 - as above

    motor = _wired(row, wiring)
    return {
        "frame": row.frame, "kind": row.kind, "full_steps": row.full_steps, "phases_on": row.phases_on,
        "resistance_ohm": row.resistance, "inductance_H": row.inductance, "current_A": row.current,
        "holding_torque_Nm": row.holding_torque, "inertia_kgm2": row.inertia, "detent_torque_Nm": row.detent_torque,
        "friction_Nm": row.friction, "voltage_V": row.voltage, "source": row.source, "checked": row.checked,
        "read": row.read, "assumed": list(row.assumed_keys), "note": row.note, "wiring": wiring,
        "derived": derived(motor),
        "supplies": [
            {"supply_V": found.supply, "corner_rpm": found.corner and found.corner * RPM,
             "half_torque_rpm": found.half and found.half * RPM}
            for found in (reach(motor, supply) for supply in supplies)
        ],
    }  # fmt: skip
