"""Face of ``core/host/reluctance.h``: one variable reluctance stepper behind unipolar switches, at a fixed step.

In: step pulses as instants and directions.  Out: currents, angle and speed of the shaft, and the row of the table of
phases, sampled.  The state is carried from block to block, so any cut into blocks gives the same samples.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import ConfigError, LimitError
from trochia.kernels.layout import ffi, lib, pointer
from trochia.kernels.pulses import Pulses
from trochia.kernels.stepper import STIFFEST, StepperSamples

if TYPE_CHECKING:
    from numpy.typing import NDArray

MOST_PHASES = 16  #: those of ``trochia_reluctance_state``


@dataclass(frozen=True, slots=True, kw_only=True)
class ReluctanceConstants:
    """The constants of ``trochia_reluctance``, in SI units; inertia and frictions are of rotor and load together."""

    phases: int
    resistance: float
    mean: float
    swing: float
    teeth: int
    shift: float
    supply: float
    against: float
    series: float
    inertia: float
    creep: float
    viscous: float = 0.0
    friction: float = 0.0
    load: float = 0.0

    @property
    def shortest(self) -> float:
        """The fastest time constant [s]: of a phase out of line, or of friction about rest."""
        drag = self.viscous + (self.friction / self.creep if self.friction else 0.0)
        electric = (self.mean - self.swing) / (self.resistance + self.series)
        return min(electric, self.inertia / drag if drag else np.inf)


class ReluctanceKernel:
    """One motor at time zero.

    Parameters
    ----------
    table
        Which phases are on (rows, phases), one electrical turn.
    theta
        Where the rotor stands [rad], at rest and without current.
    step
        Time step [s].

    Raises
    ------
    ConfigError
        When there are more phases than the core has room for, or the time step is too long for the motor.
    """

    def __init__(self, constants: ReluctanceConstants, table: NDArray[np.bool_], *, theta: float, step: float) -> None:
        if not 1 <= constants.phases <= MOST_PHASES:
            raise ConfigError(f"a motor has at most {MOST_PHASES} phases here, not {constants.phases}")
        if table.ndim != 2 or table.shape[1] != constants.phases or not len(table):
            raise ValueError(f"expected phases of shape (rows, {constants.phases}), not {table.shape}")
        if not 0 < step < np.inf:
            raise ConfigError(f"the time step must be above zero, not {step!r} s")
        self.step, self.phases = step, constants.phases
        weights = 1 << np.arange(constants.phases, dtype=np.uint32)
        self._words = (table * weights).sum(axis=1, dtype=np.uint32)
        self._motor = ffi.new("trochia_reluctance *")
        self.set_constants(constants)
        self._state = ffi.new("trochia_reluctance_state *", {"theta": float(theta)})
        self._pulses = Pulses()

    def set_constants(self, constants: ReluctanceConstants) -> None:
        """Change the motor, its switches or its load from here on; the phases stay as many.

        Raises
        ------
        ConfigError
            As the class.
        """
        if constants.phases != self.phases:
            raise ValueError(f"expected {self.phases} phases, not {constants.phases}")
        if not self.step <= STIFFEST * constants.shortest:
            raise ConfigError(
                f"a time step of {self.step * 1e6:g} us is too long for this motor; "
                f"it needs {STIFFEST * constants.shortest * 1e6:.3g} us or less"
            )
        for name in ReluctanceConstants.__slots__:
            setattr(self._motor, name, getattr(constants, name))

    @property
    def now(self) -> float:
        """Time since zero [s]."""
        return self._state.tick * self.step

    def queue(self, times: NDArray[np.float64], directions: NDArray[np.int8]) -> None:
        """Add step pulses [s since zero] (pulses,), each with a direction of 1 or -1 (pulses,), to those to come.

        Raises
        ------
        LimitError
            When they do not rise from the last one queued, or from now.
        """
        self._pulses = self._pulses.followed(times, directions, self.now)

    def run(self, ticks: int, *, every: int = 1) -> StepperSamples:
        """Go on for some time steps and return every ``every``-th sample; states are (samples, phases + 2).

        Raises
        ------
        LimitError
            When the motor's state is no longer a number.
        """
        if ticks < 0 or every < 1:
            raise ValueError(f"expected ticks >= 0 and every >= 1, not {ticks} and {every}")
        state, begin, rows, coming = self._state, self._state.tick, ticks // every, self._pulses
        samples, positions = np.empty((rows, self.phases + 2)), np.empty(rows, np.int64)
        taken = lib.trochia_reluctance_run(
            self._motor, state, pointer(self._words, "const uint32_t *"), len(self._words),
            pointer(coming.times, "const double *"), pointer(coming.signs, "const int8_t *"), len(coming),
            self.step, ticks, every, pointer(samples, "double *"), pointer(positions, "int64_t *"),
        )  # fmt: skip
        self._pulses = coming.behind(taken)
        if not np.isfinite([*state.current, state.theta, state.omega]).all():
            raise LimitError("the motor's state is no longer a number; take a shorter time step")
        time = (begin + every * np.arange(1, rows + 1)) * self.step
        return StepperSamples(time=time, state=samples, position=positions)
