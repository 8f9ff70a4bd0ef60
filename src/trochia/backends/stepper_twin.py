"""The twin of one stepper: motor, excitation, supply and load together, losing steps as the real one does.

In: step pulses.  Out: what the rotor did, and how many steps it lost.  Voltage drive: each phase is connected to the
supply, times the level of the excitation; a phase at level zero is shorted through its bridge and brakes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import ConfigError
from trochia.kernels.stepper import StepperConstants, StepperKernel
from trochia.machine.motors.hybrid import FREE
from trochia.machine.motors.shaft import CREEP

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.motors import HybridStepper, ShaftLoad
    from trochia.pulses.excitation import Excitation

STEP = 20e-6  #: time step [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class StepperRun:
    """What the motor did, each (samples,) but the currents (samples, 2).

    Attributes
    ----------
    time, currents, theta, omega
        [s], [A], [rad], [rad/s].
    position
        Steps commanded so far, counted on from the excitation's first row.
    load_angle
        Electrical angle of the field before the rotor [rad].
    lost_steps
        Full steps the rotor has lost: a multiple of four; what it stands at once at rest is what the job lost.
    load_theta
        Angle of the load [rad], which an elastic coupling lets differ; None where the twin has none.
    """

    time: NDArray[np.float64]
    currents: NDArray[np.float64]
    theta: NDArray[np.float64]
    omega: NDArray[np.float64]
    position: NDArray[np.int64]
    load_angle: NDArray[np.float64]
    lost_steps: NDArray[np.int64]
    load_theta: NDArray[np.float64] | None = None


class StepperTwin:
    """A motor at rest, aligned with the excitation's first row and without current yet, at time zero.

    Parameters
    ----------
    voltage
        Supply across a phase at level 1, what the driver drops taken off [V].
    step
        Time step [s].

    Raises
    ------
    ConfigError
        When the voltage is not above zero, or the time step too long for the motor.
    """

    def __init__(
        self,
        motor: HybridStepper,
        excitation: Excitation,
        voltage: float,
        load: ShaftLoad = FREE,
        *,
        step: float = STEP,
    ) -> None:
        if not 0 < voltage < np.inf:
            raise ConfigError(f"the supply voltage must be above zero, not {voltage!r} V")
        self.motor = motor
        self.excitation = excitation
        aligned = np.array([0.0, 0.0, excitation.first_angle / motor.teeth, 0.0])
        self._kernel = StepperKernel(_constants(motor, load), voltage * excitation.levels, aligned, step=step)

    @property
    def now(self) -> float:
        """Time since zero [s]."""
        return self._kernel.now

    def set_load(self, load: ShaftLoad) -> None:
        """Change the load from here on."""
        self._kernel.set_constants(_constants(self.motor, load))

    def queue(self, times: NDArray[np.float64], direction: int = 1) -> None:
        """Add step pulses [s since zero] (pulses,) in one direction, 1 or -1, to those to come.

        Raises
        ------
        LimitError
            When they do not rise from the last one queued, or from now.
        """
        self._kernel.queue(times, np.full(len(times), direction, np.int8))

    def run(self, duration: float, *, every: int = 1) -> StepperRun:
        """Go on for a duration [s], rounded to whole time steps, and return every ``every``-th sample."""
        samples = self._kernel.run(round(duration / self._kernel.step), every=every)
        theta, omega = samples.state[:, 2], samples.state[:, 3]
        field = self.excitation.first_angle + samples.position.astype(np.float64) * self.excitation.step_angle
        return StepperRun(
            time=samples.time,
            currents=samples.state[:, :2],
            theta=theta,
            omega=omega,
            position=samples.position,
            load_angle=field - self.motor.teeth * theta,
            lost_steps=self.motor.lost_steps(field, theta, omega),
        )


def _constants(motor: HybridStepper, load: ShaftLoad) -> StepperConstants:
    """Return what the kernel needs of a motor and its load."""
    return StepperConstants(
        resistance=motor.resistance,
        inductance=motor.inductance,
        torque_constant=motor.torque_constant,
        teeth=motor.teeth,
        detent=motor.detent,
        inertia=motor.inertia + load.inertia,
        viscous=motor.viscous + load.viscous,
        friction=motor.friction + load.friction,
        creep=CREEP,
        load=load.constant,
    )
