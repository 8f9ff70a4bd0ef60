"""A motor, its driver and its load from the command line: by their numbers, or from a joint of a machine file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from trochia import units
from trochia.errors import ConfigError, UnitError

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.machine.drivers import Driver, Fed
    from trochia.machine.machine import Machine
    from trochia.machine.motors import CatalogueStepper, ShaftLoad
    from trochia.machine.torque import Drive

_KINDS = ("h-bridge", "l/r", "chopper", "A4988", "DRV8825", "TMC2209", "L293D")  # those of `machine.drivers.DRIVERS`
_OPTIONS = (
    click.option("-m", "--machine", "machine_name", metavar="MACHINE", help="Machine file, with motor and driver."),
    click.option("--joint", metavar="NAME", help="Its joint; without it the first that names motor and driver."),
    click.option("--motor", metavar="NAME", help="A motor of the library (`trochia motors`), or my.toml:NAME of "
                 "your own, in place of a machine."),
    click.option("--driver", type=click.Choice(_KINDS, case_sensitive=False), help="What feeds it, or its chip; "
                 "chopper where a current is given."),
    click.option("--supply", metavar="VOLTAGE", help='Of the driver, "24 V".'),
    click.option("--current", metavar="CURRENT", help='Of a chopper, "2 A".'),
    click.option("--series", metavar="RESISTANCE", help='Of an l/r drive, "10 ohm".'),
    click.option("--excitation", metavar="NAME", help="one-phase, two-phase, half-step, microstep-N; 16 microsteps "
                 "behind a chopper, else two-phase, if not given."),
    click.option("--wiring", type=click.Choice(("unipolar", "series", "parallel")), help="Of half windings."),
    click.option("--inertia", metavar="J", help='Of the load, "50 g·cm²".'),
    click.option("--friction", metavar="TORQUE", help='Of the load, "10 mN·m".'),
    click.option("--load-torque", metavar="TORQUE", help='Constant, as of a weight, "0.1 N·m".'),
)  # fmt: skip


def motor_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options, in their order."""
    for decorate in reversed(_OPTIONS):
        function = decorate(function)
    return function


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """A motor behind its driver, its load, and where they come from.

    Attributes
    ----------
    margin
        Part of the torque that planning leaves unused; 0 without a machine.
    machine, joint, drive
        Where the motor is one of a machine.
    """

    made: Fed
    load: ShaftLoad
    title: str
    margin: float = 0.0
    machine: Machine | None = None
    joint: int = 0
    drive: Drive | None = None


def asked(given: dict[str, Any]) -> Asked:
    """Return what the options say.

    Raises
    ------
    click.BadParameter, click.UsageError
        For options that do not make a motor behind a driver.
    ConfigError
        For numbers that do not fit together.
    """
    if (given["machine_name"] is None) == (given["motor"] is None):
        raise click.UsageError("Give a machine (-m) or a motor (--motor), one of them.")
    return _of_machine(given) if given["motor"] is None else _of_motor(given)


def _of_machine(given: dict[str, Any]) -> Asked:
    """Return the motor of a joint of a machine."""
    from trochia import api  # noqa: PLC0415 - `trochia --help` must stay light

    return joint_motor(api.load(given["machine_name"]), given["joint"])


def joint_motor(machine: Machine, name: str | None) -> Asked:
    """Return the motor of a machine's joint; without a name of the first that names motor and driver.

    Raises
    ------
    click.BadParameter
        When the machine has no such joint.
    ConfigError
        When it does not name motor and driver.
    """
    from trochia.machine.torque import drive  # noqa: PLC0415 - `trochia --help` must stay light

    names = [joint.name for joint in machine.joints]
    if name is not None and name not in names:
        raise click.BadParameter(f"{machine.name} has no joint {name!r}; it has {', '.join(names)}",
                                 param_hint="--joint")  # fmt: skip
    for i, joint in enumerate(machine.joints):
        found = drive(machine, i) if name in {None, joint.name} else None
        if found is not None:
            title = f"{machine.name}, joint {joint.name}"
            return Asked(made=found.made, load=found.load, title=title, margin=found.margin, machine=machine, joint=i,
                         drive=found)  # fmt: skip
    of = f"joint {name}" if name else "no joint"
    raise ConfigError(
        f"{machine.name}: {of} {'does not name' if name else 'names'} a motor and a driver",
        hint='Give the joint motor = { kind = "stepper", library = "…" } and driver = { kind = "chopper", … }.',
    )


def _of_motor(given: dict[str, Any]) -> Asked:
    """Return a motor of the library behind the driver given."""
    from trochia.machine.drivers import fed  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.machine.motors import ShaftLoad  # noqa: PLC0415
    from trochia.machine.motors.excitation import excitation  # noqa: PLC0415
    from trochia.machine.motors.wiring import wired  # noqa: PLC0415

    row = named(given["motor"])
    driver = _driver(given)
    name = given["excitation"] or ("microstep-16" if driver.current is not None else "two-phase")
    made = fed(wired(row.parameters(), given["wiring"]), driver, excitation(name).steps_per_full_step)
    load = ShaftLoad(
        inertia=_number(given, "inertia", "inertia") or 0.0,
        friction=_number(given, "friction", "torque") or 0.0,
        constant=_number(given, "load_torque", "torque") or 0.0,
    )
    return Asked(made=made, load=load, title=f"{given['motor']}, {driver.kind} at {driver.supply:g} V")


def own_motors(file: str) -> dict[str, CatalogueStepper]:
    """Return the motors of a file of one's own, by name.

    Raises
    ------
    ConfigError, UnitError
        For a file that cannot be read, and the first mistake in it.
    """
    from trochia.machine.load import read_text  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.machine.motors import rows_of  # noqa: PLC0415

    return rows_of(read_text(Path(file)), file)


def named(name: str) -> CatalogueStepper:
    """Return a motor by its name in the library, or by ``my.toml:NAME`` in a file of one's own.

    Raises
    ------
    ConfigError, UnitError
        When there is none of that name, or the file has a mistake.
    """
    from trochia.machine.motors import motor  # noqa: PLC0415 - `trochia --help` must stay light

    file, toml, own = name.rpartition(".toml")
    if not toml or (own and not own.startswith(":")):
        return motor(name)
    rows = own_motors(file + toml)
    wanted = own[1:] or (next(iter(rows)) if len(rows) == 1 else "")
    if wanted not in rows:
        said = f"has no motor {wanted!r}" if wanted else "has several motors"
        hint = units.did_you_mean(wanted, rows) or f"Name one of {', '.join(rows)}: {file}{toml}:NAME"
        raise ConfigError(f"{file}{toml} {said}", hint=hint)
    return rows[wanted]


def _driver(given: dict[str, Any]) -> Driver:
    """Return the driver that the options name."""
    from trochia.machine.drivers import DRIVERS, Chopper, SeriesResistor  # noqa: PLC0415 - as above

    supply, current = _number(given, "supply", "voltage"), _number(given, "current", "current")
    series = _number(given, "series", "resistance")
    kind = given["driver"] or ("chopper" if current else "l/r" if series else "h-bridge")
    if supply is None:
        raise click.UsageError('A driver needs a supply, like --supply "24 V".')
    cls = DRIVERS[kind]
    mode = given["excitation"] or ("microstep-16" if issubclass(cls, Chopper) else "two-phase")
    if issubclass(cls, Chopper):
        if current is None:
            raise click.UsageError(f'{kind} needs its current, like --current "1 A".')
        return cls(supply=supply, current=current, excitation=mode)
    if issubclass(cls, SeriesResistor):
        if series is None:
            raise click.UsageError('An l/r drive needs its resistor, like --series "10 ohm".')
        return cls(supply=supply, series=series, excitation=mode)
    return cls(supply=supply, excitation=mode)


def _number(given: dict[str, Any], name: str, dimension: str) -> float | None:
    """Return an option's quantity in its base unit, or None where it is not given."""
    if given[name] is None:
        return None
    try:
        return units.parse(given[name], dimension)
    except UnitError as error:
        raise click.BadParameter(error.message, param_hint="--" + name.replace("_", "-")) from error
