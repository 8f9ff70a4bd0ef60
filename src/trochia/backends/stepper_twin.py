"""The twin of one stepper: motor, driver, excitation and load together, losing steps as the real one does.

In: step pulses.  Out: what the rotor did, and how many steps it lost.

A voltage drive (a bridge, L/R) has nothing to control; what a bridge drops is against the current, in idle phases
too.  A chopper is followed on average, at 20 us a tick.  Where the load angle or the torque comes near to what the
motor can hold, the stretch is done again switch by switch, at 1 us, from the very state before it: there the shape of
the current decides whether steps are lost.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import ConfigError
from trochia.kernels.stepper import CouplingConstants, DriverConstants, Mode, StepperConstants, StepperKernel
from trochia.kernels.stepper import longest_step as longest_of
from trochia.machine.drivers.bridge import KNEE
from trochia.machine.motors.hybrid import FREE
from trochia.machine.motors.shaft import CREEP

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.kernels.stepper import StepperSamples
    from trochia.machine.drivers import Fed
    from trochia.machine.motors import HybridStepper, ShaftLoad
    from trochia.machine.motors.coupled import Coupling

STEP = 20e-6  #: time step [s]
SWITCH = 1e-6  #: time step of a chopper's switching [s]
_SPEEDS = np.linspace(0.0, 1000.0, 501)  # of the shaft [rad/s]
SOFTEST = 2.5  #: time steps in which the drop of a bridge may turn round with the current, at least


@dataclass(frozen=True, slots=True, kw_only=True)
class Levels:
    """When a chopper is followed switch by switch.

    Attributes
    ----------
    threshold
        Load angle [electrical rad] above which a stretch is; 0: always.  At 60 degrees 87 % of the torque is used.
    margin
        Part of the torque that pulls the motor out at its speed, below which a stretch is; 0: the load angle alone.
        It sees what the angle hides: at speed the currents lag, so a motor that brakes with all its torque stands at
        a small load angle.
    window
        Length of a stretch [s].
    """

    threshold: float = math.radians(60)
    margin: float = 0.15
    window: float = 5e-3


MEAN = Levels(threshold=math.inf, margin=0.0)  #: never
SWITCHED = Levels(threshold=0.0)  #: always


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
        Angle of the load [rad]: the rotor's, unless an elastic coupling lets it differ.
    """

    time: NDArray[np.float64]
    currents: NDArray[np.float64]
    theta: NDArray[np.float64]
    omega: NDArray[np.float64]
    position: NDArray[np.int64]
    load_angle: NDArray[np.float64]
    lost_steps: NDArray[np.int64]
    load_theta: NDArray[np.float64]


class StepperTwin:
    """A motor behind its driver, at rest, aligned with the excitation's first row and without current, at time zero.

    Parameters
    ----------
    load
        On the shaft, or behind the coupling where there is one.
    step
        Time step of voltage drives and of the averaged chopper [s]; 20 us where not given, or what motor and
        load stand.  The switching takes some 1 us.
    angle
        Where the rotor stands at power-up [electrical rad from the first row]; the phases pull it to the nearest stable
        point, up to two full steps away.
    enabled
        Whether the phases are on.

    Attributes
    ----------
    switched
        Time that was done switch by switch [s].

    Raises
    ------
    ConfigError
        When the time step is too long for motor and load.
    """

    def __init__(
        self,
        made: Fed,
        load: ShaftLoad = FREE,
        *,
        coupling: Coupling | None = None,
        levels: Levels = Levels(),
        step: float | None = None,
        angle: float = 0.0,
        enabled: bool = True,
    ) -> None:
        self.made, self.levels, self._coupling = made, levels, coupling
        if coupling is not None and not load.inertia > 0:
            raise ConfigError("a load behind a coupling needs an inertia above zero", key="load.inertia")
        step = longest_step(made, load, coupling) if step is None else step
        aligned = np.array([0.0, 0.0, (made.excitation.first_angle + angle) / made.motor.teeth, 0.0])
        self._kernel = StepperKernel(
            _motor(made.motor, load, coupling), _driver(made, step), made.excitation.levels, aligned,
            coupling=_behind(load, coupling), step=step, sub=max(1, round(step / SWITCH)),
        )  # fmt: skip
        self.set_enabled(enabled)
        self._there = made.gross_pull_out(_SPEEDS)  # looked up between, as every stretch asks for it
        self.switched = 0.0

    @property
    def now(self) -> float:
        """Time since zero [s]."""
        return self._kernel.now

    def set_load(self, load: ShaftLoad) -> None:
        """Change the load from here on."""
        self._kernel.set_motor(_motor(self.made.motor, load, self._coupling), _behind(load, self._coupling))

    def set_levels(self, levels: NDArray[np.float64]) -> None:
        """Excite by another table of as many rows from here on (rows, 2); the field's angles stay the excitation's."""
        self._kernel.set_levels(levels)

    def set_enabled(self, enabled: bool) -> None:  # noqa: FBT001 - the one switch
        """Switch the phases on, or release them: held, shorted or open, as the driver does."""
        on = enabled or self.made.driver.released == "hold"
        across = Mode.BRIDGE if self.made.opposing else Mode.VOLTAGE
        driven = across if self.made.chopper is None else Mode.MEAN
        short = not on and self.made.driver.released == "short"
        self._kernel.set_driver(_driver(self.made, self._kernel.step, scale=0.0 if short else 1.0))
        self._kernel.mode = driven if on else across if short else Mode.OPEN

    def queue(self, times: NDArray[np.float64], direction: int | NDArray[np.int8] = 1) -> None:
        """Add step pulses [s since zero] (pulses,) to those to come, in one direction or each in its own (pulses,).

        Raises
        ------
        LimitError
            When they do not rise from the last one queued, or from now.
        """
        self._kernel.queue(times, np.broadcast_to(np.asarray(direction, np.int8), np.shape(times)))

    def run(self, duration: float, *, every: int = 1) -> StepperRun:
        """Go on for a duration [s], rounded to whole time steps, and return every ``every``-th sample."""
        return self.run_ticks(round(duration / self._kernel.step), every=every)

    def run_ticks(self, ticks: int, *, every: int = 1) -> StepperRun:
        """Go on for some time steps and return every ``every``-th sample."""
        kernel, levels = self._kernel, self.levels
        if kernel.mode is not Mode.MEAN or levels == MEAN:
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
        """Whether load angle or torque comes near to what the motor can hold; samples far apart show it late."""
        angle = float(np.abs(self._field(samples.position) - self._electrical(samples)).max(initial=0.0))
        return angle >= self.levels.threshold or self._short_of_torque(samples)

    def _short_of_torque(self, samples: StepperSamples) -> bool:
        """Whether less than the margin is left of the torque that pulls the motor out."""
        if not self.levels.margin > 0 or not len(samples.time):
            return False
        there = np.interp(np.abs(samples.state[:, 3]), _SPEEDS, self._there)
        made = np.abs(self.made.motor.torque(samples.state[:, :2], samples.state[:, 2]))
        return bool((made > (1 - self.levels.margin) * there).any())

    def _field(self, position: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the electrical angle of the field, counted on [rad] (samples,)."""
        excitation = self.made.excitation
        return excitation.first_angle + position.astype(np.float64) * excitation.step_angle

    def _electrical(self, samples: StepperSamples) -> NDArray[np.float64]:
        """Return the electrical angle of the rotor, counted on [rad] (samples,)."""
        return self.made.motor.teeth * samples.state[:, 2]

    def _told(self, parts: list[StepperSamples]) -> StepperRun:
        """Return samples as what the motor did."""
        state = np.concatenate([np.empty((0, 5)), *(part.state for part in parts)])
        position = np.concatenate([np.empty(0, np.int64), *(part.position for part in parts)])
        theta, omega = state[:, 2], state[:, 3]
        field = self._field(position)
        return StepperRun(
            time=np.concatenate([np.empty(0), *(part.time for part in parts)]),
            currents=state[:, :2],
            theta=theta,
            omega=omega,
            position=position,
            load_angle=field - self.made.motor.teeth * theta,
            lost_steps=self.made.lost_steps(field, theta, omega),
            load_theta=state[:, 4],
        )


def longest_step(made: Fed, load: ShaftLoad = FREE, coupling: Coupling | None = None) -> float:
    """Return the time step that a twin of them takes [s]: 20 us, or what they stand if that is less."""
    stands = longest_of(_motor(made.motor, load, coupling), _behind(load, coupling))
    return min(STEP, stands)


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
        drop, widest = made.opposing, SOFTEST * tick / made.motor.inductance
        return DriverConstants(
            supply=made.voltage + drop, drop=drop, knee=max(KNEE * made.current, drop * widest), scale=scale,
            lag=2 * tick,
        )  # fmt: skip
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
