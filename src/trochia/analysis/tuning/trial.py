"""A step and a parabolic move of a servo joint under the loop that its file gives, whatever it computes in.

In: a drive, a move.  Out: :class:`Trial`: what the joint did, its figures, and the feed-forward that would help.

What the move took tells the feed-forward: by inverse dynamics command = A a + V v + F sign v + offset, and

    cascade, pid   each part fed forward is what was found over what the nominal plant asks
    pmac           i32 = 128 (V + Kd) / (Kp T), i35 = 128 A / (Kp T²): its feed-forward stands beside the error
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.analysis.identification.inverse_dynamics import inverse_dynamics
from trochia.analysis.tuning.margins import Margins, loop_margins
from trochia.analysis.tuning.metrics import FollowingMetrics, StepMetrics, following_metrics, step_metrics
from trochia.errors import ConfigError, LimitError, RecordingError
from trochia.machine.servos import PmacLoop, ThirtySecondsLoop
from trochia.servo.axis import Loop
from trochia.servo.forward import feed_forward
from trochia.servo.joint import JointServo, at_rest
from trochia.servo.nominal import nominal_loop

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.servos.drive import ServoDrive

    Array = NDArray[np.float64]

MOVES = ("step", "parabolic")
SETTLE = 0.3  #: at rest before a move, for the loop to carry what hangs on it [s]
LISTEN = 0.5  #: behind it [s]
_FULL = 0.999  # of the current's limit
_SCALE = 128.0  # of a PMAC's feed-forward
_CUTOFF = 30.0  # of what is taken for motion, not noise of counts [Hz]


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """One move as it went, from its first tick on; rows (ticks,) in the joint's units, volts and amperes.

    Attributes
    ----------
    limited
        Time for which the current was at its limit [s].
    suggested
        Keys of the loop's table and values that would feed forward what the move took; empty for a step.
    """

    kind: str
    time: Array
    wanted: Array
    measured: Array
    command: Array
    current: Array
    margins: Margins
    step: StepMetrics | None
    following: FollowingMetrics | None
    limited: float
    suggested: dict[str, float]

    def figures(self) -> dict[str, Any]:
        """Return what ``--json`` prints as metrics."""
        found: dict[str, Any] = {"limited_s": self.limited}
        for part in (self.step, self.following):
            found |= {} if part is None else part.figures()
        return found


def step_of(start: float, size: float, ticks: int) -> Array:
    """Return set-points (ticks, 3) of a step at the first."""
    return at_rest(start + size, ticks)


def parabola_of(start: float, size: float, seconds: float, period: float, ticks: int) -> Array:
    """Return set-points of a move whose speed is a parabola over time, there and back, with rests of ``ticks``."""
    u = np.arange(round(seconds / period) + 1, dtype=np.float64) * period / seconds
    there = np.stack([size * u * u * (3.0 - 2.0 * u), size / seconds * 6.0 * u * (1.0 - u),
                      size / seconds**2 * (6.0 - 12.0 * u)], axis=1)  # fmt: skip
    back = -there + [size, 0.0, 0.0]
    wanted = np.concatenate([there, at_rest(size, ticks), back, at_rest(0.0, ticks)])
    wanted[:, 0] += start
    return wanted


def trial(
    drive: ServoDrive, kind: str, wanted: Array, *, start: float, travel: tuple[float, float], speed: float = math.inf
) -> Trial:
    """Return what a joint at rest at ``start`` does with set-points.

    Parameters
    ----------
    travel, speed
        Ends of the joint's travel, and its greatest speed, in its units.

    Raises
    ------
    ConfigError
        When the loop is unstable: it is not run at all.
    LimitError
        Before it moves, where the move leaves travel or asks for more speed or torque than there is; while it moves,
        where it leaves travel.
    """
    margins = loop_margins(drive.plant, nominal_loop(drive))
    if not margins.stable:
        raise ConfigError("the gains of this joint are unstable on its plant: nothing has moved", key="loop",
                          hint="Lower them, or let `trochia tune` find others.")  # fmt: skip
    _refuse(drive, wanted, travel, speed)
    servo = JointServo(drive, position=start)
    servo.run(at_rest(start, round(SETTLE / drive.period)))
    block, parts = max(1, round(0.01 / drive.period)), []
    for first in range(0, len(wanted), block):
        parts.append(servo.run(wanted[first : first + block]))
        if not travel[0] <= parts[-1].measured.min() <= parts[-1].measured.max() <= travel[1]:
            raise LimitError("stopped: travel was exceeded; the motor is off", hint="Lower gains, or the move's size.")
    measured, command, current = (
        np.concatenate([getattr(part, name) for part in parts]) for name in ("measured", "command", "current")
    )
    time = drive.period * np.arange(len(wanted), dtype=np.float64)
    following = None if kind == "step" else following_metrics(wanted, measured)
    full = np.abs(current) >= _FULL * drive.plant.amplifier.current
    return Trial(
        kind=kind, time=time, wanted=wanted, measured=measured, command=command, current=current, margins=margins,
        step=step_metrics(time, measured, float(wanted[0, 0]) - start, start=start) if kind == "step" else None,
        following=following, limited=float(full.sum()) * drive.period,
        suggested={} if following is None else suggested(drive, measured, command),
    )  # fmt: skip


def _refuse(drive: ServoDrive, wanted: Array, travel: tuple[float, float], speed: float) -> None:
    low, high = float(wanted[:, 0].min()), float(wanted[:, 0].max())
    if low < travel[0] or high > travel[1]:
        raise LimitError(f"the move would go from {low:.4g} to {high:.4g}; travel is {travel[0]:g} to {travel[1]:g}",
                         hint="Nothing has moved.  Give a smaller --size.")  # fmt: skip
    fastest = float(np.abs(wanted[:, 1]).max())
    if fastest > speed:
        raise LimitError(f"the move would run at {fastest:.4g} a second; {speed:.4g} is allowed",
                         hint="Nothing has moved.  Give it more --time, or a smaller --size.")  # fmt: skip
    used = float(drive.used(wanted[:, 1], wanted[:, 2]).max())
    if used > 1.0:
        raise LimitError(f"the move would ask {used:.2f} times the torque, and so the current, that there is",
                         hint="Nothing has moved.  Give it more --time, or a smaller --size.")  # fmt: skip


def suggested(drive: ServoDrive, measured: Array, command: Array) -> dict[str, float]:
    """Return the keys of the loop's table, and values, that feed forward what a move took; empty where it tells none.

    Parameters
    ----------
    measured, command
        Positions in the joint's units and volts (ticks,).
    """
    data, period = drive.loop, drive.period
    if isinstance(data, ThirtySecondsLoop):
        return {}
    try:
        took = inverse_dynamics(measured / drive.per_radian, command, period, cutoff=min(_CUTOFF, 0.05 / period))
    except RecordingError:
        return {}
    loop = nominal_loop(drive)
    assert loop.position is not None, "all of them have one"
    damping = loop.position.kd * (1.0 - loop.position.c)
    if isinstance(data, PmacLoop):
        per = loop.position.kp * period / _SCALE
        return {"i32": float(round((took["viscous"] + damping) / per)),
                "i35": float(round(took["inertia"] / (per * period)))}  # fmt: skip
    asks = feed_forward(drive.plant, Loop(period=period))
    parts = {"acceleration_forward": (took["inertia"], asks.acceleration_forward),
             "friction_forward": (took["coulomb"], asks.friction_forward)}  # fmt: skip
    # a speed loop has to be told all of the speed, whatever the plant's friction
    found = {"velocity_forward": 1.0}
    if loop.speed is None:
        parts["velocity_forward"] = took["viscous"] + damping, asks.viscous_forward + damping
    found |= {name: round(max(value / whole, 0.0), 3) for name, (value, whole) in parts.items() if whole > 0.0}
    return found
