"""The twin of a servo axis as something to experiment on.

In: a plant.  Out: an :class:`~trochia.experiments.protocol.AxisUnderTest`, whose parameters an experiment does not see.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from trochia.errors import ConfigError
from trochia.kernels.servo import ServoKernel
from trochia.machine.servo_plant import Mode
from trochia.servo.axis import STEP, Loop, plant_members

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from trochia.kernels.servo import ServoSamples
    from trochia.machine.servo_plant import ServoPlant

    Array = NDArray[np.float64]


class TwinAxis:
    """One axis at rest, its motor off.

    Parameters
    ----------
    period
        Of the servo [s].
    limit
        Position of the load from which on the limit switch is closed; None: there is none.
    """

    def __init__(
        self, plant: ServoPlant, period: float, *, position: float = 0.0, limit: float | None = None,
        step: float = STEP,
    ) -> None:  # fmt: skip
        if plant.amplifier.mode is not Mode.CURRENT:
            raise ConfigError("experiments command a torque: the amplifier must be one of current", key="mode")
        self.period = period
        self.torque = plant.amplifier.gain * plant.torque_constant
        self.counts = plant.counts
        self.enabled = False
        self._step = period / max(1, math.ceil(period / step - 1e-9))
        self._off = Loop(period=period)
        self._kernel = ServoKernel(plant_members(plant, self._step), self._off.members(self._step), position=position,
                                   seed=0 if plant.edges is None else plant.edges.seed)  # fmt: skip
        self._place, self._load, self._limit = position, position, math.inf if limit is None else limit

    @property
    def position(self) -> float:
        """Where the encoder says the axis is."""
        return self._place

    @property
    def limit_closed(self) -> bool:
        """Whether the load is at the limit switch."""
        return self._load >= self._limit

    def enable(self, loop: Loop) -> None:
        """Power the motor under a loop that begins anew."""
        if loop.period != self.period:
            raise ConfigError(f"the axis ticks every {self.period:g} s, the loop every {loop.period:g} s", key="period")
        self._kernel.forget()
        self._kernel.set_loop(loop.members(self._step))
        self.enabled = True

    def advance(self, wanted: Array, injected: Array | None = None) -> ServoSamples:
        """Go on for some ticks; an axis that is off coasts."""
        samples = self._kernel.run(wanted, injected=injected if self.enabled else None)
        if len(samples.measured):
            self._place, self._load = float(samples.measured[-1]), float(samples.load[-1])
        return samples

    def off(self) -> None:
        """Take the power from the motor."""
        self.enabled = False
        self._kernel.forget()
        self._kernel.set_loop(self._off.members(self._step))
