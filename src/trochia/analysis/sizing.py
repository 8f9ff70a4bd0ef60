"""Is the motor right for the axis: torque, speed, inertia ratio, effective torque, heat.

In: a joint's motor, driver and load, and what it has to do: a duty, or the operating points of a program.  Out:
:class:`Sizing`, with what is wrong and what would do.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.analysis.sweep.curve import RPM
from trochia.errors import LimitError
from trochia.machine.drivers import heat

if TYPE_CHECKING:
    from trochia.analysis.sweep.points import OperatingPoints
    from trochia.machine.torque import Drive

RATIOS = (1.0, 10.0)  #: load to rotor: between these inertias a stepper is at ease; beyond, it swings for long


@dataclass(frozen=True, slots=True, kw_only=True)
class Duty:
    """What a joint has to do again and again.

    Attributes
    ----------
    velocity, acceleration
        Greatest, of the joint [mm/s, mm/s² or degrees].
    turning
        Part of the time in which it moves, 0 to 1.
    ramping
        Part of the moving time in which it accelerates or brakes.
    """

    velocity: float
    acceleration: float
    turning: float = 1.0
    ramping: float = 1.0

    def __post_init__(self) -> None:
        for name, value in (("velocity", self.velocity), ("acceleration", self.acceleration)):
            if not 0 < value < math.inf:
                raise LimitError(f"the {name} of a duty must be above zero, not {value:g}")
        for name, value in (("turning", self.turning), ("ramping", self.ramping)):
            if not 0 <= value <= 1:
                raise LimitError(f"the {name} part of a duty is 0 to 1, not {value:g}")


def duty_of_move(distance: float, time: float, rest: float = 0.0) -> Duty:
    """Return the duty of one move in a time, a third of it each for acceleration, even speed and braking.

    That is the move of least effective torque among trapezoids of given time, near enough: v = 3 d/2 t, a = 9 d/2 t².

    Parameters
    ----------
    distance, time
        Of the move [mm or degree], [s].
    rest
        Until the next [s].

    Raises
    ------
    LimitError
        When distance or time is not above zero.
    """
    if not (0 < distance < math.inf and 0 < time < math.inf and 0 <= rest < math.inf):
        raise LimitError(
            f"a move needs a distance and a time above zero, not {distance:g} in {time:g} s, {rest:g} s rest"
        )
    return Duty(velocity=1.5 * distance / time, acceleration=4.5 * distance / time**2, turning=time / (time + rest),
                ramping=2 / 3)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class Sizing:
    """What is asked of a motor, and what it has.

    Attributes
    ----------
    speed, torque
        Greatest speed of the shaft [rad/s], and greatest torque along the motion, frictions of the load in it [N·m].
    available
        Torque at the point that is tightest [N·m], and ``used``, the part of it that is used there.
    effective
        Torque averaged over squares, rests in it [N·m].
    inertia_ratio
        Of the load to the rotor.
    motor_heat, rated_heat, driver_heat
        With all current on [W]; the rated one is what the catalogue allows for ever.
    reach
        Speed at which the usable torque ends under this load without acceleration, or a fifth of it is left [rad/s].
    """

    speed: float
    torque: float
    available: float
    used: float
    effective: float
    inertia_ratio: float
    motor_heat: float
    rated_heat: float
    driver_heat: float
    reach: float
    problems: tuple[str, ...]
    remarks: tuple[str, ...]

    @property
    def ok(self) -> bool:
        """Whether the motor does it with its margin, and stays cool."""
        return not self.problems

    def figures(self) -> dict[str, Any]:
        """Return what ``trochia size --json`` prints."""
        return {
            "ok": self.ok,
            "speed_rpm": self.speed * RPM,
            "torque_Nm": self.torque,
            "available_Nm": self.available,
            "margin": max(1 - self.used, -99.0),
            "effective_torque_Nm": self.effective,
            "inertia_ratio": self.inertia_ratio,
            "reach_rpm": self.reach * RPM,
            "heat_W": {"motor": self.motor_heat, "motor_rated": self.rated_heat, "driver": self.driver_heat},
            "problems": list(self.problems),
            "remarks": list(self.remarks),
        }


def size_by_duty(motor: Drive, duty: Duty) -> Sizing:
    """Return the sizing for a duty: the tightest point is the end of the acceleration, at full speed."""
    omega = duty.velocity / abs(motor.per_radian)
    drag = motor.load.friction + motor.load.viscous * omega
    inertial = motor.inertia * duty.acceleration / abs(motor.per_radian)
    weight = abs(motor.load.constant)
    torque = inertial + weight + drag
    braking = inertial + weight - drag
    even = weight + drag
    squares = duty.ramping * (torque**2 + braking**2) / 2 + (1 - duty.ramping) * even**2
    effective = math.sqrt(duty.turning * squares + (1 - duty.turning) * weight**2)
    return _judged(motor, omega, torque, float(motor.made.pull_out(np.array(omega))), effective)


def size_by_points(motor: Drive, points: OperatingPoints) -> Sizing:
    """Return the sizing for a program's operating points.

    Raises
    ------
    LimitError
        When the joint never moves.
    """
    if not len(points.speed) or not points.speed.max() > 0:
        raise LimitError("the program does not move this joint")
    there = np.maximum(motor.made.pull_out(points.speed), 1e-12)
    worst = int(np.argmax(np.abs(points.torque) / there))
    return _judged(
        motor, float(points.speed.max()), float(abs(points.torque[worst])), float(there[worst]), points.rms
    )  # fmt: skip


def _judged(motor: Drive, omega: float, torque: float, available: float, effective: float) -> Sizing:
    """Return the sizing with its problems, each with what would do."""
    used = torque / available if available > 0 else math.inf
    ratio = motor.load.inertia / motor.made.motor.inertia
    warm, allowed = heat(motor.made), 1 - motor.margin
    reach = motor.greatest_velocity / abs(motor.per_radian)
    problems: list[str] = []
    if omega > reach:
        problems.append(f"at {omega * RPM:.0f} rpm no usable torque is left; at most {reach * RPM:.0f} rpm would do, "
                        "or a higher supply")  # fmt: skip
    elif used > allowed:
        problems.append(f"it needs {torque:.3g} N·m at {omega * RPM:.0f} rpm, of {available:.3g} N·m only "
                        f"{allowed:.0%} are to be used; {torque / allowed:.3g} N·m there would do")  # fmt: skip
    problems += warm.problems()
    remarks: list[str] = []
    if not RATIOS[0] / 10 <= ratio <= RATIOS[1]:
        best = math.sqrt(ratio)
        remarks.append(
            f"the load has {ratio:.3g} times the rotor's inertia; a gear of {best:.2g}:1 would even them out"
        )
    return Sizing(
        speed=omega,
        torque=torque,
        available=available,
        used=used,
        effective=effective,
        inertia_ratio=ratio,
        motor_heat=warm.motor,
        rated_heat=warm.rated,
        driver_heat=warm.driver,
        reach=min(reach, motor.made.top()),
        problems=tuple(problems),
        remarks=tuple(remarks),
    )
