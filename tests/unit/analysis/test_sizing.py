"""Sizing against mechanics done by hand."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from trochia.analysis.sizing import Duty, duty_of_move, size_by_duty
from trochia.errors import LimitError
from trochia.machine.load import loads
from trochia.machine.torque import Drive, drive

STAGE = (Path(__file__).parents[2] / "golden" / "machines" / "stage.toml").read_text(encoding="utf-8")
ARM = 0.04 / math.tau  # m a radian


def motor_of(text: str = STAGE) -> Drive:
    found = drive(loads(text), 0)
    assert found is not None
    return found


def test_a_duty_by_hand():
    inertia = 209e-7 + 2 * ARM**2
    accelerating = inertia * 1.0 / ARM + 10 * ARM
    sizing = size_by_duty(motor_of(), Duty(velocity=100.0, acceleration=1000.0, turning=0.5, ramping=0.4))
    assert sizing.speed == pytest.approx(0.1 / ARM)
    assert sizing.torque == pytest.approx(accelerating)
    assert sizing.inertia_ratio == pytest.approx(2 * ARM**2 / 209e-7)
    braking = inertia * 1.0 / ARM - 10 * ARM
    mean = 0.4 * (accelerating**2 + braking**2) / 2 + 0.6 * (10 * ARM) ** 2
    assert sizing.effective == pytest.approx(math.sqrt(0.5 * mean))
    assert sizing.used == pytest.approx(accelerating / sizing.available)
    assert sizing.ok


def test_a_move_in_thirds():
    """A third of the time for each: 3 d/2 t at most, which 9 d/2 t² reach in t/3."""
    duty = duty_of_move(120.0, 0.6, 0.4)
    assert duty.velocity == pytest.approx(300.0)
    assert duty.velocity / duty.acceleration == pytest.approx(0.2)
    assert duty.velocity * (0.6 - 0.2) == pytest.approx(120.0)
    assert duty.turning == pytest.approx(0.6)


def test_what_will_not_do_names_what_would():
    weak = size_by_duty(motor_of(), Duty(velocity=200.0, acceleration=30000.0))
    assert not weak.ok
    assert f"{weak.torque / 0.7:.3g} N·m there would do" in weak.problems[0]
    heavy = motor_of(STAGE.replace("10 N", "40 N"))
    fast = size_by_duty(heavy, Duty(velocity=1.1 * heavy.greatest_velocity, acceleration=1.0))
    assert f"at most {heavy.greatest_velocity / 40 * 60:.0f} rpm would do" in fast.problems[0]
    hot = size_by_duty(motor_of(STAGE.replace("2.8 A", "5 A")), Duty(velocity=10.0, acceleration=10.0))
    assert "the motor heats with 20 W, its rated current with 14.4 W" in hot.problems[0]
    slack = size_by_duty(motor_of(STAGE.replace("2 kg", "50 kg")), Duty(velocity=10.0, acceleration=10.0))
    assert slack.ok
    assert "times the rotor's inertia" in slack.remarks[0]


@pytest.mark.parametrize(
    ("velocity", "acceleration", "turning"), [(0.0, 1.0, 1.0), (1.0, -1.0, 1.0), (1.0, 1.0, 1.5), (math.inf, 1.0, 1.0)]
)
def test_absurd_duties_are_refused(velocity: float, acceleration: float, turning: float):
    with pytest.raises(LimitError):
        Duty(velocity=velocity, acceleration=acceleration, turning=turning)
    with pytest.raises(LimitError):
        duty_of_move(0.0, 1.0)
