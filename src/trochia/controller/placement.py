"""Whether an axis' switches stand where homing and stopping need them.

In: an axis as the machine file describes it.  Out: what is wrong, in words; nothing where all is well.  The rules:

1. no switch trips inside the travel that programs may use, but the one an axis is homed to at its end;
2. from full speed, the axis comes to rest after its limit switch within the room behind it: the switch stands so far
   before the mechanical end; what room there is, the file does not say, so the braking distance is told;
3. on the search for home the home switch trips before the limit switch on that side, and the axis can brake from the
   search's speed between the two, and find the index where it is homed to one; otherwise the limit wins and home is
   never found.

Legend: v speed, a acceleration, j jerk; braking distance v²/2a + v a/2j.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from trochia.machine.axes import Axis

FURTHER = 1.1  #: of a turn, or of the travel, is searched
SEARCH = 0.2  #: of the axis' velocity, where the file says nothing of the search's speed


def braking_distance(axis: Axis, speed: float) -> float:
    """Return the way an axis takes to stop from a speed [mm or degree]."""
    ramp = speed * axis.acceleration / (2.0 * axis.jerk) if axis.jerk else 0.0
    return speed * speed / (2.0 * axis.acceleration) + ramp


def placement(axis: Axis, turn: float = 0.0) -> Iterator[str]:
    """Yield what is wrong with the places of an axis' switches; its motor turns once in ``turn`` [mm or degree]."""
    home = axis.home
    at = None
    if home is not None and home.input is not None:
        at = home.position if home.position is not None else (axis.maximum if home.towards == "+" else axis.minimum)
    for side, switch in ((-1.0, axis.limit_minus), (1.0, axis.limit_plus)):
        if switch is None:
            continue
        end = axis.maximum if side > 0.0 else axis.minimum
        own = home is not None and home.method == "limit" and (home.towards == "+") == (side > 0.0)
        if side * (switch.at - end) < 0.0 and not own:
            yield (f"its limit switch {switch.input} trips at {switch.at:g} {axis.unit}, "
                   f"inside the travel that ends at {end:g}")  # fmt: skip
        if home is None or at is None or (home.towards == "+") != (side > 0.0):
            continue
        room = side * (switch.at - at)
        need = braking_distance(axis, home.search or SEARCH * axis.velocity)
        need = max(need, FURTHER * turn) if home.method == "switch-index" else need
        if room <= 0.0:
            yield (f"its home switch at {at:g} {axis.unit} stands behind the limit switch {switch.input} at "
                   f"{switch.at:g}: the limit would stop the search first")  # fmt: skip
        elif room < need:
            why = "brakes in" if need > FURTHER * turn or home.method != "switch-index" else "finds an index in"
            yield (f"from the search's speed it {why} {need:.3g} {axis.unit}, but the limit switch {switch.input} "
                   f"stands {room:.3g} behind home")  # fmt: skip
    rest = axis.home.rest if axis.home is not None else None
    if rest is not None and not axis.minimum <= rest <= axis.maximum:
        yield f"it is to rest at {rest:g} {axis.unit}, outside its travel"
