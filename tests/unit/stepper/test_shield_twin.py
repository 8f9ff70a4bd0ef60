"""The shield's motors as twins, in every way of excitation; the picture of what ran."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from trochia.errors import ConfigError
from trochia.stepper import (
    BACKWARD,
    DOUBLE,
    FORWARD,
    INTERLEAVE,
    MICROSTEP,
    SINGLE,
    Kept,
    Shield,
    ShieldMotor,
    ShieldTwin,
    Stepper,
    Style,
    VirtualTime,
)
from trochia.stepper.picture import figure, picture

if TYPE_CHECKING:
    from pathlib import Path


def made(rpm: float, *, keep: bool = False) -> tuple[ShieldMotor, ShieldTwin]:
    shield = Shield(VirtualTime())
    twin = shield.twins[2] = ShieldTwin(keep=keep)
    motor = shield.motor(2)
    motor.set_speed(rpm)
    return motor, twin


@pytest.mark.parametrize("style", list(Style), ids=lambda style: style.name)
def test_the_rotor_goes_where_the_steps_have_it(style: Style):
    """100 steps are 180 degrees, of half steps 90; the first falls in with the excitation's own sectors."""
    motor, twin = made(60)
    motor.step(1, FORWARD, style)
    motor.shield.time.wait_until(motor.shield.time.now + 0.2)
    begin = twin.look(motor.shield.time.now).angle
    motor.step(100, FORWARD, style)
    motor.shield.time.wait_until(motor.shield.time.now + 0.3)
    seen = twin.look(motor.shield.time.now)
    assert seen.angle - begin == pytest.approx(90 if style is INTERLEAVE else 180, abs=0.2)
    assert seen.angle == pytest.approx(seen.asked, abs=0.4)
    assert seen.lost == 0


def test_styles_one_after_another_and_back():
    motor, twin = made(30)
    for style in (SINGLE, MICROSTEP, DOUBLE, INTERLEAVE, MICROSTEP, SINGLE):
        motor.step(20, FORWARD, style)
    for style in (MICROSTEP, SINGLE):
        motor.step(20, BACKWARD, style)
    motor.shield.time.wait_until(motor.shield.time.now + 0.3)
    seen = twin.look(motor.shield.time.now)
    assert seen.asked == pytest.approx(1.8 * motor.position / 16 % 7.2 + seen.asked // 7.2 * 7.2)
    assert seen.angle == pytest.approx(seen.asked, abs=0.4)
    assert seen.lost == 0


def test_too_fast_from_rest_loses_steps_and_says_so():
    motor, twin = made(500)
    motor.step(400, FORWARD, DOUBLE)
    motor.shield.time.wait_until(motor.shield.time.now + 0.3)
    seen = twin.look(motor.shield.time.now)
    assert seen.lost > 0
    assert seen.lost % 4 == 0
    assert seen.asked - seen.angle == pytest.approx(1.8 * seen.lost, abs=2)
    assert f"{seen.lost} steps lost" in str(seen)


def test_released_windings_brake_and_the_next_step_takes_hold():
    motor, twin = made(60)
    motor.step(10, FORWARD, DOUBLE)
    motor.release()
    now = motor.shield.time.now
    assert np.abs(twin.settle(now + 0.5).currents[-1]).max() < 1e-3
    motor.shield.time.wait_until(now + 0.5)
    motor.step(10, FORWARD, DOUBLE)
    motor.shield.time.wait_until(now + 1)
    assert twin.look(now + 1).lost == 0
    assert np.abs(twin.settle(now + 1.1).currents[-1]).min() == pytest.approx(9.4 / 34, rel=0.01)


def test_speed_is_the_mean_since_the_last_look():
    motor, twin = made(90)
    motor.step(200, FORWARD, DOUBLE)
    twin.look(motor.shield.time.now)
    motor.step(200, FORWARD, DOUBLE)
    assert twin.look(motor.shield.time.now).rpm == pytest.approx(90, rel=0.02)


def test_a_figure_shows_what_ran(tmp_path: Path):
    motor, twin = made(60, keep=True)
    motor.step(200, FORWARD, DOUBLE)
    twin.look(motor.shield.time.now + 0.2)
    shown = figure(twin)
    position, speed, lost = shown.axes
    asked, rotor = (line.get_ydata() for line in position.lines)
    assert asked[-1] == pytest.approx(359.1, abs=0.01)  # type: ignore[index]
    assert rotor[-1] == pytest.approx(359.1, abs=0.3)  # type: ignore[index]
    assert np.median(speed.lines[1].get_ydata()) == pytest.approx(60, abs=3)
    assert set(lost.lines[0].get_ydata()) == {0}
    assert position.get_ylabel() == "position [degrees]"
    assert picture(tmp_path / "it.png", twin).read_bytes().startswith(b"\x89PNG")


def test_a_figure_of_steps_alone_and_of_several():
    kept = Kept()
    stepper = Stepper(kept, VirtualTime())
    stepper.set_max_speed(400)
    stepper.set_acceleration(800)
    stepper.run_to_new_position(-200)
    shown = figure(kept, kept)
    assert len(shown.axes) == 6
    assert shown.axes[0].lines[0].get_ydata()[-1] == -360  # type: ignore[index]


def test_what_cannot_be_drawn_is_named():
    with pytest.raises(ConfigError, match="needs a motor"):
        figure()
    with pytest.raises(ConfigError, match="kept nothing"):
        figure(made(60)[1])
