"""The loop of a drive in physical units, also where it computes in whole numbers: what margins are told of.

In: a drive.  Out: a Loop that says the same but for rounding, dead bands, and what saturates.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.machine.servos import PmacLoop, ThirtySecondsLoop
from trochia.servo.axis import Loop
from trochia.servo.joint import loop_of
from trochia.servo.pid import Pid, Windup
from trochia.servo.scaling import SCALE_32, PmacGains

if TYPE_CHECKING:
    from trochia.machine.servos.drive import ServoDrive


def nominal_loop(drive: ServoDrive) -> Loop:
    """Return the loop, position in rad of the shaft, command in V."""
    data, period, counts = drive.loop, drive.period, drive.plant.counts
    if isinstance(data, PmacLoop):
        assert counts is not None, "held to at construction"
        names = ("i30", "i31", "i32", "i33", "i35", "i08", "i09", "i29", "i63", "i69")
        return PmacGains(**{name: getattr(data, name) for name in names}).loop(counts, period)
    if isinstance(data, ThirtySecondsLoop):
        assert counts is not None, "held to at construction"
        most = drive.amplifier.command
        volts = most / data.most * counts / SCALE_32  # of a gain of 1 in 32nds, a radian of error
        pid = Pid(kp=data.p * volts, ki=data.i * volts / period, kd=data.d * volts * period, windup=Windup.HOLD,
                  limit=most)  # fmt: skip
        return Loop(period=period, position=pid, limit=most)
    return loop_of(drive)
