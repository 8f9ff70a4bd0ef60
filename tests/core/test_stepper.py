"""The stepper's kernel against a plain statement of its equations, and what every block must keep."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from trochia.backends.stepper_twin import SOFTEST, StepperTwin
from trochia.errors import ConfigError, LimitError
from trochia.kernels.stepper import DriverConstants, StepperConstants, StepperKernel
from trochia.machine.drivers import Fed, HBridge, fed
from trochia.machine.drivers.bridge import KNEE, phase_voltage
from trochia.machine.motors import HybridStepper, ShaftLoad, motor
from trochia.machine.motors.coupled import Coupling, coupled_derivative
from trochia.pulses.excitation import excitation

STEP, VOLTS = 20e-6, 10.0
MOTORS = {
    "shield": motor("SM-42BYG011-25").parameters(),
    "rough": HybridStepper(teeth=12, resistance=1.5, inductance=3e-3, current=2.0, inertia=100e-7, torque_constant=0.15,
                           detent=0.02, friction=0.005, viscous=2e-4),
}  # fmt: skip
LOADS = {
    "free": ShaftLoad(),
    "heavy": ShaftLoad(inertia=2e-5, constant=0.03, friction=0.01, viscous=1e-4),
}


def bridged(stepper: HybridStepper, mode: str, volts: float) -> Fed:
    return fed(stepper, HBridge(supply=volts, drop=0.0, excitation=mode))


def reference(stepper, mode, load, pulses, ticks):
    """Integrate the public equations by Runge-Kutta, cut where a pulse falls; yield state and position of each tick."""
    state = np.array([0.0, 0.0, mode.first_angle / stepper.teeth, 0.0])
    position = 0
    for tick in range(ticks):
        begin, end = tick * STEP, (tick + 1) * STEP
        inside = [pulse for pulse in pulses if begin <= pulse[0] < end]
        cuts = [begin, *(at for at, _ in inside), end]
        for part, (a, b) in enumerate(pairwise(cuts)):
            if part:
                position += inside[part - 1][1]
            volts = VOLTS * mode.levels[position % len(mode.levels)]
            h = b - a

            def rate(y, volts=volts):
                return stepper.derivative(y, volts, load)

            k1 = rate(state)
            k2 = rate(state + h / 2 * k1)
            k3 = rate(state + h / 2 * k2)
            k4 = rate(state + h * k3)
            state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        yield state, position


@pytest.mark.parametrize("elastic", [False, True])
@pytest.mark.parametrize("released", [False, True])
def test_what_a_bridge_drops_is_against_the_current_as_python_states_it(*, released: bool, elastic: bool):
    """With a coupling and without one, driven and released; phases idle in turn, currents turn round."""
    stepper, load, ticks = MOTORS["rough"], LOADS["heavy"], 400
    made = fed(stepper, HBridge(supply=VOLTS, drop=2.4, excitation="half-step"))
    coupling = Coupling(stiffness=20.0, damping=1e-3)
    twin = StepperTwin(made, load, coupling=coupling if elastic else None)
    twin.queue(np.arange(1, 20) * 12 * STEP)
    run = twin.run(240 * STEP)
    twin.set_enabled(not released)
    after = twin.run((ticks - 240) * STEP)
    got = np.concatenate([np.column_stack([r.currents, r.theta, r.omega]) for r in (run, after)])
    first, levels = made.excitation.first_angle / stepper.teeth, made.excitation.levels
    state = np.array([0.0, 0.0, first, 0.0, first, 0.0])
    knee = max(KNEE * made.current, 2.4 * SOFTEST * STEP / stepper.inductance)

    for tick in range(ticks):
        row = levels[min(tick // 12, 19) % len(levels)] * (0.0 if released and tick >= 240 else 1.0)

        def rate(y: np.ndarray, row: np.ndarray = row) -> np.ndarray:
            volts = phase_voltage(row, y[:2], supply=VOLTS, drop=2.4, knee=knee)
            if elastic:
                return coupled_derivative(stepper, coupling, load, y, volts)
            return np.concatenate([stepper.derivative(y[:4], volts, load), [0.0, 0.0]])

        k1 = rate(state)
        k2 = rate(state + STEP / 2 * k1)
        k3 = rate(state + STEP / 2 * k2)
        k4 = rate(state + STEP * k3)
        state = state + STEP / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        assert got[tick] == pytest.approx(state[:4].tolist(), rel=1e-7, abs=1e-9)


@pytest.mark.parametrize("name", MOTORS)
@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("mode", ["one-phase", "two-phase", "half-step", "microstep-8"])
def test_kernel_equals_the_public_equations(name: str, load: str, mode: str):
    stepper, table, ticks = MOTORS[name], excitation(mode), 300
    rng = np.random.default_rng(11)
    times = np.sort(np.concatenate([rng.uniform(0, ticks * STEP, 12), [0.0, 40 * STEP, 40 * STEP, 41 * STEP]]))
    twin = StepperTwin(bridged(stepper, mode, VOLTS), LOADS[load])
    twin.queue(times[:9], 1)
    twin.queue(times[9:], -1)
    run = twin.run(ticks * STEP)
    signs = np.where(np.arange(len(times)) < 9, 1, -1)
    expected = list(reference(stepper, table, LOADS[load], list(zip(times, signs, strict=True)), ticks))
    states = np.array([state for state, _ in expected])
    np.testing.assert_allclose(run.currents, states[:, :2], rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(run.theta, states[:, 2], rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(run.omega, states[:, 3], rtol=1e-9, atol=1e-8)
    assert run.position.tolist() == [position for _, position in expected]
    np.testing.assert_allclose(run.time, STEP * np.arange(1, ticks + 1))


def whole_and_cut(cuts: list[int], every: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Return positions and angles of a run made at once, and of the same in blocks."""
    both = []
    for blocks in ([sum(cuts)], cuts):
        twin = StepperTwin(bridged(MOTORS["rough"], "half-step", 12.0))
        twin.queue(np.arange(1, 60) * 171.7e-6)
        runs = [twin.run(ticks * STEP, every=every) for ticks in blocks]
        both.append(np.concatenate([np.column_stack([r.time, r.theta, r.omega, r.currents, r.position]) for r in runs]))
    return both[0], both[1]


def test_any_cut_into_blocks_gives_the_same_samples():
    whole, cut = whole_and_cut([1, 7, 100, 92, 300])
    np.testing.assert_array_equal(whole, cut)


def test_every_tenth_sample_is_every_tenth_sample():
    whole, _ = whole_and_cut([500])
    tenth, cut = whole_and_cut([200, 300], every=10)
    np.testing.assert_array_equal(tenth, whole[9::10])
    np.testing.assert_array_equal(tenth, cut)


def test_error_falls_with_the_fourth_power_of_the_step():
    ends = []
    for step in (160e-6, 80e-6, 5e-6):
        twin = StepperTwin(bridged(MOTORS["shield"], "two-phase", 12.0), step=step)
        twin.queue(np.array([1e-3 + 0.3e-6, 5.21e-3]))
        ends.append(float(twin.run(16e-3).theta[-1]))
    coarse, fine = abs(ends[0] - ends[2]), abs(ends[1] - ends[2])
    assert 3.5 < math.log2(coarse / fine) < 5


CONSTANTS = StepperConstants(resistance=1.0, inductance=1e-3, torque_constant=0.1, teeth=50, inertia=1e-5, creep=0.1)
BRIDGE = DriverConstants(supply=1.0)


def kernel(**changes: float) -> StepperKernel:
    return StepperKernel(CONSTANTS, BRIDGE, np.eye(2), np.zeros(4), **{"step": STEP, **changes})


@pytest.mark.parametrize("step", [0.0, -1.0, math.nan, math.inf, 1e-3])
def test_a_step_the_motor_is_too_quick_for_is_refused(step: float):
    with pytest.raises(ConfigError, match="time step"):
        kernel(step=step)


@pytest.mark.parametrize(
    "times",
    [[1e-3, 0.5e-3], [-1e-3], [math.nan], [math.inf], [0.1, math.nan, 0.2]],
    ids=["falls", "past", "nan", "inf", "hole"],
)
def test_pulses_out_of_order_are_refused(times: list[float]):
    with pytest.raises(LimitError, match="must rise from"):
        kernel().queue(np.array(times), np.ones(len(times), np.int8))


def test_pulses_may_not_come_before_those_queued_or_run():
    motor_kernel = kernel()
    motor_kernel.queue(np.array([0.01]), np.array([1], np.int8))
    with pytest.raises(LimitError):
        motor_kernel.queue(np.array([0.005]), np.array([1], np.int8))
    motor_kernel.run(1000)
    with pytest.raises(LimitError):
        motor_kernel.queue(np.array([0.019]), np.array([1], np.int8))
    motor_kernel.queue(np.array([0.02]), np.array([-1], np.int8))
    assert motor_kernel.run(10).position.tolist() == [0] * 10


@pytest.mark.parametrize("volts", [np.zeros((0, 2)), np.zeros((4, 3)), np.array([[np.nan, 0.0]])])
def test_a_table_that_is_none_is_refused(volts: np.ndarray):
    with pytest.raises(ValueError, match="rows, 2"):
        StepperKernel(CONSTANTS, BRIDGE, volts, np.zeros(4), step=STEP)


@pytest.mark.parametrize(("ticks", "every"), [(-1, 1), (10, 0)])
def test_sizes_that_are_none_are_refused(ticks: int, every: int):
    with pytest.raises(ValueError, match="expected ticks"):
        kernel().run(ticks, every=every)


@pytest.mark.parametrize("signs", [[2], [0], [1, 1]])
def test_a_direction_is_one_or_minus_one(signs: list[int]):
    with pytest.raises(ValueError, match="direction"):
        kernel().queue(np.array([0.1]), np.array(signs, np.int8))
