"""Motor constants from a row of a catalogue, and whether the row agrees with itself.

In: TOML, numbers with their units.  Out: the constants of the equations, and what they give for no-load speed, stall
torque and time constant beside what the row says of them.
"""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass, field
from decimal import Decimal

from trochia.analysis.identification.estimate import Estimate, Number
from trochia.errors import ConfigError, Source
from trochia.machine.codecs import Number as Plain
from trochia.machine.codecs import Quantity, Text
from trochia.machine.motors.dc import DcMotor
from trochia.machine.schema import Bound, check_bounds, key
from trochia.machine.table import Book, Table, build

_DIGITS = 0.005  # of a number with three digits: half a unit of the last, of 100


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorRow:
    """What a catalogue says of a brushed motor."""

    voltage: float = field(metadata=key(Quantity("voltage"), "nominal", Bound.POSITIVE))
    resistance: float = field(metadata=key(Quantity("resistance"), "between its terminals", Bound.POSITIVE))
    inductance: float = field(default=0.0, metadata=key(Quantity("inductance"), "of the armature", Bound.NOT_NEGATIVE))
    torque_constant: float = field(metadata=key(Quantity("torque constant"), "Kt", Bound.POSITIVE))
    inertia: float = field(metadata=key(Quantity("inertia"), "of the rotor", Bound.POSITIVE))
    no_load_current: float = field(metadata=key(Quantity("current"), "at its voltage", Bound.POSITIVE))
    no_load_speed: float | None = field(
        default=None, metadata=key(Quantity("rotation speed"), "at its voltage", Bound.POSITIVE)
    )
    stall_torque: float | None = field(default=None, metadata=key(Quantity("torque"), "at rest", Bound.POSITIVE))
    time_constant: float | None = field(default=None, metadata=key(Quantity("time"), "mechanical", Bound.POSITIVE))
    precision: float = field(
        default=_DIGITS, metadata=key(Plain(), "of its numbers, a part of them: what rounding leaves", Bound.POSITIVE)
    )
    source: str | None = field(default=None, metadata=key(Text(), "where it was read"))

    def __post_init__(self) -> None:
        check_bounds(self)

    def motor(self) -> DcMotor:
        """Return the motor of the equations."""
        return DcMotor.from_catalogue(
            voltage=self.voltage, resistance=self.resistance, inductance=self.inductance,
            torque_constant=self.torque_constant, inertia=self.inertia, no_load_current=self.no_load_current,
        )  # fmt: skip

    def estimate(self) -> Estimate:
        """Return the constants; uncertainties are those of rounded numbers, carried through."""
        motor, p = self.motor(), self.precision / math.sqrt(3.0)  # an even spread
        electric, mechanical = motor.time_constants
        speed, stall = motor.no_load_speed(self.voltage) * 60.0 / math.tau, motor.stall_torque(self.voltage)
        numbers = {
            "torque_constant": Number(self.torque_constant, p * self.torque_constant, "N·m/A"),
            "emf_constant": Number(motor.emf_constant, p * motor.emf_constant, "V·s/rad"),
            "viscous": Number(motor.viscous, motor.viscous * math.sqrt(4.0) * p, "N·m·s/rad"),
            "electrical_time": Number(electric, electric * math.sqrt(2.0) * p, "s"),
            "mechanical_time": Number(mechanical, mechanical * math.sqrt(6.0) * p, "s"),
            "no_load_speed": Number(speed, speed * math.sqrt(2.0) * p, "rpm"),
            "stall_torque": Number(stall, stall * math.sqrt(3.0) * p, "N·m"),
        }  # fmt: skip
        off = [value for value in self.deviations().values() if value is not None]
        worst = max((abs(value) for value in off), default=0.0)
        return Estimate(model="catalogue", numbers=numbers, rms=worst, fit=1.0 - worst, samples=6 + len(off))

    def deviations(self) -> dict[str, float | None]:
        """Return by which part of itself each number that the row also gives is another; None where it gives none."""
        motor = self.motor()
        found = {
            "no_load_speed": (motor.no_load_speed(self.voltage) * 60.0 / math.tau, self.no_load_speed),
            "stall_torque": (motor.stall_torque(self.voltage), self.stall_torque),
            "time_constant": (motor.time_constants[1], self.time_constant),
        }
        return {name: None if said is None else value / said - 1.0 for name, (value, said) in found.items()}


def read_row(text: str, file: str) -> MotorRow:
    """Return the row of a text.

    Raises
    ------
    ConfigError, UnitError
        For the first mistake in it.
    """
    try:
        document = tomllib.loads(text, parse_float=Decimal)
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(f"not TOML: {error}", source=Source(file, 1)) from None
    book = Book(file, text)
    table, row = Table(document, book), None
    with book.catch():
        row = build(table, MotorRow)
    table.refuse_rest()
    if book.problems:
        raise book.problems[0]
    assert row is not None, "without a problem there is a row"
    return row
