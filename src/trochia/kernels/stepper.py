"""Face of ``core/host/stepper.h``: one two-phase stepper under voltage drive, integrated at a fixed step.

In: step pulses as instants and directions.  Out: currents, angle and speed of the shaft, and the row of the voltage
table, sampled.  The state is carried from block to block, so any cut into blocks gives the same samples.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import ConfigError, LimitError
from trochia.kernels.layout import ffi, lib, pointer

if TYPE_CHECKING:
    from numpy.typing import NDArray

STIFFEST = 0.5  #: greatest time step, in parts of the fastest time constant; above, Runge-Kutta's fourth order is lost


@dataclass(frozen=True, slots=True, kw_only=True)
class StepperConstants:
    """The constants of ``trochia_stepper``, in SI units; inertia and frictions are those of rotor and load together."""

    resistance: float
    inductance: float
    torque_constant: float
    teeth: int
    inertia: float
    creep: float
    detent: float = 0.0
    viscous: float = 0.0
    friction: float = 0.0
    load: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class StepperSamples:
    """What the motor did: times [s] (samples,), states (samples, 4) and rows of the voltage table (samples,)."""

    time: NDArray[np.float64]
    state: NDArray[np.float64]
    position: NDArray[np.int64]


class StepperKernel:
    """One motor at time zero.

    Parameters
    ----------
    voltages
        Table of phase voltages [V] (rows, 2), one electrical turn.
    state
        Currents [A], angle [rad], speed [rad/s] (4,).
    position
        Row of the table it begins with.
    step
        Time step [s].

    Raises
    ------
    ConfigError
        When the time step is too long for the motor's fastest time constant.
    """

    def __init__(
        self,
        constants: StepperConstants,
        voltages: NDArray[np.float64],
        state: NDArray[np.float64],
        *,
        step: float,
        position: int = 0,
    ) -> None:
        if voltages.ndim != 2 or voltages.shape[1] != 2 or not len(voltages) or not np.isfinite(voltages).all():
            raise ValueError(f"expected finite voltages of shape (rows, 2), not {voltages.shape}")
        if not 0 < step < np.inf:
            raise ConfigError(f"the time step must be above zero, not {step!r} s")
        self.step = step
        self._voltages = np.ascontiguousarray(voltages, np.float64)
        self._motor = ffi.new("trochia_stepper *")
        self.set_constants(constants)
        self._state = ffi.new("trochia_stepper_state *", [*map(float, state), 0, position])
        self._times, self._signs = np.empty(0), np.empty(0, np.int8)

    def set_constants(self, constants: StepperConstants) -> None:
        """Change the motor or its load from here on.

        Raises
        ------
        ConfigError
            As the class.
        """
        c = constants
        drag = c.viscous + (c.friction / c.creep if c.friction else 0.0)
        shortest = min(c.inductance / c.resistance, c.inertia / drag if drag else np.inf)
        if not self.step <= STIFFEST * shortest:
            raise ConfigError(
                f"a time step of {self.step * 1e6:g} us is too long for this motor; "
                f"it needs {STIFFEST * shortest * 1e6:.3g} us or less"
            )
        for name in StepperConstants.__slots__:
            setattr(self._motor, name, getattr(c, name))

    @property
    def now(self) -> float:
        """Time since zero [s]."""
        return self._state.tick * self.step

    def queue(self, times: NDArray[np.float64], directions: NDArray[np.int8]) -> None:
        """Add step pulses to those to come.

        Parameters
        ----------
        times
            Instants [s since zero] (pulses,), rising, none before now nor before the last one queued.
        directions
            1 or -1 for each (pulses,).

        Raises
        ------
        LimitError
            When pulses are out of order.
        """
        times, signs = np.asarray(times, np.float64), np.asarray(directions, np.int8)
        if times.ndim != 1 or times.shape != signs.shape or not (np.abs(signs) == 1).all():
            raise ValueError("expected instants (pulses,) with a direction of 1 or -1 for each")
        first = float(self._times[-1]) if len(self._times) else self.now
        if len(times) and not (first <= times[0] and times[-1] < np.inf and (np.diff(times) >= 0).all()):
            raise LimitError(f"step pulses must rise from {first:g} s on")
        self._times = np.concatenate([self._times, times])
        self._signs = np.concatenate([self._signs, signs])

    def run(self, ticks: int, *, every: int = 1) -> StepperSamples:
        """Go on for some time steps, with the queued pulses that fall into them, and return every ``every``-th sample.

        Raises
        ------
        LimitError
            When the motor's state is no longer a number.
        """
        if ticks < 0 or every < 1:
            raise ValueError(f"expected ticks >= 0 and every >= 1, not {ticks} and {every}")
        state, begin, rows = self._state, self._state.tick, ticks // every
        samples, positions = np.empty((rows, 4)), np.empty(rows, np.int64)
        taken = lib.trochia_stepper_run(
            self._motor, state, pointer(self._voltages, "const double *"), len(self._voltages),
            pointer(self._times, "const double *"), pointer(self._signs, "const int8_t *"), len(self._times),
            self.step, ticks, every, pointer(samples, "double *"), pointer(positions, "int64_t *"),
        )  # fmt: skip
        self._times, self._signs = self._times[taken:], self._signs[taken:]
        if not np.isfinite([state.current_a, state.current_b, state.theta, state.omega]).all():
            raise LimitError("the motor's state is no longer a number; take a shorter time step")
        time = (begin + every * np.arange(1, rows + 1)) * self.step
        return StepperSamples(time=time, state=samples, position=positions)
