"""The twin of a variable reluctance stepper: motor, switches, excitation and load together, losing steps as they do.

In: step pulses.  Out: what the rotor did, and how many steps it lost.  Without current nothing holds it: the motor has
no magnet, and no detent.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.kernels.reluctance import ReluctanceConstants, ReluctanceKernel
from trochia.machine.motors.hybrid import FREE
from trochia.machine.motors.shaft import CREEP
from trochia.pulses.chain import phase_table

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.motors import ShaftLoad
    from trochia.machine.motors.reluctance_drive import ReluctanceDrive, Switches

STEP = 20e-6  #: time step [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class ReluctanceRun:
    """What the motor did, each (samples,) but the currents (samples, phases).

    Attributes
    ----------
    time, currents, theta, omega
        [s], [A], [rad], [rad/s].
    position
        Steps commanded so far.
    load_angle
        Electrical angle of the field before the rotor, counted in the order of excitation [rad].
    lost_steps
        Full steps the rotor has lost: a multiple of the phases; what it stands at once at rest is what the job lost.
    """

    time: NDArray[np.float64]
    currents: NDArray[np.float64]
    theta: NDArray[np.float64]
    omega: NDArray[np.float64]
    position: NDArray[np.int64]
    load_angle: NDArray[np.float64]
    lost_steps: NDArray[np.int64]


class ReluctanceTwin:
    """A motor at rest, where the first row of the excitation holds it and without current yet, at time zero.

    Parameters
    ----------
    excitation
        ``one-phase``, ``two-phase`` or ``half-step``.
    step
        Time step [s].

    Raises
    ------
    ConfigError
        When the motor has more phases than the core has room for, no distributor makes the excitation, or the time step
        is too long for the motor.
    """

    def __init__(
        self,
        motor: ReluctanceDrive,
        excitation: str,
        switches: Switches,
        load: ShaftLoad = FREE,
        *,
        step: float = STEP,
    ) -> None:
        self.motor, self.switches = motor, switches
        phases = motor.geometry.phases
        self.table = phase_table(excitation, phases)
        field = np.exp(2j * math.pi / phases * np.arange(phases))  # of each phase, in the order of excitation
        self._first = float(np.angle(self.table[0] @ field))
        self._row_angle = math.tau / len(self.table)
        self._kernel = ReluctanceKernel(self._constants(load), self.table, theta=self._held(0), step=step)

    @property
    def now(self) -> float:
        """Time since zero [s]."""
        return self._kernel.now

    @property
    def step_angle(self) -> float:
        """What a pulse turns the rotor by [rad]; below zero where it turns against the order of excitation."""
        return self._held(1) - self._held(0)

    def set_load(self, load: ShaftLoad) -> None:
        """Change the load from here on."""
        self._kernel.set_constants(self._constants(load))

    def queue(self, times: NDArray[np.float64], direction: int = 1) -> None:
        """Add step pulses [s since zero] (pulses,) in one direction of the excitation, 1 or -1, to those to come.

        Raises
        ------
        LimitError
            When they do not rise from the last one queued, or from now.
        """
        self._kernel.queue(times, np.full(len(times), direction, np.int8))

    def run(self, duration: float, *, every: int = 1) -> ReluctanceRun:
        """Go on for a duration [s], rounded to whole time steps, and return every ``every``-th sample."""
        samples = self._kernel.run(round(duration / self._kernel.step), every=every)
        theta, omega = samples.state[:, -2], samples.state[:, -1]
        turned = self.motor.geometry.direction * self.motor.geometry.teeth * theta
        load_angle = self._first + samples.position * self._row_angle - turned
        return ReluctanceRun(
            time=samples.time,
            currents=samples.state[:, :-2],
            theta=theta,
            omega=omega,
            position=samples.position,
            load_angle=load_angle,
            lost_steps=self.motor.geometry.phases * np.rint(load_angle / math.tau).astype(np.int64),
        )

    def _held(self, row: int) -> float:
        """Return where a row of the excitation holds the rotor [rad]."""
        geometry = self.motor.geometry
        return geometry.direction * (self._first + row * self._row_angle) / geometry.teeth

    def _constants(self, load: ShaftLoad) -> ReluctanceConstants:
        """Return what the kernel needs of motor, switches and load."""
        motor, switches, geometry = self.motor, self.switches, self.motor.geometry
        return ReluctanceConstants(
            phases=geometry.phases,
            resistance=motor.resistance,
            mean=(motor.aligned + motor.unaligned) / 2,
            swing=(motor.aligned - motor.unaligned) / 2,
            teeth=geometry.teeth,
            shift=geometry.direction * geometry.phase_shift,
            supply=switches.supply,
            against=switches.against,
            series=switches.series,
            inertia=motor.inertia + load.inertia,
            viscous=motor.viscous + load.viscous,
            friction=motor.friction + load.friction,
            creep=CREEP,
            load=load.constant,
        )
