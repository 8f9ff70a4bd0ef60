"""How a board that drives windings itself is told to excite them: bits 2 … 7 of its outputs (``firmware/avr/coils.h``).

In: the machine's joints, or a way of excitation for each motor.  Out: bits.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.errors import ConfigError
from trochia.machine.joints import Stepper

if TYPE_CHECKING:
    from collections.abc import Sequence

    from trochia.machine.machine import Machine

MASK = 0xFC
#: excitation -> its number
NUMBERS = {"one-phase": 0, "two-phase": 1, "half-step": 2, "microstep-table": 3, "microstep-16": 3}
_BY_MICROSTEPS = {1: "two-phase", 2: "half-step"}


def bits(excitations: Sequence[int | None]) -> int:
    """Return the bits for the excitation of each of two motors; None: it is released."""
    value = 0
    for motor, number in enumerate(excitations):
        value |= 1 << 6 + motor if number is None else number << 2 + 2 * motor
    return value


def windings(machine: Machine) -> int:
    """Return the bits for a machine's joints; a motor that no joint has is released.

    Raises
    ------
    ConfigError
        For an excitation that the board has not.
    """
    numbers: list[int | None] = [None, None]
    for i, joint in enumerate(machine.joints[:2]):
        motor = joint.motor
        per_step = motor.microsteps if isinstance(motor, Stepper) else 1
        name = getattr(joint.driver, "excitation", None) or _BY_MICROSTEPS.get(per_step, f"microstep-{per_step}")
        if name not in NUMBERS:
            raise ConfigError(
                f"the board cannot excite by {name}",
                key=f"joints.{joint.name}.driver.excitation",
                hint=f"It can by {', '.join(NUMBERS)}.",
            )
        numbers[i] = NUMBERS[name]
    return bits(numbers)
