"""An excitation as a table to read: what every step switches on, where the field stands, what the shield's latch gets.

In: a mode, and a direction; or a mode and a number of phases, for motors whose phases are only on or off.  Out: rows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import ConfigError
from trochia.pulses.chain import phase_table
from trochia.pulses.excitation import excitation
from trochia.pulses.latch import latch_byte

if TYPE_CHECKING:
    from numpy.typing import NDArray

SECTOR = math.radians(45)  #: eight to an electrical turn: A+, A+B+, B+, B+A-, A-, A-B-, B-, B-A+
LETTERS = "ABCDEFGHIJKLMNOP"


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """One row of an excitation.

    Attributes
    ----------
    number
        From 1.
    levels
        Of the phases, of rated current or supply, -1 to 1; 0 and 1 where they are only on or off.
    angle
        Of the field [electrical rad], 0 to below 2π.
    length
        Of the field: what it holds, in K I of one phase.
    """

    number: int
    levels: tuple[float, ...]
    angle: float
    length: float

    @property
    def sector(self) -> int:
        """Which eighth of the electrical turn the field is in, 0 to 7."""
        return int((self.angle + 1e-9) / SECTOR) % 8

    @property
    def terminals(self) -> str:
        """What is on, by its terminal: ``A+ B-``, or ``A B`` where phases are only on or off."""
        signs = ("-", "", "+") if len(self.levels) == 2 else ("", "", "")
        return " ".join(LETTERS[k] + signs[int(np.sign(level)) + 1] for k, level in enumerate(self.levels) if level)

    @property
    def duty(self) -> tuple[int, ...]:
        """Of the bridges' enables, 0 to 255."""
        return tuple(round(255 * abs(level)) for level in self.levels)

    def latch(self, motor: int, image: int = 0) -> int:
        """Return the byte of the motor shield's register for one of its two motors; errors as ``latch_byte``."""
        return latch_byte(self.levels, motor, image)


def steps_of(mode: str, *, phases: int = 2, direction: int = 1) -> list[Step]:
    """Return one electrical turn of a mode in a direction, 1 or -1, from its first row.

    Two phases are those of a bipolar motor, positive and negative; three and more are on or off, as of a ring counter.

    Raises
    ------
    ConfigError
        For a mode that is none, or phases that cannot be.
    """
    if phases < 2 or phases > len(LETTERS):
        raise ConfigError(f"between 2 and {len(LETTERS)} phases can be excited, not {phases}")
    if phases == 2:
        levels: NDArray[np.float64] = excitation(mode).levels
        field = levels @ np.array([1.0, 1.0j])
    else:
        levels = phase_table(mode, phases).astype(np.float64)
        field = levels @ np.exp(2j * math.pi / phases * np.arange(phases))
    order = direction * np.arange(len(levels)) % len(levels)
    angles = np.angle(field) % math.tau
    return [
        Step(number=n + 1, levels=tuple(levels[k].tolist()), angle=float(angles[k]), length=float(abs(field[k])))
        for n, k in enumerate(order.tolist())
    ]
