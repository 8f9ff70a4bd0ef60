"""Whether a machine's errors and corrections fit it.  In: a Machine being made.  Out: nothing, or a ConfigError."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.errors import ConfigError
from trochia.machine.compensation import PAIRS
from trochia.machine.crossing import crossing_of
from trochia.machine.reserve import shares

if TYPE_CHECKING:
    from trochia.machine.error_table import ErrorTable
    from trochia.machine.machine import Machine

REACH = 0.1  #: of the travel a table may leave out at either end: it goes on in a straight line there


def check_corrections(machine: Machine) -> None:
    """Hold tables to the travel, pairs to the axes, and all of it to what the limits leave.

    Raises
    ------
    ConfigError
        Naming the key to change.
    """
    names = [axis.name for axis in machine.axes]
    for section in ("squareness", "squareness_error"):
        given = getattr(machine, section)
        for pair in PAIRS:
            if given is not None and getattr(given, pair) and not set(pair) <= set(names):
                raise ConfigError(f"this machine has no axes {pair[0]} and {pair[1]}", key=f"{section}.{pair}")
    for index, joint in enumerate(machine.joints):
        given = joint.compensation
        if given is not None and given.screw is not None:
            _check_reach(machine, index, given.screw, "compensation.screw")
        if joint.screw_error is not None:
            _check_reach(machine, index, joint.screw_error, "screw_error")
            if joint.encoder is not None and joint.encoder.on_load:
                raise ConfigError("an encoder on the load sees the error of the screw: leave one of them out",
                                  key=f"joints.{joint.name}.screw_error")  # fmt: skip
    crossing = crossing_of(machine)
    if crossing is not None:
        shares(machine, crossing.mix)


def _check_reach(machine: Machine, index: int, table: ErrorTable, key: str) -> None:
    """Refuse a table that leaves out more than a tenth of the travel at an end; several axes' travel adds up."""
    moved = [(float(c), axis) for c, axis in zip(machine.kinematics.matrix[index], machine.axes, strict=True) if c]
    low = sum(min(c * axis.minimum, c * axis.maximum) for c, axis in moved)
    high = sum(max(c * axis.minimum, c * axis.maximum) for c, axis in moved)
    first, last = table.points[0][0], table.points[-1][0]
    spare = REACH * (high - low)
    if first > low + spare or last < high - spare:
        name = machine.joints[index].name
        raise ConfigError(f"must reach over the travel, {low:g} to {high:g}, not from {first:g} to {last:g} only",
                          key=f"joints.{name}.{key}", hint="A tenth may be left out at each end.")  # fmt: skip
