"""What a move may not be, torque curves, time boxes, verdicts: each with the number that would do."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from trochia.analysis.stepper_picture import picture
from trochia.errors import ConfigError, LimitError
from trochia.pulses.ramps import Demand, Requirement, TorqueCurve, profile, read_curve, verdict
from trochia.pulses.ramps.torque import Pieces, legs

if TYPE_CHECKING:
    from pathlib import Path

MOVE = Demand(steps=400, speed=2000 / 3, acceleration=3000.0)
FLAT = TorqueCurve(speeds=(1000.0,), torques=(0.2,))
FALLING = TorqueCurve(speeds=(0.0, 200.0, 500.0, 900.0), torques=(0.3, 0.28, 0.2, 0.02))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"steps": 0}, "1 to 1000000"),
        ({"speed": 0.0}, "speed must be more than 0"),
        ({"speed": 1e-300}, "speed must be from 1e-12 to 1e\\+12"),
        ({"acceleration": 1e300}, "acceleration must be from 1e-12 to 1e\\+12"),
        ({"acceleration": -1.0}, "acceleration must be more than 0"),
        ({"inertia": float("inf")}, "inertia"),
        ({"load": -1.0}, "load torque"),
        ({"speed": 2e6}, "timer's clock of 1e\\+06 Hz"),
        ({"steps_per_turn": 0}, "a turn has"),
    ],
)
def test_absurd_demands_are_refused(changes: dict[str, float], words: str):
    with pytest.raises(LimitError, match=words):
        replace(MOVE, **changes)


def test_a_law_that_is_not_there():
    with pytest.raises(LimitError, match="cubic"):
        profile(MOVE, "cubic")


def test_a_law_without_acceleration():
    with pytest.raises(LimitError, match="needs an acceleration"):
        profile(replace(MOVE, acceleration=None))


@pytest.mark.parametrize("law", ["exact", "austin", "library"])
@pytest.mark.parametrize("end", ["first", "last"])
def test_start_stop_names_an_acceleration_that_does(law: str, end: str):
    limit = 30.0
    given = replace(MOVE, start_stop=limit)
    if end == "last":
        given = replace(given, acceleration=400.0 if law == "library" else 500.0, deceleration=20_000.0)
    with pytest.raises(LimitError, match=f"the {end} step is made at") as caught:
        profile(given, law)
    cure = float(re.search(r"An? \w+ of ([\d.e+]+) steps/s²", str(caught.value))[1])
    given = replace(given, start_stop=None)
    mended = replace(given, acceleration=cure) if end == "first" else replace(given, deceleration=cure)
    assert profile(mended, law).speeds[0 if end == "first" else -1] <= limit * (1 + 1e-3)


def test_acceleration_too_high_for_the_torque():
    given = replace(MOVE, speed=300.0, curve=FALLING, load=0.05, inertia=1e-3)
    least = 0.28 - 0.08 / 3 - 0.05  # at 300 steps/s
    most = least / (1e-3 * given.step_angle)
    profile(replace(given, acceleration=0.999 * most))
    with pytest.raises(LimitError, match=re.escape(f"At most {most:.4g} steps/s²")):
        profile(replace(given, acceleration=1.001 * most))


@pytest.mark.parametrize("law", ["exact", "torque"])
def test_speed_out_of_reach(law: str):
    given = replace(MOVE, speed=890.0, curve=FALLING, load=0.11, inertia=1e-6, steps=100_000)
    with pytest.raises(LimitError, match="700 steps/s") as caught:  # 0.2 - 0.18 (f - 500)/400 = 0.11
        profile(given, law)
    assert "At most 665 steps/s" in str(caught.value)


def test_a_load_that_holds_the_motor():
    with pytest.raises(LimitError, match="holds the motor"):
        profile(replace(MOVE, curve=FALLING, load=0.3, inertia=1e-6), "torque")


@pytest.mark.parametrize(("missing", "word"), [("curve", "torque curve"), ("inertia", "inertia")])
def test_the_torque_law_names_what_it_needs(missing: str, word: str):
    given = replace(MOVE, curve=FLAT, inertia=1e-4)
    with pytest.raises(LimitError, match=word):
        profile(replace(given, **{missing: None}), "torque")


def test_flat_torque_is_constant_acceleration():
    inertia, load = 1e-3, 0.05
    angle = MOVE.step_angle
    even = replace(MOVE, acceleration=0.15 / (inertia * angle), deceleration=0.25 / (inertia * angle))
    by_torque = profile(replace(MOVE, curve=FLAT, load=load, inertia=inertia), "torque")
    assert by_torque.delays == pytest.approx(profile(even).delays, rel=1e-9)


def test_torque_legs_against_quadrature():
    given = replace(MOVE, speed=690.0, curve=FALLING, load=0.1, inertia=1e-3)
    for leg, sign in zip(legs(given), (-1.0, 1.0), strict=True):
        assert isinstance(leg, Pieces)
        speeds = np.linspace(0.0, 690.0, 400_001)
        slowness = 1e-3 * given.step_angle / (np.interp(speeds, FALLING.speeds, FALLING.torques) + sign * 0.1)
        assert leg.duration(690.0) == pytest.approx(np.trapezoid(slowness, speeds), rel=1e-8)
        assert leg.length(690.0) == pytest.approx(np.trapezoid(slowness * speeds, speeds), rel=1e-8)
        place = leg.length(600.0)
        assert leg.times(np.array([0.0, place])) == pytest.approx([0.0, leg.duration(600.0)], rel=1e-9)


@pytest.mark.parametrize("law", ["exact", "linear", "austin", "library"])
@pytest.mark.parametrize("time", [0.65, 0.75, 1.1])
def test_a_time_box_is_met(law: str, time: float):
    kept = profile(replace(MOVE, acceleration=8000.0), law, time_box=time)
    alike = profile(replace(MOVE, acceleration=None), law, time_box=time)
    assert kept.demand.rising == 8000.0
    assert alike.demand.rising == alike.demand.falling
    slack = 0.005 if law in {"austin", "library"} else 1e-9  # a braking ramp of whole steps meets no time exactly
    assert (kept.duration, alike.duration) == pytest.approx((time, time), rel=slack)


def test_a_time_box_too_small_for_the_speed():
    with pytest.raises(LimitError, match=r"1000 steps/s.*666.7 steps/s"):
        profile(MOVE, time_box=0.4)


def test_a_time_box_too_small_for_the_acceleration():
    with pytest.raises(LimitError, match="braking in no time at all") as caught:
        profile(replace(MOVE, acceleration=1000.0), time_box=0.65)
    cure = float(re.search(r"([\d.e+]+) steps/s² .* up and\s+down would do", str(caught.value))[1])
    assert profile(replace(MOVE, acceleration=cure)).duration == pytest.approx(0.65, rel=1e-3)


def test_no_time_box_for_the_torque_law():
    with pytest.raises(LimitError, match="no time box"):
        profile(replace(MOVE, curve=FLAT, inertia=1e-4), "torque", time_box=1.0)


def test_verdicts():
    made = profile(MOVE, "austin")
    assert verdict(made).ok
    assert verdict(made, Requirement(time=0.8)).ok
    late = verdict(made, Requirement(time=0.7))
    assert (late.ok, "longer" in late.reason) == (False, True)
    cure = float(re.search(r"With ([\d.e+]+) steps/s²", late.remedy or "")[1])
    assert profile(replace(MOVE, acceleration=cure), "austin").duration == pytest.approx(0.7, rel=0.005)
    early = verdict(made, Requirement(time=2.0))
    assert (early.ok, "shorter" in early.reason) == (False, True)
    never = verdict(made, Requirement(time=0.5))
    assert "800 steps/s" in (never.remedy or "")  # 400 in 0.5 s
    slow = verdict(replace(made, demand=replace(MOVE, start_stop=60.0)), Requirement(time=0.7))
    assert "the first step is made at" in (slow.remedy or "")


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("", 1, "the first line must name"),
        ("rpm,Nm\n1,2\n", 1, "speed_rpm,torque_Nm"),
        ("speed_rpm,torque_Nm\n", 1, "1 to 10000 points"),
        ("speed_rpm,torque_Nm\n0,0.2\n10,x\n", 3, "10,x"),
        ("speed_rpm,torque_Nm\n0,0.2,1\n", 2, "0,0.2,1"),
        ("speed_rpm,torque_Nm\n10,0.2\n10,0.1\n", 3, "does not rise"),
        ("speed_rpm,torque_Nm\n0,-0.2\n", 2, "at least 0"),
        ("speed_rpm,torque_Nm\n0,nan\n", 2, "at least 0"),
        ("speed_rpm,torque_Nm\n5,1\n4,1\n", 3, "does not rise"),
    ],
)
def test_torque_curve_files_that_cannot_be(tmp_path: Path, text: str, line: int, words: str):
    file = tmp_path / "curve.csv"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(ConfigError, match=re.escape(words)) as caught:
        read_curve(file, 200)
    assert caught.value.source is not None
    assert caught.value.source.line == line


def test_a_torque_curve_that_is_no_text(tmp_path: Path):
    file = tmp_path / "curve.csv"
    file.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ConfigError, match="CSV"):
        read_curve(file, 200)


def test_torque_curve_units(tmp_path: Path):
    file = tmp_path / "curve.csv"
    file.write_text("speed_rpm,torque_mNm\n60,200\n\n120,100\n", encoding="utf-8")
    curve = read_curve(file, 200)
    assert curve.speeds == pytest.approx((200.0, 400.0))
    assert [curve.torque(at) for at in (0.0, 300.0, 400.0, 401.0)] == pytest.approx([0.2, 0.15, 0.1, 0.0])


def test_picture_is_drawn_for_all_laws():
    given = replace(MOVE, curve=FLAT, inertia=1e-4, start_stop=300.0)
    made = [profile(given, law) for law in ("exact", "torque")]
    assert picture(made, Requirement(time=0.8)).startswith(b"\x89PNG")
    assert picture([profile(replace(MOVE, steps=1))]).startswith(b"\x89PNG")
