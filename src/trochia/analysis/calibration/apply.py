"""What was measured put into a machine.  In: a machine, what points say.  Out: the machine that takes it back.

Points are measured with the corrections that the machine has already, so what is found is added to them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import ConfigError
from trochia.machine.compensation import Compensation, Squareness
from trochia.machine.error_table import ErrorTable
from trochia.machine.transmissions import Belt, Direct, Leadscrew, Rack

if TYPE_CHECKING:
    from collections.abc import Sequence

    from trochia.analysis.calibration.fit import Found, Spot
    from trochia.machine.joints import Joint
    from trochia.machine.machine import Machine
    from trochia.machine.transmissions import Transmission

NANOMETRE = 6  #: digits that are written
PARTS = ("scale", "screw", "backlash")


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisCalibration:
    """An axis calibrated.

    Attributes
    ----------
    machine
        With what was found.
    joints
        Those that were changed.
    before, after
        Greatest error of the points: as measured, and as it is foreseen [mm or degree].
    """

    machine: Machine
    joints: tuple[str, ...]
    before: float
    after: float


def calibrated(machine: Machine, axis: str, found: Found, parts: Sequence[str]) -> AxisCalibration:
    """Return a machine with an axis' scale, screw table or backlash set by what was found.

    Raises
    ------
    ConfigError
        When the axis is not moved by joints of its own, or what was found cannot be.
    """
    names = [one.name for one in machine.axes]
    if axis not in names:
        raise ConfigError(f"this machine has no axis {axis}, but {' '.join(names)}", key="axis")
    column = names.index(axis)
    rows = machine.kinematics.matrix
    moved = [j for j in range(len(rows)) if rows[j, column]]
    if any(np.count_nonzero(rows[j]) > 1 for j in moved):
        raise ConfigError(f"{axis} is moved by joints that move other axes too: a table belongs to a screw of its own",
                          key="axis")  # fmt: skip
    joints = tuple(_joint(joint, found, parts) if j in moved else joint for j, joint in enumerate(machine.joints))
    left = _left(found, parts)
    return AxisCalibration(
        machine=replace(machine, joints=joints), joints=tuple(machine.joints[j].name for j in moved),
        before=max(abs(spot.error) for spot in found.spots), after=float(np.abs(left).max()),
    )  # fmt: skip


def square(machine: Machine, pair: str, angle: float) -> Machine:
    """Return a machine with the angle of a pair of axes added to what it corrects [degree]."""
    present = machine.squareness or Squareness()
    total = round(getattr(present, pair) + angle, NANOMETRE)
    return replace(machine, squareness=replace(present, **{pair: total}))


def _left(found: Found, parts: Sequence[str]) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Return what is left of the errors at the points."""
    if "screw" in parts:
        return np.zeros(len(found.spots))
    errors = np.array([spot.error for spot in found.spots])
    places = np.array([spot.place for spot in found.spots]) - found.reference
    return errors - found.scale[0] * places if "scale" in parts else errors


def _joint(joint: Joint, found: Found, parts: Sequence[str]) -> Joint:
    given = joint.compensation or Compensation()
    slope = 0.0
    if "scale" in parts:
        slope = found.scale[0]
        joint = replace(joint, transmission=_scaled(joint.transmission, 1.0 + slope))
    if "screw" in parts:
        given = replace(given, screw=_table(given.screw, found.spots, slope, found.reference))
    if "backlash" in parts and found.backlash is not None:
        total = round(given.backlash + found.backlash[0], NANOMETRE)
        if total < 0.0:
            raise ConfigError(f"the backlash would be {total:g}: the load is ahead of its motor on the way back",
                              key="direction", hint="Are the directions the right way round?")  # fmt: skip
        given = replace(given, backlash=total)
    return replace(joint, compensation=None if given == Compensation() else given)


def _table(present: ErrorTable | None, spots: Sequence[Spot], slope: float, reference: float) -> ErrorTable:
    """Return the present table with the errors of spots added, less a line that the scale takes."""
    errors = [spot.error - slope * (spot.place - reference) for spot in spots]
    places = [spot.place for spot in spots]
    if present is None:
        pairs = zip(places, errors, strict=True)
        return ErrorTable(points=tuple((round(x, NANOMETRE), round(e, NANOMETRE)) for x, e in pairs))
    added = ErrorTable(points=tuple(zip(places, errors, strict=True)))
    every = sorted({round(x, NANOMETRE) for x in places} | {x for x, _ in present.points})
    totals = present.at(every) + added.at(np.clip(every, places[0], places[-1]))
    return ErrorTable(points=tuple((x, round(e, NANOMETRE)) for x, e in zip(every, totals.tolist(), strict=True)))


def _scaled(transmission: Transmission, factor: float) -> Transmission:
    """Return a transmission that travels as much more a turn as it was measured to."""
    part = Fraction(factor).limit_denominator(10**7)

    def times(value: Fraction) -> Fraction:
        return Fraction(round(value * part * 10**8), 10**8)

    match transmission:
        case Leadscrew():
            return replace(transmission, lead=times(transmission.lead))
        case Belt() | Rack():
            return replace(transmission, pitch=times(transmission.pitch))
        case Direct():
            return replace(transmission, ratio=Fraction(round(transmission.ratio / part * 10**8), 10**8))
        case _:
            return replace(transmission, per_turn=times(transmission.per_turn))  # type: ignore[type-var]
