"""The reluctance stepper's twin: its geometry's steps and direction, closed forms, and steps it loses."""

from __future__ import annotations

import math

import numpy as np
import pytest

from trochia.backends.reluctance_twin import ReluctanceTwin
from trochia.errors import ConfigError
from trochia.machine.motors import ReluctanceStepper, ShaftLoad
from trochia.machine.motors.reluctance_drive import ReluctanceDrive, Switches

FED = Switches(supply=6.0)
#: the textbook's example: 8 poles, 6 teeth, 4 phases; 15 degrees, 24 steps a turn, against the order of excitation
EXAMPLE = ReluctanceStepper(poles=8, teeth=6)


def drive_of(geometry: ReluctanceStepper = EXAMPLE, **changes: float) -> ReluctanceDrive:
    given = {"resistance": 2.0, "aligned": 12e-3, "unaligned": 4e-3, "inertia": 5e-6, "viscous": 8e-4, "friction": 1e-3}
    return ReluctanceDrive(geometry=geometry, **(given | changes))


@pytest.mark.parametrize(("mode", "steps"), [("one-phase", 24), ("two-phase", 24), ("half-step", 48)])
@pytest.mark.parametrize("direction", [1, -1])
def test_a_turn_of_the_example_against_the_order_of_excitation(mode: str, steps: int, direction: int):
    """A, B, C, D turns it one way, by 15 degrees a step; A, D, C, B the other way."""
    twin = ReluctanceTwin(drive_of(), mode, FED)
    assert math.degrees(twin.step_angle) == pytest.approx(-360 / steps)
    twin.queue(0.01 + np.arange(steps) / 40, direction)
    run = twin.run(0.01 + steps / 40 + 0.1)
    begin = run.theta[0]
    assert run.theta[-1] - begin == pytest.approx(-direction * math.tau, abs=math.radians(2))
    half = run.theta[np.searchsorted(run.time, 0.01 + (steps / 2 - 0.05) / 40)]
    assert half - begin == pytest.approx(-direction * math.pi, abs=math.radians(3))
    assert run.lost_steps[-1] == 0


@pytest.mark.parametrize(
    "geometry",
    [ReluctanceStepper(poles=6, teeth=4), ReluctanceStepper(poles=12, teeth=14), ReluctanceStepper(poles=10, teeth=8),
     ReluctanceStepper(poles=12, teeth=16, poles_per_phase=4)],
    ids=["3 phases", "6 phases, along", "5 phases", "3 phases, along"],
)  # fmt: skip
@pytest.mark.parametrize("mode", ["one-phase", "two-phase", "half-step"])
def test_any_number_of_phases_makes_its_steps_its_own_way(geometry: ReluctanceStepper, mode: str):
    twin = ReluctanceTwin(drive_of(geometry), mode, FED)
    pulses = geometry.full_steps * (2 if mode == "half-step" else 1)
    twin.queue(0.01 + np.arange(pulses) / 60)
    run = twin.run(0.01 + pulses / 60 + 0.1, every=10)
    assert run.theta[-1] - run.theta[0] == pytest.approx(geometry.direction * math.tau, abs=math.radians(3))
    assert run.lost_steps[-1] == 0


def test_the_current_rises_in_line_as_in_a_coil():
    run = ReluctanceTwin(drive_of(), "one-phase", FED).run(0.05)
    np.testing.assert_allclose(run.currents[:, 0], 3.0 * (1 - np.exp(-run.time * 2.0 / 12e-3)), rtol=1e-6)
    assert not run.currents[:, 1:].any()
    assert np.abs(run.omega).max() < 1e-12


@pytest.mark.parametrize(("mode", "on"), [("one-phase", 1), ("two-phase", 2)])
def test_small_swings_have_the_closed_forms_frequency(mode: str, on: int):
    """A stiff, slow rotor under a settled current, let go a little off its stable point."""
    motor = drive_of(inertia=2e-3, viscous=0.0, friction=0.0)
    twin = ReluctanceTwin(motor, mode, FED)
    twin.run(0.05)
    push = 0.02 * motor.holding_torque(3.0, on)
    twin.set_load(ShaftLoad(constant=push))
    run = twin.run(3.0, every=5)
    swing = run.theta - run.theta.mean()
    rising = run.time[1:][(swing[:-1] < 0) & (swing[1:] >= 0)]
    assert len(rising) >= 4
    assert (len(rising) - 1) / (rising[-1] - rising[0]) == pytest.approx(motor.resonance(3.0, on=on), rel=5e-3)


@pytest.mark.parametrize(("mode", "on"), [("one-phase", 1), ("two-phase", 2)])
@pytest.mark.parametrize("sense", [1, -1])
def test_it_holds_just_what_the_closed_form_says(mode: str, on: int, sense: int):
    motor = drive_of(friction=0.0, viscous=5e-3)
    hold = motor.holding_torque(3.0, on)
    for part, lost in ((0.97, False), (1.03, True)):
        twin = ReluctanceTwin(motor, mode, FED)
        twin.run(0.05)
        for rise in np.linspace(0.05, 1.0, 20):  # slowly, or it swings over the top
            twin.set_load(ShaftLoad(constant=sense * part * hold * rise))
            twin.run(0.05, every=50)
        run = twin.run(2.0, every=500)
        assert bool(run.lost_steps[-1]) == lost
        if lost:
            assert run.lost_steps[-1] % 4 == 0
            # the load turns it backwards for one sense; the order of excitation runs the other way
            assert np.sign(run.lost_steps[-1]) == -sense


def test_too_quick_a_train_loses_whole_turns_of_the_excitation():
    for rate, lost in ((60.0, False), (3000.0, True)):
        twin = ReluctanceTwin(drive_of(), "one-phase", FED)
        twin.run(0.05)
        twin.queue(twin.now + np.arange(240) / rate)
        run = twin.run(240 / rate + 0.3, every=20)
        assert bool(run.lost_steps[-1]) == lost
        assert run.lost_steps[-1] % 4 == 0
        stood = math.degrees(run.theta[-1] - run.theta[0]) / -15
        assert stood == pytest.approx(240 - run.lost_steps[-1], abs=0.2)


def test_the_quicker_a_phase_is_run_out_the_sooner_its_current_is_gone():
    gone = []
    for switches in (Switches(supply=24.0), Switches(supply=24.0, freewheel=0.7, series=30.0),
                     Switches(supply=24.0, freewheel=0.7)):  # fmt: skip
        twin = ReluctanceTwin(drive_of(resistance=8.0), "one-phase", switches)
        twin.run(0.05)
        twin.queue(np.array([twin.now]))
        run = twin.run(0.05)
        assert run.currents[0, 0] > 2.5
        assert run.currents[-1, 0] == 0.0
        gone.append(float(run.time[np.argmax(run.currents[:, 0] == 0.0)]) - 0.05)
    assert gone[0] < 0.8 * gone[1] < 0.5 * gone[2]


def test_without_current_nothing_holds_it():
    motor = drive_of(friction=0.0)
    run = motor.run(np.zeros((2000, 4), bool), FED, step=200e-6, load=ShaftLoad(constant=1e-3))
    assert run[-1, -2] < -math.tau / 24


def test_what_cannot_be_made_is_named():
    with pytest.raises(ConfigError, match="no distributor makes 'microstep-16'"):
        ReluctanceTwin(drive_of(), "microstep-16", FED)
    with pytest.raises(ConfigError, match="at most 16 phases"):
        ReluctanceTwin(drive_of(ReluctanceStepper(poles=40, teeth=38)), "one-phase", FED)
