"""One phase of a chopper, switch by switch.

In: the level wanted, the current, what is left of off time and blanking.  Out: the voltage for the next time step.
``core/host/chopper.c`` does the same at a microsecond a step.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from trochia.machine.drivers.chopper import Chopper


@dataclass(frozen=True, slots=True)
class Switch:
    """What is left of the off time and of the blanking of a phase [s]; 0 where it is driven."""

    off: float = 0.0
    blank: float = 0.0


def switch_phase(
    chopper: Chopper, switch: Switch, level: float, current: float, step: float
) -> tuple[float | None, Switch]:
    """Return the voltage across a phase for the next step [V], and its switch then; None: the phase is open.

    Parameters
    ----------
    level
        Wanted current over ``chopper.current``, -1 to 1; at zero the bridge is off and its diodes end the current.
    step
        Time step [s]; off time and blanking end at the nearest one.
    """
    if level == 0:
        return (-math.copysign(chopper.supply, current) if current else None), Switch()
    sign = math.copysign(1.0, level)
    off, blank = switch.off, switch.blank
    if off > 0:
        off -= step
        if off <= step / 2:
            off, blank = 0.0, chopper.blanking
    elif blank > 0:
        blank -= step
    if off == 0 and blank <= step / 2 and current * sign >= abs(level) * chopper.current:
        off, blank = chopper.off_time, 0.0
    after = Switch(off, blank)
    if off == 0:
        return sign * chopper.supply, after
    fast = off > (1 - chopper.fast_part) * chopper.off_time + step / 2
    return (-sign * chopper.supply if fast and current * sign > 0 else 0.0), after


def step_current(
    current: float, voltage: float | None, emf: float, *, resistance: float, inductance: float, step: float
) -> float:
    """Return the current a step on [A]: exact for a constant voltage; diodes do not let a falling one turn round."""
    if voltage is None:
        return 0.0
    left = math.exp(-step * resistance / inductance)
    after = current * left + (voltage - emf) * (1 - left) / resistance
    return 0.0 if voltage * current < 0 and after * current < 0 else after
