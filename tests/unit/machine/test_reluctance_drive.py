"""Variable reluctance dynamics: energy, closed forms, and steps in the right direction."""

from __future__ import annotations

import math

import numpy as np
import pytest

from trochia.errors import ConfigError
from trochia.machine.motors import ReluctanceStepper, ShaftLoad
from trochia.machine.motors.reluctance_drive import ReluctanceDrive, Switches

GEOMETRIES = [
    ReluctanceStepper(poles=8, teeth=6),
    ReluctanceStepper(poles=12, teeth=14),
    ReluctanceStepper(poles=6, teeth=4),
]


FED = Switches(supply=6.0)


def phases_on(phases: list[int] | np.ndarray, of: int) -> np.ndarray:
    """Return which phases are on (steps, phases) where one is at a time."""
    return np.asarray(phases)[:, None] == np.arange(of)


def drive_of(geometry: ReluctanceStepper) -> ReluctanceDrive:
    return ReluctanceDrive(
        geometry=geometry, resistance=2.0, aligned=12e-3, unaligned=4e-3, inertia=5e-6, viscous=8e-4, friction=1e-3
    )


def test_torque_is_the_slope_of_the_co_energy():
    motor = drive_of(GEOMETRIES[0])
    currents, theta = np.array([1.2, 0.3, 0.0, 0.7]), np.array(0.11)

    def energy(x: float) -> float:
        return float(0.5 * (currents**2 * motor.inductance(np.array(x))).sum())

    slope = (energy(0.11 + 1e-6) - energy(0.11 - 1e-6)) / 2e-6
    assert float(motor.torque(currents, theta)) == pytest.approx(slope, rel=1e-6)


def test_holding_torque_is_the_greatest_over_a_tooth():
    motor = drive_of(GEOMETRIES[1])
    angle = np.linspace(0, math.tau / 14, 2001)
    currents = np.zeros((2001, motor.geometry.phases))
    currents[:, 0] = 1.5
    assert motor.torque(currents, angle).max() == pytest.approx(motor.holding_torque(1.5), rel=1e-5)


@pytest.mark.parametrize("geometry", GEOMETRIES)
@pytest.mark.parametrize("on", [1, 2])
def test_holding_torque_of_neighbours_is_half_i_squared_times_the_greatest_slope(geometry: ReluctanceStepper, on: int):
    motor = drive_of(geometry)
    theta = np.linspace(0, math.tau / geometry.teeth, 20001)
    currents = np.zeros((len(theta), geometry.phases))
    currents[:, :on] = 1.5
    slope = motor.slope(theta)[:, :on].sum(axis=1)
    assert motor.holding_torque(1.5, on) == pytest.approx(0.5 * 1.5**2 * slope.max(), rel=1e-6)
    assert motor.torque(currents, theta).max() == pytest.approx(motor.holding_torque(1.5, on), rel=1e-6)


def test_two_phases_of_four_hold_as_much_more_as_a_hybrid_and_of_three_no_more():
    four, three = drive_of(GEOMETRIES[0]), drive_of(GEOMETRIES[2])
    assert four.holding_torque(1.0, 2) == pytest.approx(math.sqrt(2) * four.holding_torque(1.0))
    assert three.holding_torque(1.0, 2) == pytest.approx(three.holding_torque(1.0))
    for on in (0, 3):
        with pytest.raises(ConfigError, match="between 1 and 2 of 3"):
            three.holding_torque(1.0, on)


def test_an_opened_phase_runs_its_current_out_against_the_diode_and_then_blocks():
    """L di/dt = -R i - V with the rotor held: the current is gone after L/R ln(1 + R i/V), and stays so."""
    motor = ReluctanceDrive(geometry=GEOMETRIES[0], resistance=2.0, aligned=12e-3, unaligned=4e-3, inertia=1e3)
    begin = np.array([3.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    for volts, series in ((6.0, 0.0), (0.7, 0.0), (0.7, 10.0)):
        run = motor.run(np.zeros((1500, 4), bool), Switches(supply=6.0, freewheel=volts, series=series), step=20e-6,
                        state=begin)  # fmt: skip
        gone = 20e-6 * (1 + np.argmax(run[:, 0] == 0.0))
        r = 2.0 + series
        assert gone == pytest.approx(12e-3 / r * math.log1p(r * 3.0 / volts), abs=40e-6)
        assert not run[-1, :4].any()


@pytest.mark.parametrize(
    ("values", "says"),
    [({"supply": 0.0}, "above zero"), ({"supply": 6.0, "freewheel": -1.0}, "takes energy"),
     ({"supply": 6.0, "series": math.nan}, "takes energy")],
)  # fmt: skip
def test_switches_that_cannot_be_are_named(values: dict[str, float], says: str):
    with pytest.raises(ConfigError, match=says):
        Switches(**values)


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_a_turn_of_excitation_moves_one_tooth_pitch_its_own_way(geometry: ReluctanceStepper):
    motor = drive_of(geometry)
    per_step, step = 800, 50e-6
    phase = np.repeat(np.arange(geometry.phases + 1) % geometry.phases, per_step)
    run = motor.run(phases_on(phase, geometry.phases), FED, step=step)
    at = run[per_step - 1 :: per_step, -2]
    expected = geometry.direction * math.radians(float(geometry.step_angle_deg)) * np.arange(geometry.phases + 1)
    assert at == pytest.approx(expected, abs=0.1 * abs(expected[1]))
    assert run[:, : geometry.phases].min() >= 0.0


def test_a_load_above_the_holding_torque_is_not_held():
    motor = drive_of(GEOMETRIES[0])
    hold = motor.holding_torque(3.0)  # 6 V over 2 ohm
    on = phases_on([0] * 2000, 4)
    held = motor.run(on, FED, step=50e-6, load=ShaftLoad(constant=0.5 * hold))[-1, -2]
    lost = motor.run(on, FED, step=50e-6, load=ShaftLoad(constant=1.2 * hold))[-1, -2]
    pitch = math.tau / 6
    assert held == pytest.approx(-math.asin(0.5) / 6, rel=0.05)
    assert lost < -pitch


def test_absurd_values_are_named():
    with pytest.raises(ConfigError, match="out of line"):
        ReluctanceDrive(geometry=GEOMETRIES[0], resistance=2.0, aligned=4e-3, unaligned=12e-3, inertia=5e-6)
    with pytest.raises(ConfigError, match="above zero"):
        ReluctanceDrive(geometry=GEOMETRIES[0], resistance=0.0, aligned=12e-3, unaligned=4e-3, inertia=5e-6)
