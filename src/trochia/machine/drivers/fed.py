"""A motor behind its driver: what the equations and the closed forms need, put together.

In: a motor, a driver, microsteps.  Out: :class:`Fed`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar, Protocol

import numpy as np

from trochia.errors import ConfigError, LimitError
from trochia.machine.drivers.chip import Chip, excited
from trochia.machine.drivers.chopper import Chopper
from trochia.machine.drivers.voltage import HBridge
from trochia.machine.motors.curves import corner_speed, holding_torque, pull_out_torque, start_stop_speed
from trochia.machine.motors.hybrid import FREE

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.motors.excitation import Excitation
    from trochia.machine.motors.hybrid import HybridStepper
    from trochia.machine.motors.shaft import ShaftLoad

MOST_SPEED = 1e4  #: no stepper turns as fast [rad/s]
MOST_OVERLOAD = 1.0 + 1e-9  #: a current on its limit is within it


class Driver(Protocol):
    """What every driver says of a phase; see :class:`~trochia.machine.drivers.voltage.HBridge` for the meanings."""

    kind: ClassVar[str]
    chip: ClassVar[Chip | None]

    @property
    def supply(self) -> float:
        """Of the motor [V]."""
        ...

    @property
    def phase_voltage(self) -> float:
        """Across a phase at level 1 [V]."""
        ...

    @property
    def resistance(self) -> float:
        """What it adds to a phase [ohm]."""
        ...

    @property
    def current(self) -> float | None:
        """What it holds the current of a phase to [A]; None: it does not."""
        ...

    @property
    def excitation(self) -> str | None:
        """Name of the excitation; None: by microsteps."""
        ...

    @property
    def released(self) -> str:
        """What becomes of the phases of a released motor: hold, short or open."""
        ...

    @property
    def current_limit(self) -> float | None:
        """Continuous, of a phase [A]."""
        ...

    @property
    def power_limit(self) -> float | None:
        """Heat it gets rid of [W]."""
        ...

    def loss(self, rms: float, mean: float) -> float:
        """Return its heat for a phase [W]."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Fed:
    """A motor behind its driver.

    Attributes
    ----------
    motor
        Its parameters, with what the driver adds to the resistance of a phase.
    excitation
        How the phases are switched.
    driver
        What feeds them.
    """

    motor: HybridStepper
    excitation: Excitation
    driver: Driver

    @property
    def chopper(self) -> Chopper | None:
        """The driver, where it controls the current."""
        return self.driver if isinstance(self.driver, Chopper) else None

    @property
    def voltage(self) -> float:
        """Across a phase at level 1 [V]."""
        return self.driver.phase_voltage

    @property
    def opposing(self) -> float:
        """What the bridge drops against the current of a phase, driven or not [V]; see ``bridge.phase_voltage``."""
        return self.driver.drop if isinstance(self.driver, HBridge) else 0.0

    @property
    def amplitude(self) -> float:
        """Amplitude of the fundamental of the phase voltage that the supply allows [V]."""
        return self.voltage * self.excitation.fundamental

    @property
    def current(self) -> float:
        """Of a phase at level 1 and at rest [A]: what is set, or what the resistance allows."""
        most = self.voltage / self.motor.resistance
        return most if self.driver.current is None else min(self.driver.current, most)

    @property
    def current_amplitude(self) -> float | None:
        """Amplitude of the fundamental of the current that is set [A]; None where nothing controls it."""
        return None if self.driver.current is None else self.current * self.excitation.fundamental

    @property
    def holding(self) -> float:
        """Greatest torque at rest, with the full current [N·m]."""
        return holding_torque(self.motor, self.excitation, self.current)

    def hold_of(self, part: float) -> float:
        """Return the torque that holds at rest, in the weakest row of the excitation, with a part of the current [N·m].

        Half the ripple of a chopper is taken off; the detent's torque is not in it, which is all that is left of a
        driver that switches off at rest.
        """
        row = float(np.hypot(*self.excitation.levels.T).min())
        return self.motor.torque_constant * row * max(0.0, self.current * part - 0.5 * self._ripple(part))

    def _ripple(self, part: float) -> float:
        """Return the ripple at rest of a part of the current [A]."""
        if self.chopper is None or part == 0:
            return 0.0
        motor, rest = self.motor, np.zeros(())
        return float(self.chopper.ripple(rest + part * self.current, rest, resistance=motor.resistance,
                                         inductance=motor.inductance))  # fmt: skip

    def pull_out(self, omega: NDArray[np.float64], load: ShaftLoad = FREE) -> NDArray[np.float64]:
        """Return the torque at which the motor falls out of step at shaft speeds (...) [N·m], frictions taken off."""
        return pull_out_torque(self.motor, omega, self.amplitude, current=self.current_amplitude, load=load)

    def gross_pull_out(self, omega: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the same with the motor's own frictions in it: what the currents give at most (...) [N·m]."""
        smooth = replace(self.motor, friction=0.0, viscous=0.0)
        return pull_out_torque(smooth, omega, self.amplitude, current=self.current_amplitude)

    def lost_steps(
        self, field_angle: NDArray[np.float64], theta: NDArray[np.float64], omega: NDArray[np.float64]
    ) -> NDArray[np.int64]:
        """Return the full steps the rotor has lost; see :meth:`HybridStepper.lost_steps`.

        A chopper holds the currents with the field until the supply is used up; the lag is then that of a resistance
        V/I, which is R where nothing but the resistance limits the current.
        """
        return self.motor.lost_steps(field_angle, theta, omega, self.voltage / self.current)

    def top(self, part: float = 0.2) -> float:
        """Return the speed up to which a part of the torque at rest is left [rad/s]; what one may call usable."""
        least, high = part * float(self.pull_out(np.array(0.0))), 1.0
        while float(self.pull_out(np.array(high))) > least and high < 1e4:
            high *= 1.05
        return high

    def fastest(self, load: ShaftLoad = FREE) -> float:
        """Return the speed at which the load takes all torque, without acceleration [rad/s]; 0: it never runs.

        The torque falls steadily with speed, so halving finds it.  Without friction a sinusoidal voltage keeps some
        torque at any speed where V > K R/(p L), and a current that is set above K/(p L) is not exceeded by what the
        magnet drives: the answer is then infinite, and something else ends it.
        """
        against = abs(load.constant)

        def spare(omega: float) -> float:
            return float(self.pull_out(np.array(omega), load)) - against

        low, high = 0.0, 1.0
        if spare(0.0) <= 0:
            return 0.0
        while spare(high) > 0:
            low, high = high, 2 * high
            if high > MOST_SPEED:
                return math.inf
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if spare(middle) > 0 else (low, middle)
        return low

    def start_stop(self, load: ShaftLoad = FREE) -> float:
        """Return an estimate of the highest speed it starts at without a ramp [rad/s]; 0: it does not start.

        That of :func:`start_stop_speed`, with the torque that is left at that very speed: the field turns at it from
        the first step on, so the currents are already those of its frequency, V/|Z|, while the rotor still stands.
        The faster, the less torque is left to start with: halving finds the speed that its own torque starts.
        """
        ampere = math.inf if self.current_amplitude is None else self.current_amplitude

        def escape(omega: float) -> float:
            current = min(ampere, self.amplitude / abs(complex(self.motor.impedance(np.array(omega)))))
            torque = min(self.holding, self.motor.torque_constant * current)
            try:
                return start_stop_speed(self.motor, torque, load=load, step_angle=self.excitation.step_angle)
            except LimitError:
                return 0.0

        low, high = 0.0, escape(0.0)
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if escape(middle) > middle else (low, middle)
        return min(low, self.fastest(load))

    @property
    def corner(self) -> float | None:
        """Speed up to which the supply drives the set current [rad/s]; None where nothing controls it."""
        wanted = self.current_amplitude
        return None if wanted is None or wanted * self.motor.resistance >= self.amplitude else corner_speed(
            self.motor, self.amplitude, wanted
        )  # fmt: skip


def fed(motor: HybridStepper, driver: Driver, microsteps: int | None = None) -> Fed:
    """Return a motor behind its driver.

    Parameters
    ----------
    microsteps
        Step pulses a full step; they choose the excitation where the driver names none.  Without either it is
        two-phase, and without this the driver's excitation has its own.

    Raises
    ------
    ConfigError
        For an excitation of other microsteps, or microsteps or a current the driver or its supply cannot give.
    """
    mode = excited(driver.chip, driver.kind, driver.excitation, microsteps)
    result = Fed(motor=replace(motor, resistance=motor.resistance + driver.resistance), excitation=mode, driver=driver)
    _check_current(result)
    return result


def _check_current(made: Fed) -> None:
    """Refuse a current that the supply cannot drive, or that the driver does not carry."""
    driver, resistance = made.driver, made.motor.resistance
    if driver.current is not None and driver.current * resistance > made.voltage * MOST_OVERLOAD:
        raise ConfigError(
            f"{driver.supply:g} V drives at most {made.voltage / resistance:.3g} A through {resistance:.3g} ohm, "
            f"not {driver.current:g} A",
            key="driver.current",
            hint=f"A supply above {driver.current * resistance:.3g} V would do.",
        )
    limit = driver.current_limit
    if limit is not None and made.current > limit * MOST_OVERLOAD:
        raise ConfigError(
            f"a phase draws {made.current:.3g} A, the driver carries {limit:g} A",
            key="driver.current_limit",
            hint=_would_do(made, limit),
        )


def _would_do(made: Fed, limit: float) -> str:
    """Return what keeps a phase to a driver's limit [A]: a current, a lower supply, or another motor."""
    driver, resistance = made.driver, made.motor.resistance
    if driver.current is not None:
        return f"A current of {limit:g} A would do."
    supply = limit * resistance + driver.supply - driver.phase_voltage
    least = driver.chip.supply[0] if driver.chip is not None else 0.0
    if supply >= least:
        return f"A supply of {math.floor(100 * supply) / 100:g} V would do."
    return f"A motor of {made.voltage / limit:.3g} ohm a phase or more would do, or a chopper."
