"""Excitation of two-phase steppers: which level each phase has at each step.

In: a mode.  Out: a table of levels, parts of the rated current or of the supply voltage between -1 and 1, one row a
step, through one electrical turn (four full steps).  Forward through the table is A+ B+ A- B-: clockwise, the positive
sense; backwards is A+ B- A- B+.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import ConfigError

if TYPE_CHECKING:
    from numpy.typing import NDArray

FINEST = 256  #: microsteps a full step


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Excitation:
    """One electrical turn of phase levels (steps, 2), read-only."""

    name: str
    levels: NDArray[np.float64]

    def __post_init__(self) -> None:
        self.levels.flags.writeable = False

    @property
    def steps_per_full_step(self) -> int:
        """Steps of the table for one full step."""
        return len(self.levels) // 4

    @property
    def step_angle(self) -> float:
        """What a step turns the field by [electrical rad]."""
        return math.tau / len(self.levels)

    @property
    def first_angle(self) -> float:
        """Where the field stands in the first row [electrical rad]."""
        return math.atan2(self.levels[0, 1], self.levels[0, 0])

    @property
    def peak(self) -> float:
        """Greatest length of the field vector: √2 with both phases full on, 1 for one phase and for microsteps."""
        return float(np.hypot(*self.levels.T).max())

    @property
    def fundamental(self) -> float:
        """Amplitude of the fundamental of a phase's level at constant rate, each row held for one step.

        4/π for both phases on, 2√2/π for one, near 1 for fine microsteps (Fourier's sum times the hold's sin(x)/x).
        """
        n = len(self.levels)
        turn = np.exp(-1j * math.tau * np.arange(n) / n)
        return float(abs(turn @ self.levels[:, 0]) * 2 / n * np.sinc(1 / n))

    def sequence(self, steps: int, start: int = 0) -> NDArray[np.float64]:
        """Return the levels after each step (steps, 2) from row ``start`` on; ``steps`` below zero goes backwards."""
        indices = start + np.sign(steps) * np.arange(1, abs(steps) + 1)
        return self.levels[indices % len(self.levels)]


def one_phase() -> Excitation:
    """Return full steps with one phase on: the least power."""
    return Excitation(name="one-phase", levels=np.array([[1, 0], [0, 1], [-1, 0], [0, -1]], np.float64))


def two_phase() -> Excitation:
    """Return full steps with both phases on: √2 of the torque for twice the power."""
    return Excitation(name="two-phase", levels=np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]], np.float64))


def half_step() -> Excitation:
    """Return half steps: one phase and both in turn, at full level, so the torque goes up and down by √2."""
    turn = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1]]
    return Excitation(name="half-step", levels=np.array(turn, np.float64))


def microstep(divisions: int) -> Excitation:
    """Return microsteps with sinusoidal levels, 2 to 256 to a full step: the field keeps its length.

    Raises
    ------
    ConfigError
        For another number of divisions.
    """
    if not 2 <= divisions <= FINEST:
        raise ConfigError(f"microsteps a full step must be 2 to {FINEST}, not {divisions}")
    quarter = np.sin(np.arange(divisions + 1) * (math.pi / 2 / divisions))
    return Excitation(name=f"microstep-{divisions}", levels=_turn(quarter))


def table_microstep() -> Excitation:
    """Return 16 microsteps by the motor shield's table: 17 duty values of 8 bits, 255 sin(k·90°/16) rounded."""
    duty = np.rint(255 * np.sin(np.arange(17) * (math.pi / 32)))
    return Excitation(name="microstep-table", levels=_turn(duty / 255))


def _turn(quarter: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a whole turn from a quarter of a sine, both ends included."""
    rise, fall = quarter[:-1], quarter[:0:-1]
    sine = np.concatenate([rise, fall, -rise, -fall])
    return np.stack([np.roll(sine, -len(rise)), sine], axis=1)


EXCITATIONS = {mode.name: mode for mode in (one_phase(), two_phase(), half_step(), table_microstep())}


def excitation(name: str) -> Excitation:
    """Return the mode of a name: one of EXCITATIONS, or ``microstep-N``.

    Raises
    ------
    ConfigError
        For a name that is none.
    """
    if name in EXCITATIONS:
        return EXCITATIONS[name]
    if match := re.fullmatch(r"microstep-(\d{1,3})", name):
        return microstep(int(match[1]))
    raise ConfigError(f"no excitation is called {name!r}; known are {', '.join(EXCITATIONS)}, microstep-2 … {FINEST}")
