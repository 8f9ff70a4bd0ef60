"""A motor, its driver and its load from the command line: by their numbers, or from a joint of a machine file."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
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

MARGIN = 0.3  #: part of the torque to be left unused, unless said: that of a machine's load
GRAVITY = 9.80665  #: [m/s²]
_LOADS = ("driver", "supply", "current", "series", "excitation", "wiring", "inertia", "friction", "load_torque",
          "travel_per_turn", "mass", "force", "vertical", "efficiency", "margin")  # fmt: skip
KINDS = ("h-bridge", "l/r", "chopper", "A4988", "DRV8825", "TMC2209", "L293D")  # those of `machine.drivers.DRIVERS`
_OPTIONS = (
    click.option("-m", "--machine", "machine_name", metavar="MACHINE", help="Machine file, with motor and driver."),
    click.option("--joint", metavar="NAME", help="Its joint; without it the first that names motor and driver."),
    click.option("--motor", metavar="MOTOR", help="In place of a machine: a motor of the library (`trochia motors`), "
                 "my.toml:NAME of your own, or its numbers, "
                 '"1.7 A, 1.65 ohm, 3.2 mH, 44 N·cm, 68 g·cm²" (1.8 degrees a step, if no angle is given).'),
    click.option("--driver", type=click.Choice(KINDS, case_sensitive=False), help="What feeds it, or its chip; "
                 "chopper where a current is given."),
    click.option("--supply", metavar="VOLTAGE", help='Of the driver, "24 V".'),
    click.option("--current", metavar="CURRENT", help='Of a chopper, "2 A".'),
    click.option("--series", metavar="RESISTANCE", help='Of an l/r drive, "10 ohm".'),
    click.option("--excitation", metavar="NAME", help="one-phase, two-phase, half-step, microstep-N; 16 microsteps "
                 "behind a chopper, else two-phase, if not given."),
    click.option("--wiring", type=click.Choice(("unipolar", "series", "parallel")), help="Of half windings."),
    click.option("--inertia", metavar="J", help='Of the load, on the shaft, "50 g·cm²".'),
    click.option("--friction", metavar="TORQUE", help='Of the load, "10 mN·m"; or "5 N" with a travel per turn.'),
    click.option("--load-torque", metavar="TORQUE", help='Constant, as of a weight, "0.1 N·m".'),
    click.option("--travel-per-turn", metavar="LENGTH", help='Of a screw, "5 mm"; of a belt, pitch times teeth, '
                 '"40 mm".'),
    click.option("--mass", metavar="MASS", help='Moved along the axis, "2 kg" (with a travel per turn).'),
    click.option("--force", metavar="FORCE", help='Constant, against forward motion, "20 N" (with a travel per turn).'),
    click.option("--vertical", is_flag=True, help="The mass hangs on the axis: its weight is a force besides."),
    click.option("--efficiency", metavar="PERCENT", help='Of screw or belt, "90 %" (with a travel per turn).'),
    click.option("--margin", metavar="PERCENT", help="Torque to be left unused; 30 % if not given."),
)  # fmt: skip


def motor_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options, in their order."""
    for decorate in reversed(_OPTIONS):
        function = decorate(function)
    return function


def load_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options but those of a machine, which a command has of its own."""
    for decorate in reversed(_OPTIONS[2:]):
        function = decorate(function)
    return function


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """A motor behind its driver, its load, and where they come from.

    Attributes
    ----------
    margin
        Part of the torque that is to be left unused.
    travel
        Of a turn of the shaft [mm or degree], where one is known.
    rotary
        Whether travel is in degrees.
    row
        The motor's in its catalogue; None for one of a machine.
    machine, joint, drive
        Where the motor is one of a machine.
    """

    made: Fed
    load: ShaftLoad
    title: str
    margin: float = MARGIN
    travel: float | None = None
    rotary: bool = False
    row: CatalogueStepper | None = None
    machine: Machine | None = None
    joint: int = 0
    drive: Drive | None = None

    @property
    def pulses_per_turn(self) -> int:
        """Step pulses of a turn, microsteps counted."""
        return self.made.motor.full_steps * self.made.excitation.steps_per_full_step

    @property
    def shaft(self) -> Drive:
        """The drive in radians of the shaft."""
        from trochia.machine.torque import Drive  # noqa: PLC0415 - `trochia --help` must stay light

        return Drive(made=self.made, load=self.load, per_radian=1.0, margin=self.margin)


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
    if given["motor"] is not None:
        return of_motor(given)
    for name in _LOADS:
        if given[name]:
            raise click.UsageError(f"--{name.replace('_', '-')} goes with --motor; the machine's file says it of a "
                                   "joint.")  # fmt: skip
    return _of_machine(given)


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
            row = machine.kinematics.matrix[i]
            rotary = any(axis.rotary for axis, c in zip(machine.axes, row, strict=True) if c)
            return Asked(made=found.made, load=found.load, title=title, margin=found.margin, machine=machine, joint=i,
                         drive=found, travel=abs(found.per_radian) * math.tau, rotary=rotary)  # fmt: skip
    of = f"joint {name}" if name else "no joint"
    raise ConfigError(
        f"{machine.name}: {of} {'does not name' if name else 'names'} a motor and a driver",
        hint='Give the joint motor = { kind = "stepper", library = "…" } and driver = { kind = "chopper", … }.',
    )


def of_motor(given: dict[str, Any]) -> Asked:
    """Return a motor by itself behind the driver given."""
    from trochia.cli.motor_text import motor_row  # noqa: PLC0415 - `trochia --help` must stay light

    name, row = motor_row(given["motor"])
    return of_row(name, row, given)


def of_row(name: str, row: CatalogueStepper, given: dict[str, Any]) -> Asked:
    """Return a motor by its row behind the driver given, with the load given."""
    from trochia.cli.step_units import fraction  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.machine.drivers import fed  # noqa: PLC0415
    from trochia.machine.motors.excitation import excitation  # noqa: PLC0415
    from trochia.machine.motors.wiring import wired  # noqa: PLC0415

    driver = _driver(given)
    mode = given["excitation"] or ("microstep-16" if driver.current is not None else "two-phase")
    made = fed(wired(row.parameters(), given["wiring"]), driver, excitation(mode).steps_per_full_step)
    travel = _number(given, "travel_per_turn", "length")
    if travel is not None and not 0.0 < travel < math.inf:
        raise click.BadParameter(f"must be more than 0, not {given['travel_per_turn']!r}",
                                 param_hint="--travel-per-turn")  # fmt: skip
    margin = MARGIN if given["margin"] is None else fraction(given["margin"], "--margin", least=0.0)
    if margin >= 1.0:
        raise click.BadParameter("100 % leaves no torque to use; 30 % is usual", param_hint="--margin")
    return Asked(made=made, load=_load(given, travel), title=f"{name}, {driver.kind} at {driver.supply:g} V",
                 margin=margin, travel=travel, row=row)  # fmt: skip


def _load(given: dict[str, Any], travel: float | None) -> ShaftLoad:
    """Return the load as the shaft has it, part of it moved along an axis."""
    from trochia.cli.step_units import fraction  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.machine.loads import JointLoad  # noqa: PLC0415
    from trochia.machine.motors import ShaftLoad  # noqa: PLC0415

    along = given["friction"] is not None and given["friction"].rstrip().endswith("N")
    for name in ("mass", "force", "vertical", "efficiency"):
        if given[name] and travel is None:
            raise click.UsageError(f"--{name} is of what moves along an axis: give --travel-per-turn too.")
    if along and travel is None:
        raise click.UsageError("A friction in newtons is along an axis: give --travel-per-turn too, or a torque.")
    if given["vertical"] and given["mass"] is None:
        raise click.UsageError("--vertical needs the --mass that hangs there.")
    mass = _number(given, "mass", "mass") or 0.0
    moved = JointLoad(
        mass=mass,
        inertia=_number(given, "inertia", "inertia") or 0.0,
        friction=(_number(given, "friction", "force") or 0.0) if along else 0.0,
        force=(_number(given, "force", "force") or 0.0) + (mass * GRAVITY if given["vertical"] else 0.0),
        efficiency=1.0 if given["efficiency"] is None else fraction(given["efficiency"], "--efficiency"),
    ).at_shaft(Fraction(travel or 0.0), rotary=False)
    return ShaftLoad(
        inertia=moved.inertia,
        friction=moved.friction + (0.0 if along else _number(given, "friction", "torque") or 0.0),
        constant=moved.constant + (_number(given, "load_torque", "torque") or 0.0),
    )


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
