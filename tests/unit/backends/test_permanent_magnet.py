"""Permanent magnet steppers: the hybrid's equations with a magnet's pole pairs, typed in as a catalogue's row."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from trochia.backends.stepper_twin import StepperTwin
from trochia.machine.drivers import Chopper, HBridge, fed
from trochia.machine.motors import ShaftLoad, motor, rows_of
from trochia.machine.motors.wiring import wired
from trochia.pulses.excitation import excitation

TIN_CAN = replace(motor("9904-112-35014"), detent_torque=8e-3, friction=1e-3)


def bridged(stepper, mode: str, volts: float):
    """Return a motor behind a bridge without a drop."""
    return fed(stepper, HBridge(supply=volts, drop=0.0, excitation=mode), excitation(mode).steps_per_full_step)


def typed(full_steps: int):
    """Return a small tin can of so many steps, from a row as a user types it."""
    text = f"""
[motors.mine]
kind = "permanent-magnet"
full_steps = {full_steps}
resistance = "50 ohm"
inductance = "{1500 / full_steps:.4g} mH"
current = "0.1 A"
holding_torque = "4 mN·m"
detent_torque = "6 gf·cm"
inertia = "1 g·cm²"
"""
    return rows_of(text)["mine"].parameters()


@pytest.mark.parametrize(("full_steps", "degrees"), [(20, 18.0), (24, 15.0), (48, 7.5), (96, 3.75), (32, 11.25)])
@pytest.mark.parametrize("mode", ["one-phase", "two-phase", "half-step", "microstep-4"])
def test_any_tin_can_turns_a_turn_in_its_own_steps(full_steps: int, degrees: float, mode: str):
    stepper, table = typed(full_steps), excitation(mode)
    assert math.degrees(stepper.step_angle) == pytest.approx(degrees)
    twin = StepperTwin(bridged(stepper, mode, 5.0), ShaftLoad(viscous=4e-6))
    begin = twin.run(0.5).theta[-1]
    pulses = full_steps * table.steps_per_full_step
    twin.queue(twin.now + np.arange(pulses) / (20 * table.steps_per_full_step))
    run = twin.run(full_steps / 20 + 0.5, every=50)
    assert run.lost_steps[-1] == 0
    assert run.theta[-1] - begin == pytest.approx(math.tau, abs=0.03 * stepper.step_angle)


def unpowered(load: float) -> float:
    """Return where a load takes the tin can that is switched off [full steps]."""
    made = fed(TIN_CAN.parameters(), Chopper(supply=24.0, current=0.24, excitation="one-phase"), 1)
    twin = StepperTwin(made, ShaftLoad(constant=load, viscous=2e-5), enabled=False)
    return float(twin.run(1.0, every=100).theta[-1]) / made.motor.step_angle


def test_the_detent_holds_it_without_power_up_to_the_detent_torque():
    assert abs(unpowered(0.0)) < 1e-9
    for load in (3e-3, 6e-3):  # less than detent and friction together; the rotor gives way as the sine says, or less
        assert 0 <= -unpowered(load) <= math.asin(load / 8e-3) / math.tau + 0.02
    assert -unpowered(11e-3) > 4.0


def test_a_hybrid_without_detent_is_held_by_nothing():
    made = fed(replace(TIN_CAN, detent_torque=0.0, friction=0.0).parameters(), Chopper(supply=24.0, current=0.24), 16)
    twin = StepperTwin(made, ShaftLoad(constant=1e-4), enabled=False)
    assert twin.run(1.0, every=100).theta[-1] < -4 * made.motor.step_angle


def test_microsteps_of_unequal_amplitudes_divide_its_step_electrically():
    """Amplitudes as cosine and sine keep the resultant field constant: a step of 7.5 degrees in four equal parts."""
    stepper = replace(TIN_CAN, detent_torque=0.0, friction=0.0).parameters()
    table = excitation("microstep-4")
    np.testing.assert_allclose(np.hypot(*table.levels.T), 1.0)
    twin = StepperTwin(bridged(stepper, "microstep-4", 11.0), ShaftLoad(viscous=2e-3))
    ends = [float(twin.run(0.3, every=100).theta[-1])]
    for _ in range(4):
        twin.queue(np.array([twin.now]))
        ends.append(float(twin.run(0.3, every=100).theta[-1]))
    np.testing.assert_allclose(np.degrees(np.diff(ends)), 7.5 / 4, rtol=1e-3)


def test_unipolar_wiring_leaves_the_row_and_series_gives_the_root_of_two():
    half = TIN_CAN.parameters()
    unipolar, series = wired(half, "unipolar"), wired(half, "series")
    assert unipolar == half
    torque = [made.torque_constant * made.current for made in (unipolar, series)]
    assert torque[1] / torque[0] == pytest.approx(math.sqrt(2))
