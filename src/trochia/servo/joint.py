"""A machine's servo joint at work: its file's data made a plant and a loop, run from period to period.

In: a :class:`ServoDrive`.  Out: a :class:`JointServo` that follows joint positions [mm or degree] and tells where motor
and load are, in the same.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.errors import LimitError
from trochia.kernels.servo_law import PMAC, THIRTY_SECONDS, LawKernel
from trochia.machine.servos import CascadeLoop, PidLoop, PmacLoop, ThirtySecondsLoop
from trochia.servo.axis import STEP, Loop, ServoAxis, plant_members
from trochia.servo.filters import Biquad, low_pass, notch
from trochia.servo.forward import feed_forward
from trochia.servo.pid import Pid, Windup

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.kernels.servo import ServoSamples
    from trochia.machine.servos.drive import ServoDrive

_BITS = 32768  #: of a card's output of 10 V


class JointServo:
    """One joint at rest at ``position`` [mm or degree]."""

    def __init__(self, drive: ServoDrive, *, position: float = 0.0, name: str = "joint") -> None:
        self.drive, self.name = drive, name
        at = position / drive.per_radian
        data = drive.loop
        if isinstance(data, CascadeLoop | PidLoop):
            self._axis: ServoAxis | LawKernel = ServoAxis(drive.plant, loop_of(drive), position=at)
        else:
            self._axis = _law(drive, data, at)

    @property
    def period(self) -> float:
        """Between ticks [s]."""
        return self.drive.period

    def run(self, wanted: NDArray[np.float64]) -> ServoSamples:
        """Follow positions, velocities and accelerations (ticks, 3) [mm or degree]; return samples in those units.

        Commands are volts, currents amperes and forces N·m.

        Raises
        ------
        LimitError
            When the loop has run away, naming the joint.
        """
        inner = wanted / self.drive.per_radian
        try:
            rows = self._axis.run(inner) if isinstance(self._axis, ServoAxis) else self._axis.run(inner[:, 0])
        except LimitError as error:
            raise LimitError(f"the loop of joint {self.name}: {error.message}", hint=error.hint) from None
        scale = self.drive.per_radian
        return type(rows)(
            measured=rows.measured * scale, motor=rows.motor * scale, load=rows.load * scale, speed=rows.speed * scale,
            command=rows.command, current=rows.current, force=rows.force,
        )  # fmt: skip


def loop_of(drive: ServoDrive) -> Loop:
    """Return the loop of a drive whose gains are physical.

    Raises
    ------
    ValueError
        For the integers of a real controller: those are no Loop.
    """
    data, period = drive.loop, drive.period
    if isinstance(data, CascadeLoop):
        # the dead band is in the joint's units, everything else in the shaft's
        position = Pid(kp=data.position_gain, dead=data.dead_band / drive.per_radian)
        speed = Pid(kp=data.speed_gain, ki=data.speed_gain * data.speed_integral, limit=_limit(drive, data))
        loop = Loop(period=period, position=position, speed=speed, averaged=data.averaged, limit=_limit(drive, data),
                    filters=_filters(data, period))  # fmt: skip
    elif isinstance(data, PidLoop):
        position = Pid(kp=data.kp, ki=data.ki, kd=data.kd, filter=data.filter, c=0.0, windup=Windup.HOLD,
                       limit=_limit(drive, data), dead=data.dead_band / drive.per_radian)  # fmt: skip
        loop = Loop(period=period, position=position, limit=_limit(drive, data), filters=_filters(data, period))
    else:
        raise ValueError(f"a loop of kind {data.kind} computes in whole numbers")  # noqa: TRY004 - kinds are values
    return feed_forward(drive.plant, loop, velocity=data.velocity_forward, acceleration=data.acceleration_forward,
                        friction=data.friction_forward)  # fmt: skip


def _limit(drive: ServoDrive, data: CascadeLoop | PidLoop) -> float:
    return min(data.limit or math.inf, drive.amplifier.command)


def _filters(data: CascadeLoop | PidLoop, period: float) -> tuple[Biquad, ...]:
    found: list[Biquad] = []
    if data.notch is not None:
        found.append(notch(data.notch.frequency, period, width=data.notch.width, depth=data.notch.depth))
    if data.low_pass is not None:
        found.append(low_pass(data.low_pass, period))
    return tuple(found)


def _law(drive: ServoDrive, data: PmacLoop | ThirtySecondsLoop, at: float) -> LawKernel:
    """Return the loop that computes in whole numbers."""
    steps = max(1, math.ceil(drive.period / STEP - 1e-9))
    counts = drive.plant.counts
    assert counts is not None, "held to at construction"
    law: dict[str, Any] = {"steps": steps, "counts": counts}
    pid = None
    if isinstance(data, PmacLoop):
        names = (name for name in data.__slots__ if name.startswith("i"))
        law |= {"kind": PMAC, "volts": 10.0 / _BITS} | {name: getattr(data, name) for name in names}
    else:
        law |= {"kind": THIRTY_SECONDS, "volts": drive.amplifier.command / data.most}
        pid = {"p": data.p, "i": data.i, "d": data.d, "most": data.most, "mended": int(data.mended)}
    edges = drive.plant.edges
    return LawKernel(plant_members(drive.plant, drive.period / steps), law, pid=pid, position=at,
                     seed=0 if edges is None else edges.seed)  # fmt: skip


def at_rest(position: float, ticks: int) -> NDArray[np.float64]:
    """Return set-points (ticks, 3) of standing still."""
    wanted = np.zeros((ticks, 3))
    wanted[:, 0] = position
    return wanted
