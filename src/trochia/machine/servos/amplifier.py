"""What a machine file says of a servo's amplifier and of the train behind its motor.

In: numbers with their units.  Out: the Amplifier of the equations.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from trochia.errors import ConfigError
from trochia.machine.codecs import Quantity, Text, Whole
from trochia.machine.schema import Bound, check_bounds, key
from trochia.machine.servo_plant import Amplifier, Mode

MODES = ("voltage", "current", "speed")
_CORNER = 4.0  # of the speed loop's integral, below its bandwidth: two equal poles at half of it


@dataclass(frozen=True, slots=True, kw_only=True)
class ServoAmplifier:
    """An amplifier by what it gives at its greatest command.

    Attributes
    ----------
    drop
        Of the bridge; the dead time of its PWM adds ``dead_time · pwm · voltage`` to it, as it works against the
        current too.
    """

    mode: str = field(default="current", metadata=key(Text(MODES), "what its command sets"))
    command: float = field(
        default=10.0, metadata=key(Quantity("voltage"), "greatest command, either way", Bound.POSITIVE)
    )
    current: float | None = field(
        default=None, metadata=key(Quantity("current"), "its limit; in mode current that of the greatest command",
                                   Bound.POSITIVE)
    )  # fmt: skip
    voltage: float | None = field(
        default=None, metadata=key(Quantity("voltage"), "its supply; in mode voltage that of the greatest command",
                                   Bound.POSITIVE)
    )  # fmt: skip
    speed: float | None = field(
        default=None, metadata=key(Quantity("rotation speed"), "of its greatest command (mode speed)", Bound.POSITIVE)
    )
    bandwidth: float = field(
        default=100.0, metadata=key(Quantity("frequency"), "of its own speed loop (mode speed)", Bound.POSITIVE)
    )
    drop: float = field(default=0.0, metadata=key(Quantity("voltage"), "lost in the bridge", Bound.NOT_NEGATIVE))
    levels: int | None = field(
        default=None, metadata=key(Whole(), "steps of its PWM over the voltage (10 bits: 1023)", Bound.POSITIVE)
    )
    pwm: float | None = field(default=None, metadata=key(Quantity("frequency"), "of the PWM", Bound.POSITIVE))
    dead_time: float = field(
        default=0.0, metadata=key(Quantity("time"), "in which neither switch of a leg is on", Bound.NOT_NEGATIVE)
    )
    lag: float = field(
        default=0.0, metadata=key(Quantity("time"), "of its current loop (modes current and speed)", Bound.NOT_NEGATIVE)
    )
    offset: float = field(default=0.0, metadata=key(Quantity("voltage"), "that it adds to its command"))

    def __post_init__(self) -> None:
        check_bounds(self)
        for mode in MODES:
            if self.mode == mode and getattr(self, mode) is None:
                raise ConfigError(f"missing; in mode {mode} it is what the greatest command gives", key=mode)
        if self.dead_time and self.pwm is None:
            raise ConfigError("needs pwm, how often it happens", key="dead_time")
        if self.whole_drop >= (self.voltage or math.inf):
            raise ConfigError(f"drop and dead time take {self.whole_drop:.3g} V of the {self.voltage:g} V there are",
                              key="drop")  # fmt: skip

    @property
    def whole_drop(self) -> float:
        """Drop and dead time, against the current [V]."""
        return self.drop + self.dead_time * (self.pwm or 0.0) * (self.voltage or 0.0)

    @property
    def gain(self) -> float:
        """Volts, amperes or rad/s a volt of command."""
        full = {"current": self.current, "voltage": self.voltage,
                "speed": None if self.speed is None else self.speed * math.tau / 60.0}[self.mode]  # fmt: skip
        assert full is not None, "held to at construction"
        return full / self.command

    def physical(self, most_current: float, *, inertia: float, torque_constant: float) -> Amplifier:
        """Return what the equations need, for a motor that may carry a current [A].

        Parameters
        ----------
        inertia, torque_constant
            Of all that its own speed loop moves [kg·m²], and of the motor [N·m/A].
        """
        own = math.tau * self.bandwidth * inertia / torque_constant if self.mode == "speed" else 0.0
        return Amplifier(
            mode=Mode[self.mode.upper()],
            gain=self.gain,
            voltage=self.voltage if self.voltage is not None else math.inf,
            current=min(self.current or math.inf, most_current),
            drop=self.whole_drop if self.mode == "voltage" else 0.0,
            levels=self.levels,
            lag=self.lag,
            offset=self.offset if self.mode == "speed" else 0.0,
            speed_gain=own,
            speed_integral=own * math.tau * self.bandwidth / _CORNER,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveTrain:
    """What is between motor and load; without stiffness they are one body, and backlash is play behind both."""

    stiffness: float | None = field(
        default=None, metadata=key(Quantity("stiffness"), "at the motor's shaft; without it the train is rigid",
                                   Bound.POSITIVE)
    )  # fmt: skip
    damping: float = field(
        default=0.0, metadata=key(Quantity("viscous friction"), "of the twist, at the motor's shaft",
                                  Bound.NOT_NEGATIVE)
    )  # fmt: skip
    viscous: float = field(
        default=0.0, metadata=key(Quantity("viscous friction"), "of the load, at the motor's shaft", Bound.NOT_NEGATIVE)
    )
    stick: float | None = field(
        default=None, metadata=key(Quantity("torque"), "dry friction at the onset of motion, at the motor's shaft",
                                   Bound.POSITIVE)
    )  # fmt: skip
    stribeck: float | None = field(
        default=None, metadata=key(Quantity("rotation speed"), "over which it falls to load.friction", Bound.POSITIVE)
    )

    def __post_init__(self) -> None:
        check_bounds(self)
        if (self.stick is None) != (self.stribeck is None):
            raise ConfigError("stick and stribeck are given together", key="stick")
