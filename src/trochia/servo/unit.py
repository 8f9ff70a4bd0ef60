"""An AC servo amplifier as a unit: front panel, inputs and outputs, current protection, and the motor behind it.

In: keys, the control supply, RUN, a command; time.  Out: display, ready and alarm outputs, the motor's motion.

    energised = (panel in JOG, or RUN) and ready       jog speed by a ramp, from the keys; else the speed of the command
    supply lost: stopped by the winding's short, then free     a fault: free at once, not ready until it is reset
    overload: current at its limit for longer than it may, whatever else failed to stop the axis
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import ConfigError
from trochia.kernels.servo import ServoKernel
from trochia.machine.friction import Friction
from trochia.machine.servo_plant import Mode, Power
from trochia.machine.servos.panel import FrontPanel, Key
from trochia.servo.axis import STEP, plant_members

if TYPE_CHECKING:
    from trochia.machine.servo_plant import ServoPlant

TICK = 1e-3  #: how often inputs are looked at [s]
OVERLOAD = "oL"  #: what it shows for too much current for too long
STOP = 0.5  #: of the longest stop behind a lost supply [s]
_AT_LIMIT = 0.98  # of the current's limit
_STILL = 0.5  # speed that is none [rad/s]


class AmplifierUnit:
    """One amplifier with its motor at rest, its supply off.

    Parameters
    ----------
    plant
        Its amplifier one of speed.
    jog
        Speed of the front panel's jog [rad/s].
    ramp
        Time from rest to that [s].
    overload
        Time at the current's limit that it stands [s].
    """

    def __init__(self, plant: ServoPlant, *, jog: float, ramp: float = 0.3, overload: float = 0.2) -> None:
        if plant.amplifier.mode is not Mode.SPEED:
            raise ConfigError("the panel jogs by the amplifier's own speed loop: its mode must be speed", key="mode")
        self.panel = FrontPanel()
        self.command = 0.0
        self.now = 0.0
        self.position = self.speed = self.current = 0.0
        self._plant, self._jog, self._ramp, self._overload = plant, jog, ramp, overload
        self._kernel = ServoKernel(plant_members(plant, STEP, Power.FREE))
        self._power, self._run = Power.FREE, False
        self._wanted, self._hot, self._stop = 0.0, 0.0, 0.0

    @property
    def power(self) -> Power:
        """What is done with the winding."""
        return self._power

    @property
    def ready(self) -> bool:
        """Output RDY."""
        return self.panel.ready(self.now)

    @property
    def healthy(self) -> bool:
        """Output ALMb, a contact that opens at a fault."""
        return self.panel.fault is None

    def supply(self, *, on: bool) -> None:
        """Switch the control supply."""
        turning = self._power is Power.DRIVEN
        self.panel.supply(self.now, on=on)
        self._run = False
        self._stop = self.now + STOP if turning and not on else self.now

    def run(self, *, on: bool) -> None:
        """Set input RUN: the controller enables the motor; nothing comes of it before it is ready."""
        self._run = on and self.ready

    def reset(self) -> None:
        """Pulse input RST: forget a fault."""
        self.panel.reset()
        self._hot = 0.0

    def press(self, key: Key) -> None:
        """Press a key of the panel."""
        self.panel.press(key, self.now)

    def release(self, key: Key) -> None:
        """Let a key go."""
        self.panel.release(key, self.now)

    def jam(self) -> None:
        """Clamp the shaft, as a nut at the end of its screw does."""
        most = self._plant.amplifier.current * self._plant.torque_constant
        self._plant = replace(self._plant, motor_friction=Friction(coulomb=20.0 * most, smooth=20.0))
        self._set(self._power, again=True)

    def advance(self, seconds: float) -> None:
        """Let time go by."""
        for _ in range(round(seconds / TICK)):
            self._tick()

    def _tick(self) -> None:
        ready = self.panel.ready(self.now)
        if (self.panel.energised or self._run) and ready:
            self._set(Power.DRIVEN)
        else:
            stopping = self.healthy and self.now < self._stop and abs(self.speed) > _STILL
            self._set(Power.BRAKED if stopping else Power.FREE)
        wanted = self.command * self._plant.amplifier.gain if self._run else 0.0
        if self.panel.energised:
            wanted = self._jog * self.panel.jogging
        most = self._jog / self._ramp * TICK
        self._wanted += max(-most, min(most, wanted - self._wanted)) if self._power is Power.DRIVEN else -self._wanted
        rows = self._kernel.drive(np.full(2, self._wanted / self._plant.amplifier.gain), steps=round(0.5 * TICK / STEP))
        self.position, self.speed = float(rows.motor[-1]), float(rows.speed[-1])
        self.current = float(rows.current[-1])
        self.now += TICK
        at_limit = self._power is Power.DRIVEN and abs(self.current) >= _AT_LIMIT * self._plant.amplifier.current
        self._hot = self._hot + TICK if at_limit else 0.0
        if self._hot > self._overload:
            self.panel.trip(OVERLOAD)
            self._run = False

    def _set(self, power: Power, *, again: bool = False) -> None:
        if power is not self._power or again:
            self._power = power
            self._kernel.set_plant(plant_members(self._plant, STEP, power))
