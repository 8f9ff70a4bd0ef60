"""The reluctance stepper's kernel against the plain statement of its equations, and what every block must keep."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from trochia.backends.reluctance_twin import STEP, ReluctanceTwin
from trochia.errors import ConfigError, LimitError
from trochia.kernels.reluctance import ReluctanceConstants, ReluctanceKernel
from trochia.machine.motors import ReluctanceStepper, ShaftLoad
from trochia.machine.motors.reluctance_drive import ReluctanceDrive, Switches
from trochia.pulses.chain import phase_table

TICKS = 300
MOTORS = {
    "four phases": ReluctanceDrive(geometry=ReluctanceStepper(poles=8, teeth=6), resistance=2.0, aligned=12e-3,
                                   unaligned=4e-3, inertia=5e-6),
    "three phases, along": ReluctanceDrive(geometry=ReluctanceStepper(poles=12, teeth=16, poles_per_phase=4),
                                           resistance=1.0, aligned=9e-3, unaligned=3e-3, inertia=2e-6, friction=2e-3,
                                           viscous=1e-4),
}  # fmt: skip
SWITCHES = {
    "to the supply": Switches(supply=12.0),
    "diode and resistor": Switches(supply=9.0, freewheel=0.7, series=5.0),
}
LOADS = {"free": ShaftLoad(), "heavy": ShaftLoad(inertia=1e-6, constant=0.01, friction=0.004, viscous=1e-4)}


def reference(motor, mode, switches, load, pulses):
    """Integrate the public equations by Runge-Kutta, cut where a pulse falls; yield state and position of each tick."""
    table, geometry = phase_table(mode, motor.geometry.phases), motor.geometry
    field = table[0] @ np.exp(2j * np.pi / geometry.phases * np.arange(geometry.phases))
    state = np.zeros(geometry.phases + 2)
    state[-2] = geometry.direction * np.angle(field) / geometry.teeth
    position = 0
    for tick in range(TICKS):
        begin, end = tick * STEP, (tick + 1) * STEP
        inside = [pulse for pulse in pulses if begin <= pulse[0] < end]
        cuts = [begin, *(at for at, _ in inside), end]
        for part, (a, b) in enumerate(pairwise(cuts)):
            position += inside[part - 1][1] if part else 0
            if b > a:
                on = table[position % len(table)][None]
                state = motor.run(on, switches, step=b - a, load=load, state=state)[0]
        yield state, position


@pytest.mark.parametrize("name", MOTORS)
@pytest.mark.parametrize("fed", SWITCHES)
@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("mode", ["one-phase", "two-phase", "half-step"])
def test_kernel_equals_the_public_equations(name: str, fed: str, load: str, mode: str):
    motor = MOTORS[name]
    rng = np.random.default_rng(11)
    times = np.sort(np.concatenate([rng.uniform(0, TICKS * STEP, 8), [0.0, 40 * STEP, 40 * STEP, 41 * STEP]]))
    twin = ReluctanceTwin(motor, mode, SWITCHES[fed], LOADS[load])
    twin.queue(times[:7], 1)
    twin.queue(times[7:], -1)
    run = twin.run(TICKS * STEP)
    signs = np.where(np.arange(len(times)) < 7, 1, -1)
    pulses = list(zip(times.tolist(), signs.tolist(), strict=True))
    expected = list(reference(motor, mode, SWITCHES[fed], LOADS[load], pulses))
    states = np.array([state for state, _ in expected])
    np.testing.assert_allclose(run.currents, states[:, :-2], rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(run.theta, states[:, -2], rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(run.omega, states[:, -1], rtol=1e-9, atol=1e-8)
    assert run.position.tolist() == [position for _, position in expected]


def test_any_cut_into_blocks_and_any_sampling_gives_the_same():
    def made(blocks: list[int], every: int = 1) -> np.ndarray:
        twin = ReluctanceTwin(MOTORS["four phases"], "half-step", SWITCHES["to the supply"])
        twin.queue(np.arange(1, 60) * 171.7e-6)
        runs = [twin.run(ticks * STEP, every=every) for ticks in blocks]
        return np.concatenate([np.column_stack([r.time, r.theta, r.omega, r.currents, r.position]) for r in runs])

    whole = made([500])
    np.testing.assert_array_equal(made([1, 7, 100, 92, 300]), whole)
    np.testing.assert_array_equal(made([200, 300], every=10), whole[9::10])


def test_energy_is_kept():
    """What the supply gave, less what it got back, is in the windings, in the rotor, at the load, or heat."""
    motor, step, load = MOTORS["four phases"], 2e-6, ShaftLoad(constant=0.01, viscous=1e-4)
    switches = Switches(supply=12.0)
    twin = ReluctanceTwin(motor, "one-phase", switches, load, step=step)
    twin.queue(np.arange(1000, 20000, 1500) * step)
    run = twin.run(0.05)
    on = phase_table("one-phase", 4)[run.position % 4]

    def between(x: np.ndarray) -> np.ndarray:
        return (x[1:] + x[:-1]) / 2

    volts = np.where(on, 12.0, np.where(run.currents > 0, -12.0, 0.0))[1:]
    given = float((volts * between(run.currents)).sum() * step)
    heat = float(between(2.0 * (run.currents**2).sum(axis=1) + 1e-4 * run.omega**2).sum() * step)
    lifted = 0.01 * float(run.theta[-1] - run.theta[0])
    stored = 0.5 * (motor.inductance(run.theta) * run.currents**2).sum(axis=1) + 0.5 * 5e-6 * run.omega**2
    assert abs(lifted) > 1e-3
    assert given == pytest.approx(heat + lifted + float(stored[-1] - stored[0]), rel=2e-4)


CONSTANTS = ReluctanceConstants(phases=4, resistance=2.0, mean=8e-3, swing=4e-3, teeth=6, shift=-math.pi / 2,
                                supply=12.0, against=12.0, series=0.0, inertia=5e-6, creep=0.1)  # fmt: skip
TABLE = phase_table("one-phase", 4)


def test_what_the_core_cannot_do_is_refused():
    with pytest.raises(ConfigError, match="at most 16 phases"):
        ReluctanceKernel(replace(CONSTANTS, phases=17), phase_table("one-phase", 17), theta=0.0, step=STEP)
    for step in (0.0, -1.0, math.nan, 2e-3):
        with pytest.raises(ConfigError, match="time step"):
            ReluctanceKernel(CONSTANTS, TABLE, theta=0.0, step=step)
    with pytest.raises(ValueError, match="rows, 4"):
        ReluctanceKernel(CONSTANTS, TABLE[:, :3], theta=0.0, step=STEP)
    kernel = ReluctanceKernel(CONSTANTS, TABLE, theta=0.0, step=STEP)
    with pytest.raises(ValueError, match="expected 4 phases"):
        kernel.set_constants(replace(CONSTANTS, phases=3))
    for times in ([1e-3, 0.5e-3], [-1e-3], [math.nan], [math.inf]):
        with pytest.raises(LimitError, match="must rise from"):
            kernel.queue(np.array(times), np.ones(len(times), np.int8))
    for signs in ([2], [0], [1, 1]):
        with pytest.raises(ValueError, match="direction"):
            kernel.queue(np.array([0.1]), np.array(signs, np.int8))
    for ticks, every in ((-1, 1), (10, 0)):
        with pytest.raises(ValueError, match="expected ticks"):
            kernel.run(ticks, every=every)


def test_a_state_that_is_no_number_is_told():
    kernel = ReluctanceKernel(replace(CONSTANTS, load=math.nan), TABLE, theta=0.0, step=STEP)
    with pytest.raises(LimitError, match="no longer a number"):
        kernel.run(10)
