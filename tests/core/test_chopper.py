"""The stepper's kernels behind a chopper and a coupling against their plain statements in Python, step by step."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from trochia.backends.stepper_twin import MEAN, SWITCHED, StepperTwin
from trochia.errors import ConfigError
from trochia.kernels.stepper import CouplingConstants, DriverConstants, Mode, StepperConstants, StepperKernel
from trochia.machine.drivers import Chopper, Fed, HBridge, fed
from trochia.machine.drivers.switching import Switch, step_current, switch_phase
from trochia.machine.motors import ShaftLoad, motor
from trochia.machine.motors.coupled import Coupling, coupled_derivative
from trochia.machine.motors.hybrid import FREE
from trochia.machine.motors.shaft import dry_friction

if TYPE_CHECKING:
    from collections.abc import Callable

BIG = replace(motor("QSH5718-55").parameters(), detent=0.03, friction=0.01, viscous=1e-3)
LOAD = ShaftLoad(inertia=4e-5, friction=0.02, viscous=2e-3, constant=0.05)
H = 20e-6


def chopped(decay: str = "mixed") -> Fed:
    return fed(BIG, Chopper(supply=24.0, current=2.0, decay=decay, mixed=0.4), 4)


def runge_kutta(rate: Callable[[np.ndarray], np.ndarray], state: np.ndarray, step: float) -> np.ndarray:
    a = rate(state)
    b = rate(state + step / 2 * a)
    c = rate(state + step / 2 * b)
    d = rate(state + step * c)
    return state + step / 6 * (a + 2 * b + 2 * c + d)


@pytest.mark.parametrize("decay", ["slow", "fast", "mixed"])
def test_the_mean_of_a_chopper_is_as_python_states_it(decay: str):
    made = chopped(decay)
    twin = StepperTwin(made, LOAD, levels=MEAN)
    chopper, stepper = made.chopper, made.motor
    assert chopper is not None
    levels = made.excitation.levels
    twin.queue(np.arange(1, 201) * 8 * H)
    run = twin.run(0.02)
    inertia = stepper.inertia + LOAD.inertia
    state = np.array([0.0, 0.0, made.excitation.first_angle / stepper.teeth, 0.0])
    row = 0

    def rate_of(y: np.ndarray) -> np.ndarray:
        emf = stepper.back_emf(y[2], y[3])
        volts = chopper.mean_voltage(
            levels[row % len(levels)],
            y[:2],
            emf,
            resistance=stepper.resistance,
            inductance=stepper.inductance,
            lag=2 * H,
        )
        electric = (volts - stepper.resistance * y[:2] - emf) / stepper.inductance
        torque = stepper.torque(y[:2], y[2]) - (stepper.viscous + LOAD.viscous) * y[3] - LOAD.constant
        torque -= dry_friction(stepper.friction + LOAD.friction, y[3])
        return np.array([*electric, y[3], torque / inertia])

    for tick in range(1000):
        if tick and tick % 8 == 0 and row < 200:
            row += 1
        state = runge_kutta(rate_of, state, H)
        if tick % 100 == 99:
            got = [*run.currents[tick], run.theta[tick], run.omega[tick]]
            assert got == pytest.approx(state.tolist(), rel=1e-6, abs=1e-8)


@pytest.mark.parametrize("decay", ["slow", "fast", "mixed"])
def test_every_switching_is_as_python_states_it(decay: str):
    made = chopped(decay)
    twin = StepperTwin(made, LOAD, levels=SWITCHED)
    chopper, stepper = made.chopper, made.motor
    assert chopper is not None
    twin.queue((np.arange(1, 30) * 6 + 0.5) * H)
    run = twin.run(200 * H)
    dt, inertia = H / 20, stepper.inertia + LOAD.inertia
    x, w, amps = made.excitation.first_angle / stepper.teeth, 0.0, [0.0, 0.0]
    switches = [Switch(), Switch()]
    for k in range(4000):
        row = sum((n * 6 + 0.5) * H < (k // 20) * H + (k % 20 + 1) * dt for n in range(1, 30))
        levels = made.excitation.levels[row % len(made.excitation.levels)]
        emf = stepper.back_emf(np.array(x), np.array(w))
        before = x
        for phase in (0, 1):
            volts, switches[phase] = switch_phase(chopper, switches[phase], float(levels[phase]), amps[phase], dt)
            amps[phase] = step_current(
                amps[phase], volts, float(emf[phase]), resistance=stepper.resistance, inductance=stepper.inductance,
                step=dt,
            )  # fmt: skip
        torque = float(stepper.torque(np.array(amps), np.array(before)))
        torque -= (stepper.viscous + LOAD.viscous) * w + LOAD.constant
        torque -= float(dry_friction(stepper.friction + LOAD.friction, np.array(w)))
        w += dt / inertia * torque
        x += dt * w
        if k % 400 == 399:
            tick = k // 20
            got = [*run.currents[tick], run.theta[tick], run.omega[tick]]
            assert got == pytest.approx([*amps, x, w], rel=1e-7, abs=1e-9)


def test_a_load_behind_a_coupling_is_as_python_states_it():
    made = fed(BIG, HBridge(supply=10.0, drop=0.0))
    coupling = Coupling(stiffness=8.0, damping=1e-3)
    twin = StepperTwin(made, LOAD, coupling=coupling)
    twin.queue(np.arange(1, 12) * 100 * H)
    run = twin.run(1200 * H)
    state = np.array([0.0, 0.0, np.pi / 4 / BIG.teeth, 0.0, np.pi / 4 / BIG.teeth, 0.0])
    for tick in range(1200):
        volts = made.voltage * made.excitation.levels[min(tick // 100, 11) % 4]
        state = runge_kutta(lambda y, v=volts: coupled_derivative(made.motor, coupling, LOAD, y, v), state, H)
        if tick % 150 == 149:
            assert run.load_theta is not None
            got = [*run.currents[tick], run.theta[tick], run.omega[tick], run.load_theta[tick]]
            assert got == pytest.approx(state[:5].tolist(), rel=1e-7, abs=1e-9)


def test_a_coupling_swings_at_its_resonance():
    """Released, rotor and load swing against each other at sqrt(k (1/J + 1/J_l))/2 pi."""
    free = replace(motor("QSH5718-55").parameters(), detent=0.0)
    coupling, load = Coupling(stiffness=20.0), ShaftLoad(inertia=8e-5)
    constants = StepperConstants(resistance=1e3, inductance=1.0, torque_constant=1e-9, teeth=50, inertia=free.inertia,
                                 creep=0.1)  # fmt: skip
    kernel = StepperKernel(
        constants, DriverConstants(supply=1.0), np.zeros((4, 2)), np.zeros(4), step=H,
        coupling=CouplingConstants(stiffness=20.0, inertia=8e-5, load=0.1),
    )  # fmt: skip
    run = kernel.run(20000)
    apart = run.state[:, 2] - run.state[:, 4]
    crossings = np.flatnonzero(np.diff(np.sign(apart - apart.mean())) > 0)
    period = np.diff(run.time[crossings]).mean()
    assert 1 / period == pytest.approx(coupling.resonance(free, load), rel=2e-3)


def test_stiff_couplings_and_ticks_beyond_the_motor_are_refused():
    made = fed(BIG, HBridge(supply=12.0))
    with pytest.raises(ConfigError, match="too long for this motor and load"):
        StepperTwin(made, LOAD, coupling=Coupling(stiffness=1e7), step=20e-6)
    with pytest.raises(ConfigError, match="needs an inertia"):
        StepperTwin(made, FREE, coupling=Coupling(stiffness=10.0))
    with pytest.raises(ConfigError, match="above zero"):
        Coupling(stiffness=0.0)


def test_state_can_be_put_back():
    twin = StepperTwin(chopped(), LOAD)
    kernel = twin._kernel
    twin.queue(np.arange(1, 20) * 1e-3)
    twin.run(5e-3)
    saved = kernel.save()
    first = kernel.run(500).state
    kernel.restore(saved)
    assert (kernel.run(500).state == first).all()
    assert kernel.mode is Mode.MEAN
