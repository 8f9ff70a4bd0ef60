"""Heat of a motor and its driver, at rest with the full current or averaged over a move; and whether they carry it.

In: a motor behind its driver.  Out: watts, and problems as text.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from trochia.machine.drivers.fed import Fed


@dataclass(frozen=True, slots=True, kw_only=True)
class Heat:
    """Heat with all current on [W], and what is allowed where it is known.

    Attributes
    ----------
    motor
        Copper losses of both phases.
    rated
        Copper losses of both phases at the rated current, which the catalogue allows for ever.
    driver
        Of the driver, both phases.
    driver_limit
        What the driver gets rid of, or None.
    """

    motor: float
    rated: float
    driver: float
    driver_limit: float | None

    @property
    def motor_part(self) -> float:
        """Part of the motor's rating that is used, 1 all."""
        return self.motor / self.rated

    @property
    def driver_part(self) -> float | None:
        """Part of the driver's rating that is used, 1 all."""
        return None if self.driver_limit is None else self.driver / self.driver_limit

    def problems(self) -> list[str]:
        """Return what is too hot, each with the current (of the one used) that would do."""
        found: list[str] = []
        if self.motor_part > 1 + 1e-9:
            found.append(f"the motor heats with {self.motor:.3g} W, its rated current with {self.rated:.3g} W; "
                         f"{100 / math.sqrt(self.motor_part):.0f} % of the current would do")  # fmt: skip
        part = self.driver_part
        if part is not None and part > 1 + 1e-9:
            found.append(f"the driver heats with {self.driver:.3g} W, it gets rid of {self.driver_limit:.3g} W; "
                         f"{100 / part:.0f} % of the current would do")  # fmt: skip
        return found


def heat(made: Fed, *, current: float | None = None) -> Heat:
    """Return the heat at rest in the worst row of the excitation, or with a given current at level 1 [A].

    In full steps with both phases on, both carry the full current; in fine microsteps the two share its square, so the
    sum of squares over the rows counts.  The rated heat is that of both phases at the rated current.
    """
    amps = made.current if current is None else current
    squares = float((made.excitation.levels**2).sum(axis=1).max())
    driver = max(
        sum(made.driver.loss(abs(level) * amps, abs(level) * amps) for level in row)
        for row in np.abs(made.excitation.levels).tolist()
    )
    own = made.motor.resistance - made.driver.resistance
    return Heat(
        motor=own * amps * amps * squares,
        rated=2 * own * made.motor.current**2,
        driver=driver,
        driver_limit=made.driver.power_limit,
    )
