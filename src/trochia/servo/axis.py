"""A servo axis: the loops in front of a plant.

In: a ServoPlant and a Loop.  Out: what the axis does with set-points (``core/host/servo.c``).

    position -> PID -> speed -> PID -> command -> filters -> amplifier, or its current -> PID -> amplifier
                         + speed wanted            + acceleration and speed wanted, friction, bias
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from trochia.errors import ConfigError
from trochia.kernels.servo import EncoderCount, ServoKernel, ServoSamples
from trochia.machine.servo_plant import Power

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from trochia.machine.edges import Edges
    from trochia.machine.friction import Friction
    from trochia.machine.servo_plant import ServoPlant
    from trochia.servo.filters import Biquad
    from trochia.servo.pid import Pid

FILTERS = 4
_MOST_AVERAGED = 8
STEP = 1e-5  #: time step of the plant [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Loop:
    """What closes the loop, every ``period`` seconds; what is None is left out.

    Attributes
    ----------
    position, speed, current
        Controllers, one inside the other; the current's runs at the plant's time step.
    speed_forward
        Part of the speed wanted that the position's controller adds to its output.
    acceleration_forward, viscous_forward
        Command a unit of acceleration, and of speed, wanted.
    friction_forward, friction_smooth
        Command against dry friction, and the speed over which its sign turns.
    bias
        Added to the command always.
    limit
        Greatest command.
    filters
        On the command, at most 4.
    averaged
        Periods over which speed is measured.
    """

    period: float
    position: Pid | None = None
    speed: Pid | None = None
    current: Pid | None = None
    speed_forward: float = 0.0
    acceleration_forward: float = 0.0
    viscous_forward: float = 0.0
    friction_forward: float = 0.0
    friction_smooth: float = 1e-3
    bias: float = 0.0
    limit: float = math.inf
    filters: tuple[Biquad, ...] = ()
    averaged: int = 1

    def __post_init__(self) -> None:
        if not 0.0 < self.period < math.inf:
            raise ConfigError(f"must be above zero, not {self.period!r} s", key="period")
        if len(self.filters) > FILTERS:
            raise ConfigError(f"a loop has at most {FILTERS} filters, not {len(self.filters)}", key="filters")
        if not 1 <= self.averaged <= _MOST_AVERAGED:
            raise ConfigError(f"speed is measured over 1 to {_MOST_AVERAGED} periods, not {self.averaged}",
                              key="averaged")  # fmt: skip

    def members(self, step: float) -> dict[str, Any]:
        """Return the members of ``trochia_loop``, with the plant run in steps of ``step`` [s]."""
        steps = round(self.period / step)
        pids = {"position": self.position, "speed": self.speed, "current": self.current}
        periods = {"position": self.period, "speed": self.period, "current": step}
        return {
            "period": self.period, "steps": steps,
            "loops": sum(1 << i for i, pid in enumerate(pids.values()) if pid is not None),
            "filters": len(self.filters), "averaged": self.averaged,
            "speed_forward": self.speed_forward, "acceleration_forward": self.acceleration_forward,
            "speed_into_command": self.viscous_forward, "friction_forward": self.friction_forward,
            "friction_smooth": self.friction_smooth, "bias": self.bias, "most_command": self.limit,
            **{name: pid.members(periods[name]) for name, pid in pids.items() if pid is not None},
            "filter": [{name: getattr(f, name) for name in f.__slots__} for f in self.filters],
        }  # fmt: skip


class ServoAxis:
    """One axis at rest at ``position``.

    Parameters
    ----------
    step
        Time step of the plant [s]; the period is a whole number of them (it is shortened to be).
    """

    def __init__(self, plant: ServoPlant, loop: Loop, *, position: float = 0.0, step: float = STEP) -> None:
        self.plant, self.loop = plant, loop
        self.step = loop.period / max(1, math.ceil(loop.period / step - 1e-9))
        self._kernel = ServoKernel(plant_members(plant, self.step), loop.members(self.step), position=position,
                                   seed=0 if plant.edges is None else plant.edges.seed)  # fmt: skip

    def run(
        self,
        wanted: NDArray[np.float64],
        *,
        disturbance: NDArray[np.float64] | None = None,
        injected: NDArray[np.float64] | None = None,
    ) -> ServoSamples:
        """Follow set-points (ticks, 3) of position, speed and acceleration; see :class:`~trochia.kernels.servo`.

        Raises
        ------
        LimitError
            When the loop has run away.
        """
        return self._kernel.run(wanted, disturbance=disturbance, injected=injected)

    @property
    def encoder(self) -> EncoderCount:
        """What its encoder has passed and counted so far, where its edges are looked at one by one."""
        return self._kernel.encoder

    def retune(self, loop: Loop) -> None:
        """Go on with other gains at the same period; what the controllers remember stays."""
        if loop.period != self.loop.period:
            raise ConfigError(f"the period stays {self.loop.period:g} s while the axis runs", key="period")
        self.loop = loop
        self._kernel.set_loop(loop.members(self.step))


def plant_members(plant: ServoPlant, step: float, power: Power = Power.DRIVEN) -> dict[str, Any]:
    """Return the members of ``trochia_plant`` for a time step [s]."""
    amplifier = plant.amplifier
    return {
        "h": step, "gain": amplifier.gain, "offset": amplifier.offset, "most_voltage": amplifier.voltage,
        "speed_gain": amplifier.speed_gain, "speed_integral": amplifier.speed_integral,
        "drop": amplifier.drop, "quantum": 0.0 if amplifier.levels is None else amplifier.voltage / amplifier.levels,
        "most_current": amplifier.current, "lag": amplifier.lag,
        "resistance": plant.resistance, "inductance": plant.inductance, "torque_constant": plant.torque_constant,
        "emf_constant": plant.emf_constant,
        "motor_inertia": plant.motor_inertia, "load_inertia": plant.load_inertia,
        "stiffness": plant.stiffness or 0.0, "damping": plant.damping, "gap": plant.gap, "load": plant.load,
        "counts": plant.counts or 0.0, "on_load": int(plant.on_load), "mode": amplifier.mode.value,
        "motor_friction": _friction(plant.motor_friction), "load_friction": _friction(plant.load_friction),
        "power": power.value, "encoder": {} if plant.edges is None else _encoder(plant.edges),
    }  # fmt: skip


def _encoder(edges: Edges) -> dict[str, float]:
    return {"jitter": edges.jitter, "missed": edges.missed, "clock": edges.clock or 0.0, "turn": edges.turn or 0,
            "single": int(edges.single), "watched": 1}  # fmt: skip


def _friction(friction: Friction) -> dict[str, float]:
    return {name: getattr(friction, name) for name in friction.__slots__} | {"stick": friction.onset}
