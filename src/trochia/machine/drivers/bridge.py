"""The H bridge: four transistors and four diodes about one phase.

In: the inputs of its two halves and the enable.  Out: what the outputs do, the voltage across the phase, and whether a
change of direction shorts the supply.

    supply ─┬─ T1 ─┬─ T3 ─┐       T1 and T4 on: the phase is driven forwards
            │      A      B       T2 and T3 on: backwards
    ground ─┴─ T2 ─┴─ T4 ─┘       T2 and T4 on, or T1 and T3: shorted.  All off: open; the diodes carry what still flows
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import LimitError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

L293D_DROPS = (1.4, 1.2)  #: saturation voltages of the upper and the lower transistor, typical; up to 1.8 V each [V]
KNEE = 0.03  #: current at which a bridge's drop is 1/√2 of it, part of what a phase draws at rest


class Output(Enum):
    """What one half of a bridge does."""

    HIGH = "high"
    LOW = "low"
    OPEN = "open"


def half_bridge(level: bool, enable: bool) -> Output:  # noqa: FBT001 - two pins of a truth table
    """Return the output of a half for its input and its enable: it follows the input; without it, open."""
    if not enable:
        return Output.OPEN
    return Output.HIGH if level else Output.LOW


def bridge_voltage(a: Output, b: Output, supply: float, drops: tuple[float, float] = (0.0, 0.0)) -> float | None:
    """Return the voltage that a bridge puts across its phase, A less B [V]; None: the phase is open.

    A phase with both outputs on one side is shorted: a rotor that turns is braked by it.  ``drops`` are those of the
    upper and the lower transistor while current flows as driven; :func:`phase_voltage` has them in every state.
    """
    if Output.OPEN in {a, b}:
        return None
    if a is b:
        return 0.0
    driven = supply - sum(drops)
    return driven if a is Output.HIGH else -driven


def phase_voltage(level: Array, current: Array, *, supply: float, drop: float, knee: float) -> Array:
    """Return the voltage across a phase (...) [V] that a bridge of bipolar transistors is to put to a level, -1 to 1.

    Whatever the bridge does, two junctions lie in the current's way, and their drop is against it.  An L293D at 0.6 A:

    - driven with the current, two transistors: supply - 2.6 V
    - level 0, both outputs low, the current goes round through a transistor and a diode: -2.5 V.  Below that voltage
      back-EMF drives nothing: an idle phase brakes a fast rotor and lets a slow one go
    - driven against the current still flowing, two diodes into the supply: -(supply + 2.6 V)

    So one drop stands for all three.  It is smoothed over the current ``knee`` [A], for diodes turn round smoothly.
    """
    return level * supply - drop * current / np.hypot(current, knee)


@dataclass(frozen=True, slots=True, kw_only=True)
class Bridge:
    """How fast the transistors of a bridge switch, and the pause the driver leaves between two of one leg [s]."""

    turn_on: float
    turn_off: float
    dead_time: float


def shoot_through(bridge: Bridge) -> float:
    """Return how long both transistors of a leg conduct at a change of direction [s]; 0 where they never do.

    The one begins to conduct ``dead_time + turn_on`` after the change, the other has stopped ``turn_off`` after it.
    """
    return max(0.0, bridge.turn_off - bridge.turn_on - bridge.dead_time)


def check_dead_time(bridge: Bridge) -> None:
    """Refuse a bridge that shorts its supply.

    Raises
    ------
    LimitError
        Naming how long both conduct, and the dead time that would do.
    """
    both = shoot_through(bridge)
    if both > 0:
        raise LimitError(
            f"both transistors of a leg conduct for {both * 1e9:.4g} ns at each change: the one turns off in "
            f"{bridge.turn_off * 1e9:.4g} ns, the other is on after {(bridge.dead_time + bridge.turn_on) * 1e9:.4g} ns",
            hint=f"A dead time of {(bridge.turn_off - bridge.turn_on) * 1e9:.4g} ns or more would do.",
        )
