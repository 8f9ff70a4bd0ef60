"""What a planner keeps free so that motors stay within their limits when their errors are corrected.

In: a machine.  Out: factors on the limits of every joint, and how long backlash takes.  Legend: V, A, J limits of a
joint; s1, s2, s3 the greatest first, second and third derivative of its error table; k what other axes add to it
through squareness; c the share that backlash b has.

Backlash is made up in T by b S(t / T), S' ≤ 1.875, S'' ≤ 5.774, S''' ≤ 60.  Reversals may follow each other within T:
their signs alternate, S' has one hump, S'' two and S''' three, so that sums are at most 1, 2 and 3 times as great.  T
is such that velocity takes c V, acceleration half of c A (the other half is for a stop that comes from the backend's
own time base), jerk c J.  The table takes s1 of each, s2 W² of acceleration and 3 s2 W A' + s3 W³ of jerk at the speed
W left; where one of these were more than a quarter of its limit, W is lowered until it is not.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from trochia.errors import ConfigError
from trochia.machine.rates import joint_velocity

if TYPE_CHECKING:
    from trochia.machine.machine import Machine

SHORTEST = 0.02  #: time to make up backlash: several rows of what a backend is given [s]
QUARTER = 0.25
LEAST = 0.4  #: of a limit must be left
_S1, _S2, _S3 = 1.875, 5.7736, 60.0


class Share(NamedTuple):
    """What is left of a joint's velocity, acceleration and jerk, as factors."""

    velocity: float = 1.0
    acceleration: float = 1.0
    jerk: float = 1.0


class _Limits(NamedTuple):
    """V, A, J of a joint; infinite where nothing is given."""

    velocity: float
    acceleration: float
    jerk: float


def limits_of(machine: Machine, joint: int) -> _Limits:
    """Return what a program can ask of a joint [mm/s, mm/s², mm/s³ or degrees]."""
    row = np.abs(machine.kinematics.matrix[joint])
    moved = [(float(c), axis) for c, axis in zip(row, machine.axes, strict=True) if c]
    own = machine.joints[joint]
    acceleration = sum(c * axis.acceleration for c, axis in moved)
    jerk = sum(c * (np.inf if axis.jerk is None else axis.jerk) for c, axis in moved)
    return _Limits(joint_velocity(machine, joint), min(acceleration, own.acceleration or np.inf),
                   min(float(jerk), own.jerk or np.inf))  # fmt: skip


def take_up_time(machine: Machine, joint: int) -> float:
    """Return how long making up a joint's backlash takes, T [s]."""
    given = machine.joints[joint].compensation
    assert given is not None
    v, a, j = (given.share * limit for limit in limits_of(machine, joint))
    b = given.backlash
    return max(SHORTEST, _S1 * b / v, (4.0 * _S2 * b / a) ** 0.5, (3.0 * _S3 * b / j) ** (1.0 / 3.0))


def shares(machine: Machine, mix: np.ndarray[tuple[int, int], np.dtype[np.float64]]) -> list[Share]:
    """Return what is left of every joint's limits; ``mix`` is how squareness mixes joints (joints, joints).

    Raises
    ------
    ConfigError
        Where less than 40 % would be left.
    """
    limits = [limits_of(machine, j) for j in range(len(machine.joints))]
    found: list[Share] = []
    for j, (joint, own) in enumerate(zip(machine.joints, limits, strict=True)):
        given = joint.compensation
        backlash = given.share if given is not None and given.backlash else 0.0
        table = given.screw.steepest if given is not None and given.screw is not None else (0.0, 0.0, 0.0)
        added = [1.0 + _added(mix, limits, j, order) for order in range(3)]
        share = _share(own, table, backlash, added)
        if min(share) < LEAST:
            left = 100 * max(min(share), 0)
            raise ConfigError(
                f"its corrections leave {left:.0f} % of the joint's limits; at least 40 % must be left",
                key=f"joints.{joint.name}.compensation",
                hint="A smoother table, less squareness error, or a smaller share for backlash.")  # fmt: skip
        found.append(share)
    return found


def _added(
    mix: np.ndarray[tuple[int, int], np.dtype[np.float64]], limits: list[_Limits], joint: int, order: int
) -> float:
    """Return what other joints add to one, as a part of its own limit."""
    total = 0.0
    for k, limit in enumerate(limits):
        c = abs(float(mix[joint, k]) - (k == joint))
        if c and np.isfinite(limits[joint][order]):
            total += c * limit[order] / limits[joint][order]
    return total


def _share(own: _Limits, table: tuple[float, float, float], backlash: float, added: list[float]) -> Share:
    s1, s2, s3 = table
    straight = 1.0 + s1
    most = (1.0 - backlash) * own.velocity / straight  # of q' itself
    speed = min(most, (QUARTER * own.acceleration / s2) ** 0.5) if s2 else most
    while True:
        acceleration = (1.0 - backlash - s2 * speed**2 / own.acceleration) / straight  # of q''
        bent = 3.0 * s2 * speed * acceleration * own.acceleration + s3 * speed**3
        if not np.isfinite(own.jerk) or bent <= QUARTER * own.jerk:
            break
        speed *= 0.95
    jerk = (1.0 - backlash - (bent / own.jerk if np.isfinite(own.jerk) else 0.0)) / straight
    return Share(speed / own.velocity / added[0], acceleration / added[1], jerk / added[2])
