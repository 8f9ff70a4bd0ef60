"""The torque-speed curve of a motor behind its driver, with what limits it.

In: a motor behind its driver, its load.  Out: :class:`Curve`, by closed forms, measured on the twin where asked.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.analysis.stability import growth_rate
from trochia.analysis.sweep.limits import compare, limits
from trochia.analysis.sweep.procedures import pull_in_torque, pull_out_torque_measured
from trochia.errors import LimitError
from trochia.machine.motors.hybrid import FREE
from trochia.machine.motors.shaft import ShaftLoad

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from trochia.analysis.sweep.limits import Limits
    from trochia.analysis.sweep.timing import Timing
    from trochia.machine.drivers import Fed

    Floats = NDArray[np.float64]

FALLEN = 0.2  #: part of the holding torque at which a curve without a speed given ends
RPM = 30.0 / math.pi


@dataclass(frozen=True, slots=True, kw_only=True)
class Curve:
    """Torque over speed.

    Attributes
    ----------
    speeds, pull_out
        Of the shaft (n,) [rad/s]; torque by closed form, the motor's own frictions taken off (n,) [N·m].
    measured, pull_in
        On the twin, the frictions of the load in it (n,) [N·m], or None where nobody asked.
    growth
        Growth rate of a small disturbance (n,) [1/s]: above zero a voltage-fed motor does not run steadily; NaN where a
        current controller feeds it (no such instability) or it does not run.
    resonance
        Frequency of small swings at rest, full current [Hz].
    start_stop
        By the estimate of energy [rad/s]; 0: it does not start.
    limits
        Measured on the twin: ``pull_out`` and ``start_stop`` speeds [rad/s]; empty where nobody asked.
    compared
        The same for both full steps, timed by the shield's library and exactly; empty where nobody asked.
    """

    made: Fed
    load: ShaftLoad
    speeds: Floats
    pull_out: Floats
    measured: Floats | None
    pull_in: Floats | None
    growth: Floats
    resonance: float
    start_stop: float
    limits: dict[str, float]
    compared: list[Limits] = field(default_factory=list["Limits"])

    def unstable(self) -> list[tuple[float, float]]:
        """Return the bands of speed in which a small disturbance grows [rad/s]."""
        grows = np.concatenate([[False], self.growth > 0, [False]])
        begins, ends = np.flatnonzero(~grows[:-1] & grows[1:]), np.flatnonzero(grows[:-1] & ~grows[1:]) - 1
        return [(float(self.speeds[a]), float(self.speeds[b])) for a, b in zip(begins, ends, strict=True)]

    def figures(self) -> dict[str, Any]:
        """Return what ``trochia sweep --json`` prints of a curve."""
        full = self.made.motor.full_steps / math.tau
        columns = {"pull_out_Nm": self.pull_out, "measured_Nm": self.measured, "pull_in_Nm": self.pull_in}
        rows = [
            {"speed_rpm": speed * RPM, "speed_steps_s": speed * full}
            | {name: None if values is None else float(values[i]) for name, values in columns.items()}
            for i, speed in enumerate(self.speeds.tolist())
        ]
        corner, fastest = self.made.corner, min(self.made.fastest(self.load), self.made.top(FALLEN))
        return {
            "holding_torque_Nm": self.made.holding,
            "current_A": self.made.current,
            "corner_rpm": None if corner is None else corner * RPM,
            "fastest_rpm": fastest * RPM,
            "resonance_Hz": self.resonance,
            "start_stop_rpm": min(self.start_stop, fastest) * RPM,
            "unstable_rpm": [[low * RPM, high * RPM] for low, high in self.unstable()],
            "limits_rpm": {name: speed * RPM for name, speed in self.limits.items()},
            "limits_compared": [one.figures() for one in self.compared],
            "curve": rows,
        }


def curve(
    made: Fed,
    load: ShaftLoad = FREE,
    *,
    top: float | None = None,
    points: int = 40,
    measure: bool = False,
    timing: Timing | None = None,
    compared: bool = False,
    progress: Callable[[str, float], None] | None = None,
) -> Curve:
    """Return the curve of a motor behind its driver.

    Parameters
    ----------
    load
        Its inertia, friction and constant torque count in what starts and in what is measured.
    top
        Greatest speed [rad/s]; without it where the torque has fallen to a fifth of its value at rest.
    measure
        Also measure pull-out and pull-in torques on the twin.
    timing
        Also search the pull-out and start/stop speeds on the twin, with pulses timed so, in steps of 1 rpm.
    compared
        Also search them for both full steps, timed by the shield's library and exactly.
    """
    end = made.top(FALLEN) if top is None else top
    speeds = np.linspace(end / points, end, points)
    torque = made.pull_out(speeds)
    measured = pull_in = None
    if measure:
        measured, pull_in = np.zeros(points), np.zeros(points)
        bare = ShaftLoad(inertia=load.inertia, friction=load.friction, viscous=load.viscous)
        for i, speed in enumerate(speeds.tolist()):
            if progress is not None:
                progress("measuring", i / points)
            measured[i] = pull_out_torque_measured(made, speed, bare) if torque[i] > 0 else 0.0
            pull_in[i] = pull_in_torque(made, speed, bare)
        for found in (measured, pull_in):  # what its own load's frictions take, the motor gives besides
            found[found > 0] += load.friction + load.viscous * speeds[found > 0]
    return Curve(
        made=made,
        load=load,
        speeds=speeds,
        pull_out=torque,
        measured=measured,
        pull_in=pull_in,
        growth=np.array([_growth(made, speed, load) for speed in speeds.tolist()]),
        resonance=math.sqrt(made.motor.teeth * made.holding / (made.motor.inertia + load.inertia)) / math.tau,
        start_stop=made.start_stop(load),
        limits={} if timing is None else _limits(made, load, end, timing, progress),
        compared=compare(made, load, top=end, progress=progress) if compared else [],
    )


def _growth(made: Fed, speed: float, load: ShaftLoad) -> float:
    """Return the growth rate of a voltage-fed motor; NaN where there is none to tell."""
    if made.chopper is not None:
        return math.nan
    try:
        return growth_rate(made.motor, speed, made.amplitude, load)
    except LimitError:
        return math.nan


def _limits(
    made: Fed, load: ShaftLoad, end: float, timing: Timing, progress: Callable[[str, float], None] | None
) -> dict[str, float]:
    """Return the greatest speeds without lost steps."""
    found = limits(made, load, timing, top=end, progress=progress)
    return {"pull_out": found.pull_out, "start_stop": found.start_stop}
