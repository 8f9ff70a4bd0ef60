"""Face of ``core/host/stepper.h``: one stepper behind any driver, on average or switch by switch.

In: step pulses as instants and directions.  Out: currents, angle and speed of the shaft, angle of the load, and the row
of the table of levels, sampled.  The state is carried from block to block and can be put back.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.errors import ConfigError, LimitError
from trochia.kernels.layout import ffi, lib, pointer
from trochia.kernels.pulses import Pulses

if TYPE_CHECKING:
    from numpy.typing import NDArray

COLUMNS = 5  #: currents, angle, speed, angle of the load
STIFFEST = 0.5  #: greatest time step, in parts of the fastest time constant; above, Runge-Kutta's fourth order is lost


class Mode(IntEnum):
    """What the phases are fed with."""

    VOLTAGE = 0
    MEAN = 1
    OPEN = 2
    BRIDGE = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class StepperConstants:
    """The constants of ``trochia_stepper``, in SI units; with those of a load that is rigidly on the shaft."""

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
class DriverConstants:
    """The constants of ``trochia_driver``, in SI units."""

    supply: float
    drop: float = 0.0
    knee: float = 1.0
    current: float = 0.0
    lowest: float = 0.0
    fast: float = 0.0
    off_time: float = 0.0
    blanking: float = 0.0
    lag: float = 1.0
    scale: float = 1.0
    hold: float = 1.0
    hold_delay: float = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class CouplingConstants:
    """The constants of ``trochia_coupling``, in SI units; without stiffness there is none."""

    stiffness: float = 0.0
    damping: float = 0.0
    inertia: float = 1.0
    viscous: float = 0.0
    friction: float = 0.0
    load: float = 0.0


NO_COUPLING = CouplingConstants()


@dataclass(frozen=True, slots=True, kw_only=True)
class StepperSamples:
    """What the motor did: times [s] (samples,), states (samples, 5) and rows of the table of levels (samples,)."""

    time: NDArray[np.float64]
    state: NDArray[np.float64]
    position: NDArray[np.int64]


def longest_step(motor: StepperConstants, coupling: CouplingConstants = NO_COUPLING) -> float:
    """Return the longest time step that a motor and its load stand [s]: dry friction on a light rotor is stiff."""
    drag = motor.viscous + (motor.friction / motor.creep if motor.friction else 0.0)
    fastest = [motor.inductance / motor.resistance, motor.inertia / drag if drag else np.inf]
    if coupling.stiffness > 0:
        behind = coupling.viscous + (coupling.friction / motor.creep if coupling.friction else 0.0)
        least = min(motor.inertia, coupling.inertia)
        fastest += [coupling.inertia / behind if behind else np.inf, np.sqrt(least / coupling.stiffness),
                    least / coupling.damping if coupling.damping else np.inf]  # fmt: skip
    return STIFFEST * float(min(fastest))


class StepperKernel:
    """One motor at time zero.

    Parameters
    ----------
    levels
        Table of levels (rows, 2), one electrical turn.
    state
        Currents [A], angle [rad], speed [rad/s] (4,); the load stands where the rotor does.
    step
        Tick of the averaged model [s].
    sub
        Steps of the switching model in a tick.
    position
        Row of the table it begins with.

    Raises
    ------
    ConfigError
        When the tick is too long for the motor's fastest time constant.
    """

    def __init__(
        self,
        motor: StepperConstants,
        driver: DriverConstants,
        levels: NDArray[np.float64],
        state: NDArray[np.float64],
        *,
        step: float,
        coupling: CouplingConstants = NO_COUPLING,
        sub: int = 20,
        position: int = 0,
    ) -> None:
        if levels.ndim != 2 or levels.shape[1] != 2 or not len(levels) or not np.isfinite(levels).all():
            raise ValueError(f"expected finite levels of shape (rows, 2), not {levels.shape}")
        if not 0 < step < np.inf or sub < 1:
            raise ConfigError(f"the time step must be above zero, not {step!r} s in {sub}")
        self.step, self.sub, self.mode = step, sub, Mode.VOLTAGE
        self._levels = np.ascontiguousarray(levels, np.float64)
        self._motor, self._driver = ffi.new("trochia_stepper *"), ffi.new("trochia_driver *")
        self._coupling = ffi.new("trochia_coupling *")
        self.set_motor(motor, coupling)
        self.set_driver(driver)
        a, b, theta, omega = map(float, state)
        self._state = ffi.new("trochia_stepper_state *", {
            "current_a": a, "current_b": b, "theta": theta, "omega": omega, "load_theta": theta, "load_omega": omega,
            "position": position,
        })  # fmt: skip
        self._pulses = Pulses()

    def set_motor(self, motor: StepperConstants, coupling: CouplingConstants = NO_COUPLING) -> None:
        """Change the motor or its load from here on; ConfigError as the class."""
        longest = longest_step(motor, coupling)
        if not self.step <= longest:
            raise ConfigError(
                f"a time step of {self.step * 1e6:g} us is too long for this motor and load; "
                f"it needs {longest * 1e6:.3g} us or less"
            )
        _fill(self._motor, motor)
        _fill(self._coupling, coupling)

    def set_levels(self, levels: NDArray[np.float64]) -> None:
        """Change the table of levels (rows, 2) from here on, with as many rows as before."""
        if levels.shape != self._levels.shape or not np.isfinite(levels).all():
            raise ValueError(f"expected finite levels of shape {self._levels.shape}, not {levels.shape}")
        self._levels = np.ascontiguousarray(levels, np.float64)

    def set_driver(self, driver: DriverConstants) -> None:
        """Change the driver from here on."""
        _fill(self._driver, driver)

    @property
    def now(self) -> float:
        """Time since zero [s]."""
        return self._state.tick * self.step

    def save(self) -> Any:  # noqa: ANN401 - opaque: only for restore
        """Return the state and the queued pulses, for :meth:`restore`."""
        return ffi.new("trochia_stepper_state *", self._state[0]), self._pulses

    def restore(self, saved: Any) -> None:  # noqa: ANN401 - what save returned
        """Go back to a state that was saved."""
        state, self._pulses = saved
        self._state[0] = state[0]

    def queue(self, times: NDArray[np.float64], directions: NDArray[np.int8]) -> None:
        """Add step pulses [s since zero] (pulses,) with directions 1 or -1 (pulses,) to those to come.

        Raises
        ------
        LimitError
            When they do not rise from the last one queued, or from now.
        """
        self._pulses = self._pulses.followed(times, directions, self.now)

    def run(self, ticks: int, *, every: int = 1, switching: bool = False) -> StepperSamples:
        """Go on for some ticks, with the queued pulses in them, and return every ``every``-th sample (samples, 5).

        Parameters
        ----------
        switching
            Switch by switch, for a chopper that drives.

        Raises
        ------
        LimitError
            When the motor's state is no longer a number.
        """
        if ticks < 0 or every < 1:
            raise ValueError(f"expected ticks >= 0 and every >= 1, not {ticks} and {every}")
        state, begin, rows, coming = self._state, self._state.tick, ticks // every, self._pulses
        samples, positions = np.empty((rows, COLUMNS)), np.empty(rows, np.int64)
        keep = ffi.new("trochia_stepper_input *", {
            "levels": pointer(self._levels, "const double *"), "rows": len(self._levels),
            "times": pointer(coming.times, "const double *"), "directions": pointer(coming.signs, "const int8_t *"),
            "pulses": len(coming),
        })  # fmt: skip
        out = (pointer(samples, "double *"), pointer(positions, "int64_t *"))
        parts = (self._motor, self._driver, self._coupling)
        if switching and self.mode is Mode.MEAN:
            taken = lib.trochia_chopper_run(*parts, state, keep, self.step, self.sub, ticks, every, *out)
        else:
            taken = lib.trochia_stepper_run(*parts, int(self.mode), state, keep, self.step, ticks, every, *out)
        self._pulses = coming.behind(taken)
        if not np.isfinite([state.current_a, state.current_b, state.theta, state.omega, state.load_theta]).all():
            raise LimitError("the motor's state is no longer a number; take a shorter time step")
        time = (begin + every * np.arange(1, rows + 1)) * self.step
        return StepperSamples(time=time, state=samples, position=positions)


def _fill(struct: Any, constants: Any) -> None:  # noqa: ANN401 - a C struct and its dataclass
    """Copy the fields of a dataclass into the C struct of the same names."""
    for name in type(constants).__slots__:
        setattr(struct, name, getattr(constants, name))
