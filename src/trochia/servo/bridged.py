"""The electronic leadscrew's motor behind its bridge: pins, the brake after each motion, moves without a loop.

In: levels of the bridge's pins and a duty, tick by tick; lengths in pulses.  Out: what the pulse counter says, and the
slip: how far the screw has gone beyond what was asked for.

A move runs at full duty, slows down for its last two turns, and ends with the brake: both inputs alike and the enable
on for half a second, then off.  Braking is not immediate, so every motion ends with a slip; the next one takes it over.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from trochia.errors import ConfigError, LimitError
from trochia.kernels.servo import ServoKernel
from trochia.machine.edges import Edges
from trochia.machine.servo_plant import Mode, Power
from trochia.machine.servos.bridge import Driven, driven
from trochia.servo.axis import STEP, plant_members

if TYPE_CHECKING:
    from trochia.machine.servo_plant import ServoPlant

TICK = 128e-6  #: of the PWM: how often the counter is looked at [s]
BRAKE = 0.5  #: that the brake is held [s]
SLOW_WAY = 1560  #: pulses of the end of a move, two turns of the screw, that are run slowly
SLOW = 600 / 1023  #: duty there


class Moved(NamedTuple):
    """Pulses that came, and those beyond what was asked for."""

    pulses: int
    slip: int


class BridgedMotor:
    """A motor at rest behind a bridge, its counter at zero.

    Parameters
    ----------
    plant
        Its amplifier one of voltage, with an encoder.
    single
        Whether the encoder has one channel, as it was built: then the counter knows no direction.
    """

    def __init__(self, plant: ServoPlant, *, single: bool = True) -> None:
        if plant.amplifier.mode is not Mode.VOLTAGE or not plant.counts:
            raise ConfigError("a bridge drives a motor with an encoder by voltage", key="mode")
        self._plant = replace(plant, edges=Edges(single=single))
        self._steps = round(TICK / STEP)
        self._kernel = ServoKernel(self._members(Power.FREE))
        self._state, self._speed = Driven(Power.FREE, 0), 0.0
        self._start = 0
        self.pins(enable=False, a=False, b=False)

    @property
    def pulses(self) -> int:
        """What the counter says: pulses since the last motion began, whatever their direction."""
        return abs(self._kernel.encoder.told - self._start)

    @property
    def speed(self) -> float:
        """Of the shaft [rad/s]."""
        return self._speed

    @property
    def power(self) -> Power:
        """What the bridge does with the winding."""
        return self._state.power

    def pins(self, *, enable: bool, a: bool, b: bool) -> None:
        """Set the bridge's pins."""
        self._state = driven(enable=enable, a=a, b=b)
        self._kernel.set_plant(self._members(self._state.power))

    def run(self, duty: float, ticks: int = 1) -> None:
        """Go on for some ticks at a duty, 0 to 1."""
        supply = self._plant.amplifier.voltage / self._plant.amplifier.gain
        rows = self._kernel.drive(np.full(ticks + 1, self._state.way * duty * supply), steps=self._steps)
        self._speed = float(rows.speed[-1])

    def brake(self) -> int:
        """Short the winding for half a second, then let it go; return the pulses that came."""
        before = self.pulses
        level = self._state.way < 0  # so that both pairs of transistors take their turn
        self.pins(enable=True, a=level, b=level)
        self.run(0.0, round(BRAKE / TICK))
        self.pins(enable=False, a=level, b=level)
        return self.pulses - before

    def move(self, pulses: int, *, way: int = 1, most_time: float = 60.0) -> Moved:
        """Move by so many pulses, slower at the end, and brake.

        Raises
        ------
        LimitError
            When it has not come there in time; the bridge is off then.
        """
        if pulses < 1:
            raise ConfigError(f"must be at least 1, not {pulses}", key="pulses")
        self._start = self._kernel.encoder.told
        self.pins(enable=True, a=way > 0, b=way < 0)
        for _ in range(round(most_time / TICK)):
            left = pulses - self.pulses
            if left <= 0:
                self.brake()
                return Moved(self.pulses, self.pulses - pulses)
            self.run(1.0 if left > SLOW_WAY and pulses >= SLOW_WAY else SLOW)
        self.pins(enable=False, a=False, b=False)
        raise LimitError(f"{self.pulses} of {pulses} pulses came in {most_time:g} s; the motor is off",
                         hint="Is it stalled, or its encoder not connected?")  # fmt: skip

    def _members(self, power: Power) -> dict[str, object]:
        return plant_members(self._plant, TICK / self._steps, power)
