"""The twin of one stepper behind its driver, in two levels: currents on average, and every switching where it matters.

In: step pulses.  Out: what the rotor did, and how many steps it lost.

A chopper is followed on average, at 20 us a tick.  Where the load angle comes near to what the motor can hold, the
stretch is done again switch by switch, at 1 us, from the very state before it: there the shape of the current decides
whether steps are lost.  A voltage drive has nothing to switch.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.backends.stepper_twin import STEP, StepperRun
from trochia.errors import ConfigError
from trochia.kernels.drive import CouplingConstants, DriveKernel, DriverConstants, Mode
from trochia.kernels.stepper import StepperConstants
from trochia.machine.motors.hybrid import FREE
from trochia.machine.motors.shaft import CREEP

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.kernels.stepper import StepperSamples
    from trochia.machine.drivers import Fed
    from trochia.machine.motors import HybridStepper, ShaftLoad
    from trochia.machine.motors.coupled import Coupling

SWITCH = 1e-6  #: time step of a chopper's switching [s]
WINDOW = 5e-3  #: length of a stretch that is done again [s]
SHARP = math.radians(60)  #: load angle above which it is: there 87 % of the torque is used


@dataclass(frozen=True, slots=True, kw_only=True)
class Levels:
    """When the switching model is used.

    Attributes
    ----------
    threshold
        Load angle [electrical rad] above which a stretch is done switch by switch; 0: always, infinite: never.
    window
        Length of a stretch [s].
    """

    threshold: float = SHARP
    window: float = WINDOW


class DrivenStepper:
    """A motor behind its driver, at rest, aligned with the excitation's first row and without current, at time zero.

    Parameters
    ----------
    load
        On the shaft, or behind the coupling where there is one.
    tick
        Of the averaged model [s]; the switching model takes some 1 us.
    angle
        Where the rotor stands at power-up [electrical rad from the first row]; the phases pull it to the nearest stable
        point, up to two full steps away.
    enabled
        Whether the phases are on.

    Raises
    ------
    ConfigError
        When the tick is too long for motor and load.
    """

    def __init__(
        self,
        made: Fed,
        load: ShaftLoad = FREE,
        *,
        coupling: Coupling | None = None,
        levels: Levels = Levels(),
        tick: float = STEP,
        angle: float = 0.0,
        enabled: bool = True,
    ) -> None:
        self.made, self.levels, self._coupling = made, levels, coupling
        if coupling is not None and not load.inertia > 0:
            raise ConfigError("a load behind a coupling needs an inertia above zero", key="load.inertia")
        aligned = np.array([0.0, 0.0, (made.excitation.first_angle + angle) / made.motor.teeth, 0.0])
        self._kernel = DriveKernel(
            _motor(made.motor, load, coupling), _driver(made, tick), _behind(load, coupling), made.excitation.levels,
            aligned, step=tick, sub=max(1, round(tick / SWITCH)),
        )  # fmt: skip
        self.set_enabled(enabled)
        self.switched = 0.0  #: time that was done switch by switch [s]

    @property
    def now(self) -> float:
        """Time since zero [s]."""
        return self._kernel.now

    def set_load(self, load: ShaftLoad) -> None:
        """Change the load from here on."""
        self._kernel.set_motor(_motor(self.made.motor, load, self._coupling), _behind(load, self._coupling))

    def set_enabled(self, enabled: bool) -> None:  # noqa: FBT001 - the one switch
        """Switch the phases on, or release them: held, shorted or open, as the driver does."""
        on = enabled or self.made.driver.released == "hold"
        driven = Mode.VOLTAGE if self.made.chopper is None else Mode.MEAN
        short = not on and self.made.driver.released == "short"
        self._kernel.set_driver(_driver(self.made, self._kernel.step, scale=0.0 if short else 1.0))
        self._kernel.mode = driven if on else Mode.VOLTAGE if short else Mode.OPEN

    def queue(self, times: NDArray[np.float64], direction: int | NDArray[np.int8] = 1) -> None:
        """Add step pulses [s since zero] (pulses,) to those to come, in one direction or each in its own (pulses,).

        Raises
        ------
        LimitError
            When they do not rise from the last one queued, or from now.
        """
        self._kernel.queue(times, np.broadcast_to(np.asarray(direction, np.int8), np.shape(times)))

    def run(self, duration: float, *, every: int = 1) -> StepperRun:
        """Go on for a duration [s], rounded to whole ticks, and return every ``every``-th sample."""
        return self.run_ticks(round(duration / self._kernel.step), every=every)

    def run_ticks(self, ticks: int, *, every: int = 1) -> StepperRun:
        """Go on for some ticks and return every ``every``-th sample."""
        kernel, levels = self._kernel, self.levels
        if kernel.mode is not Mode.MEAN or levels.threshold == math.inf:
            return self._told([kernel.run(ticks, every=every)])
        stretch = max(1, round(levels.window / kernel.step / every)) * every
        done: list[StepperSamples] = []
        sharp = levels.threshold <= 0
        for first in range(0, ticks, stretch):
            n = min(stretch, ticks - first)
            if not sharp:
                before = kernel.save()
                done.append(kernel.run(n, every=every))
                if not self._sharp(done[-1]):
                    continue
                kernel.restore(before)
                done.pop()
            done.append(kernel.run(n, every=every, switching=True))
            self.switched += n * kernel.step
            sharp = self._sharp(done[-1])
        return self._told(done)

    def _sharp(self, samples: StepperSamples) -> bool:
        """Whether the load angle comes near to what the motor can hold; samples far apart show it late."""
        return float(np.abs(self._load_angle(samples)).max(initial=0.0)) >= self.levels.threshold

    def _load_angle(self, samples: StepperSamples) -> NDArray[np.float64]:
        excitation = self.made.excitation
        field = excitation.first_angle + samples.position.astype(np.float64) * excitation.step_angle
        return field - self.made.motor.teeth * samples.state[:, 2]

    def _told(self, parts: list[StepperSamples]) -> StepperRun:
        """Return samples as what the motor did."""
        state = np.concatenate([part.state for part in parts]) if parts else np.empty((0, 5))
        position = np.concatenate([part.position for part in parts]) if parts else np.empty(0, np.int64)
        theta, omega = state[:, 2], state[:, 3]
        excitation = self.made.excitation
        angle = excitation.first_angle + position.astype(np.float64) * excitation.step_angle
        return StepperRun(
            time=np.concatenate([part.time for part in parts]) if parts else np.empty(0),
            currents=state[:, :2],
            theta=theta,
            omega=omega,
            position=position,
            load_angle=angle - self.made.motor.teeth * theta,
            lost_steps=self._lost(angle, theta, omega),
            load_theta=state[:, 4],
        )

    def _lost(
        self, field: NDArray[np.float64], theta: NDArray[np.float64], omega: NDArray[np.float64]
    ) -> NDArray[np.int64]:
        """Return the full steps lost; see :meth:`HybridStepper.lost_steps`.

        A chopper holds the currents with the field until the supply is used up; the lag is then that of a resistance
        V/I in place of R.
        """
        if self.made.chopper is None:
            return self.made.motor.lost_steps(field, theta, omega)
        motor = self.made.motor
        lag = np.arctan(motor.teeth * omega * motor.inductance * self.made.current / self.made.voltage)
        return 4 * np.rint((field - motor.teeth * theta - lag) / math.tau).astype(np.int64)


def _motor(motor: HybridStepper, load: ShaftLoad, coupling: Coupling | None) -> StepperConstants:
    """Return what the kernel needs of the rotor: the load is on it unless a coupling is between."""
    rigid = coupling is None
    return StepperConstants(
        resistance=motor.resistance,
        inductance=motor.inductance,
        torque_constant=motor.torque_constant,
        teeth=motor.teeth,
        detent=motor.detent,
        inertia=motor.inertia + rigid * load.inertia,
        viscous=motor.viscous + rigid * load.viscous,
        friction=motor.friction + rigid * load.friction,
        creep=CREEP,
        load=rigid * load.constant,
    )


def _behind(load: ShaftLoad, coupling: Coupling | None) -> CouplingConstants:
    """Return the load behind a coupling."""
    if coupling is None:
        return CouplingConstants()
    return CouplingConstants(
        stiffness=coupling.stiffness,
        damping=coupling.damping,
        inertia=load.inertia,
        viscous=load.viscous,
        friction=load.friction,
        load=load.constant,
    )


def _driver(made: Fed, tick: float, *, scale: float = 1.0) -> DriverConstants:
    """Return what the kernel needs of the driver."""
    chopper = made.chopper
    if chopper is None:
        return DriverConstants(supply=made.voltage, scale=scale, lag=2 * tick)
    return DriverConstants(
        supply=chopper.supply,
        current=chopper.current,
        lowest=chopper.lowest,
        fast=chopper.fast_part,
        off_time=chopper.off_time,
        blanking=chopper.blanking,
        lag=max(chopper.off_time, 2 * tick),
        scale=scale,
        hold=chopper.hold_current,
        hold_delay=chopper.hold_delay,
    )
