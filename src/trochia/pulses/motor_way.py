"""Where motors are told to be along a motion, as its machine's errors are corrected.

In: a motion of the axes, a machine.  Out: places of its joints' motors at rising times.  Reversals are looked for on a
grid of the machine's servo period, so that whoever asks finds the same.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np

from trochia.machine.crossing import crossing_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.machine import Machine

BACK = 1.0  #: how far behind the latest time somebody may still ask [s]
BLOCK = 65_536  #: places of the grid at a time


@runtime_checkable
class Placed(Protocol):
    """What is asked of a motion; ``t`` is (samples,) within 0 and ``duration`` [s]."""

    @property
    def duration(self) -> float:
        """Length of the motion [s]."""
        ...

    def position(self, t: NDArray[np.float64], /) -> NDArray[np.float64]:
        """Return positions of the axes (samples, axes)."""
        ...


class MotorWay:
    """Motors along one motion."""

    def __init__(self, machine: Machine, motion: Placed) -> None:
        self._motion = motion
        self._matrix = machine.kinematics.matrix
        self._tick = machine.servo_period
        self._crossing = crossing_of(machine)
        self._take_up = None if self._crossing is None else self._crossing.take_up()
        self._seen = 0  # places of the grid at which reversals were looked for

    def at(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return where motors are told to be (samples, joints); times rise, and are not far behind those before."""
        asked = self._motion.position(np.clip(t, 0.0, self._motion.duration)) @ self._matrix.T
        if self._crossing is None or self._take_up is None:
            return asked
        told = self._crossing.motor(asked)
        if self._crossing.backlash.any() and t.size:
            self._see(float(t[-1]))
            told += self._take_up.offset(t)
            self._take_up.forget(float(t[0]) - BACK)
        return told

    def _see(self, until: float) -> None:
        """Look for reversals up to a time."""
        assert self._crossing is not None
        assert self._take_up is not None
        last = int(np.ceil(until / self._tick)) + 2
        while self._seen < last:
            count = min(last - self._seen, BLOCK)
            grid = self._tick * np.arange(self._seen - 1, self._seen + count + 1, dtype=np.float64)
            places = self._motion.position(np.clip(grid, 0.0, self._motion.duration)) @ self._matrix.T
            speed = np.diff(places @ self._crossing.mix.T, axis=0) / self._tick
            self._take_up.see(grid[1:] - 0.5 * self._tick, speed)
            self._seen += count
