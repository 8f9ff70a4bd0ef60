"""Windings of two halves: how six and eight leads are wired, and what that makes of a motor's parameters.

In: the parameters of one half.  Out: those of a phase as wired, for the same copper losses.

| wiring     | R    | L   | K   | rated current | torque at it |
|------------|------|-----|-----|---------------|--------------|
| unipolar   | R    | L   | K   | I             | K I          |
| series     | 2 R  | 4 L | 2 K | I/√2          | √2 K I       |
| parallel   | R/2  | L   | K   | √2 I          | √2 K I       |

Unipolar leaves one half idle at a time: 41 % less torque than bipolar for the same heat, but half the transistors.
Series and parallel give the same torque; parallel does with half the voltage, so it keeps it to twice the speed.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from trochia.errors import ConfigError

if TYPE_CHECKING:
    from trochia.machine.motors.hybrid import HybridStepper

#: wiring -> factors of R, L, K and rated current
_FACTORS = {
    "unipolar": (1.0, 1.0, 1.0, 1.0),
    "series": (2.0, 4.0, 2.0, 1.0 / math.sqrt(2.0)),
    "parallel": (0.5, 1.0, 1.0, math.sqrt(2.0)),
}
WIRINGS = tuple(_FACTORS)


def wired(half: HybridStepper, wiring: str | None) -> HybridStepper:
    """Return the motor as wired, from the parameters of one half of each winding; None: they are a whole phase's.

    Raises
    ------
    ConfigError
        For a wiring that is none.
    """
    if wiring is None:
        return half
    if wiring not in _FACTORS:
        raise ConfigError(f"expected one of {', '.join(WIRINGS)}, not {wiring!r}", key="wiring")
    r, inductance, k, current = _FACTORS[wiring]
    return replace(
        half,
        resistance=r * half.resistance,
        inductance=inductance * half.inductance,
        torque_constant=k * half.torque_constant,
        current=current * half.current,
    )
