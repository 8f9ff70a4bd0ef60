"""What is corrected of a machine, and what that leaves of its limits.  In: a Machine.  Out: a table, plain data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from trochia.machine.compensation import PAIRS
from trochia.machine.crossing import crossing_of
from trochia.machine.reserve import shares, take_up_time

if TYPE_CHECKING:
    from trochia.machine.machine import Machine


def corrections(machine: Machine) -> dict[str, Any] | None:
    """Return what is corrected; None where nothing is."""
    crossing = crossing_of(machine)
    if crossing is None:
        return None
    joints: list[dict[str, Any]] = []
    for j, (joint, left) in enumerate(zip(machine.joints, shares(machine, crossing.mix), strict=True)):
        given = joint.compensation
        screw = None if given is None else given.screw
        joints.append({
            "name": joint.name, "backlash": 0.0 if given is None else given.backlash,
            "made_up_s": take_up_time(machine, j) if crossing.backlash[j] else 0.0,
            "points": 0 if screw is None else len(screw.points),
            "greatest_error": 0.0 if screw is None else max(abs(error) for _, error in screw.points),
            "left": left._asdict(),
        })  # fmt: skip
    skew = machine.squareness
    return {"joints": joints, "squareness_deg": {} if skew is None else {pair: getattr(skew, pair) for pair in PAIRS}}


def rows(machine: Machine) -> list[list[str]]:
    """Return the same as rows of a table, titles first; none where nothing is corrected."""
    found = corrections(machine)
    if found is None:
        return []
    lines = [["corrected", "backlash", "made up in", "screw", "velocity left", "acceleration left", "jerk left"]]
    lines += [_row(each) for each in found["joints"]]
    lines += [[pair, f"{90 + angle:.6g} deg", "", "", "", "", ""]
              for pair, angle in found["squareness_deg"].items() if angle]  # fmt: skip
    return lines


def _row(each: dict[str, Any]) -> list[str]:
    lost, points = each["backlash"], each["points"]
    return [
        f"joint {each['name']}", f"{lost:.6g}" if lost else "-", f"{1000 * each['made_up_s']:.0f} ms" if lost else "-",
        f"{points} points, {each['greatest_error']:.4g}" if points else "-",
        *(f"{100 * part:.1f} %" for part in each["left"].values()),
    ]  # fmt: skip
