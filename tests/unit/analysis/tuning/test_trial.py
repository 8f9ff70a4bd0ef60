"""Moves of a joint under its own loop: figures, refusals, and the feed-forward they suggest."""

from __future__ import annotations

from dataclasses import replace

import pytest

from trochia import api
from trochia.analysis.tuning.trial import Trial, parabola_of, step_of, trial
from trochia.errors import ConfigError, LimitError
from trochia.machine.servos import CascadeLoop, PidLoop, PmacLoop, ThirtySecondsLoop
from trochia.machine.servos.drive import ServoDrive, servo_drive

TRAVEL = (-150.0, 150.0)


def drive_of(machine: str = "xy-table", **gains: object) -> ServoDrive:
    drive = servo_drive(api.load(machine), 0)
    assert drive is not None
    return replace(drive, loop=replace(drive.loop, **gains))


def parabolic(drive: ServoDrive, size: float = 5.0, seconds: float = 0.5) -> Trial:
    wanted = parabola_of(0.0, size, seconds, drive.period, round(0.2 / drive.period))
    return trial(drive, "parabolic", wanted, start=0.0, travel=TRAVEL)


CASCADE = CascadeLoop(position_gain=60.0, speed_gain=0.06, speed_integral=40.0)
PID = PidLoop(kp=8.0, kd=0.05, ki=0.0)


def test_a_step_s_figures() -> None:
    drive = drive_of()
    seen = trial(drive, "step", step_of(0.0, 0.5, 2000), start=0.0, travel=TRAVEL)
    assert seen.step is not None
    assert 0.0 < seen.step.rise < seen.step.settling < 0.8
    assert seen.margins.stable
    assert seen.suggested == {}
    assert set(seen.figures()) >= {"rise_s", "settling_s", "overshoot", "error", "limited_s"}


def test_a_great_step_runs_into_the_current_and_says_so() -> None:
    drive = drive_of(i69=32767, i67=8000000)
    drive = replace(drive, plant=replace(drive.plant, amplifier=replace(drive.plant.amplifier, current=2.0)))
    assert trial(drive, "step", step_of(0.0, 1.0, 4000), start=0.0, travel=TRAVEL).limited > 0.005


def test_a_card_without_feed_forward_is_told_what_its_derivative_gain_is() -> None:
    """The error of speed comes of the damping: i32 = i31 takes it away, as the usual practice says."""
    bare = drive_of(i32=0, i35=0, i65=0)
    before = parabolic(bare)
    assert isinstance(bare.loop, PmacLoop)
    assert before.suggested["i32"] == pytest.approx(bare.loop.i31, rel=0.05)
    assert before.suggested["i35"] == pytest.approx(80600, rel=0.1)  # what the machine's file has
    after = parabolic(replace(bare, loop=replace(bare.loop, i32=int(before.suggested["i32"]),
                                                 i35=int(before.suggested["i35"]))))  # fmt: skip
    assert before.following is not None
    assert after.following is not None
    assert after.following.peak < 0.1 * before.following.peak


@pytest.mark.parametrize("loop", [CASCADE, PID], ids=["cascade", "pid"])
def test_loops_without_feed_forward_are_told_to_take_all_of_it(loop: CascadeLoop | PidLoop) -> None:
    bare = replace(drive_of(), loop=loop)
    before = parabolic(bare)
    names = ("velocity_forward", "acceleration_forward", "friction_forward")
    full = replace(bare, loop=replace(loop, **dict.fromkeys(names, 1.0)))
    assert before.suggested["velocity_forward"] == pytest.approx(1.0, abs=0.1)
    told = parabolic(replace(bare, loop=replace(loop, **{n: before.suggested.get(n, 0.0) for n in names})))
    for better in (parabolic(full), told):
        assert better.following is not None
        assert before.following is not None
        assert better.following.rms < 0.25 * before.following.rms


def test_a_small_chip_s_loop_is_tried_too() -> None:
    drive = drive_of("lathe")
    assert isinstance(drive.loop, ThirtySecondsLoop)
    seen = parabolic(drive, 1.0, 1.0)
    assert seen.following is not None
    assert seen.following.peak < 0.1
    assert seen.suggested == {}


def test_moves_that_would_leave_travel_or_torque_are_refused_before_they_move() -> None:
    drive = drive_of()
    with pytest.raises(LimitError, match="travel is -150 to 150") as raised:
        parabolic(drive, 200.0, 20.0)
    assert "Nothing has moved" in str(raised.value)
    with pytest.raises(LimitError, match="times the torque"):
        parabolic(drive, 50.0, 0.02)


def test_unstable_gains_are_named_and_not_run() -> None:
    with pytest.raises(ConfigError, match="are unstable on its plant: nothing has moved"):
        parabolic(drive_of(i31=0, i30=800000))
