"""Input shapers against the closed form of what they leave, a swinging axis, and the limits of what they shape."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from scipy.signal import lsim

from trochia.analysis.shaped import deviation
from trochia.errors import ConfigError, LimitError
from trochia.languages import gcode
from trochia.machine.axes import PathLimits
from trochia.machine.load import load
from trochia.machine.resonance import SHAPERS as NAMES
from trochia.machine.resonance import Resonance
from trochia.planner import PROFILES, SHAPERS, plan
from trochia.planner.shaping import train
from trochia.planner.timed import fitted
from trochia.toolpath import build

MILL = load("reference-mill")
BELTS = load("corexy")
CORNER = "G64 P0.05\nF6000\nG1 X30\nG3 X40 Y10 J10\nG1 Y30 X20\nG0 X0 Y0 Z5"


def shaped(machine, **resonances):
    axes = tuple(dataclasses.replace(axis, resonance=resonances.get(axis.name)) for axis in machine.axes)
    return dataclasses.replace(machine, axes=axes)


def planned(text, machine, profile="s-curve"):
    program = gcode.read(text + "\nM2\n")
    path = build(program, machine, continuity=PROFILES[profile].continuity)
    return plan(path, machine, program=program, profile=profile)


def resonance(name, frequency=40.0, damping=0.1):
    return Resonance(frequency=frequency, damping=damping, shaper=name)


def test_every_name_has_its_impulses():
    assert set(NAMES) == set(SHAPERS)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("damping", [0.0, 0.05, 0.3])
def test_impulses_are_a_mean_and_leave_little_at_their_frequency(name, damping):
    impulses = train(resonance(name, 40.0, damping))
    assert sum(impulses.amplitudes) == pytest.approx(1.0, abs=1e-15)
    assert min(impulses.amplitudes) > 0.0
    assert impulses.times[0] == 0.0
    left = impulses.residual(40.0, damping)[0]
    assert left <= (0.05 + 1e-12 if name == "ei" else 1e-12)


def test_published_impulses():
    undamped = {name: train(resonance(name, 10.0, 0.0)) for name in NAMES}
    assert undamped["zv"].amplitudes == pytest.approx([0.5, 0.5])
    assert undamped["zv"].times == pytest.approx([0.0, 0.05])
    assert undamped["zvd"].amplitudes == pytest.approx([0.25, 0.5, 0.25])
    assert undamped["ei"].amplitudes == pytest.approx([1.05 / 4, 0.95 / 2, 1.05 / 4])
    assert undamped["ei"].residual(10.0, 0.0) == pytest.approx(0.05)
    assert undamped["mzv"].times == pytest.approx([0.0, 0.0375, 0.075])


def test_zvd_is_flat_where_zv_is_not():
    beside = {name: train(resonance(name, 40.0, 0.0)).residual(40.4, 0.0)[0] for name in ("zv", "zvd")}
    assert beside["zv"] == pytest.approx(math.pi / 2 * 0.01, rel=1e-2)  # |cos(pi/2 f/f0)|
    assert beside["zvd"] == pytest.approx(beside["zv"] ** 2, rel=1e-6)


def swing(trajectory, frequency, damping):
    """Amplitude of a swinging axis after the motion's end, by its energy [mm]."""
    w, end = 2 * math.pi * frequency, trajectory.duration
    t = np.linspace(0.0, end, 10_001)
    a, b = [[0.0, 1.0], [-w * w, -2 * damping * w]], [[0.0], [w * w]]
    _, _, state = lsim((a, b, np.eye(2), np.zeros((2, 1))), trajectory.position(t)[:, 0], t)
    off = state[-1, 0] - trajectory.position([end])[0, 0]
    # the phasor of a damped swing: x + i (v + z w x) / wd has the size of its envelope
    return abs(complex(off, (state[-1, 1] + damping * w * off) / (w * math.sqrt(1 - damping**2))))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("frequency", [33.0, 40.0])
def test_what_is_left_of_a_swing_is_what_the_formula_says(name, frequency):
    damping = 0.05
    plain = planned("G1 X5 F6000", MILL, "trapezoid")
    with_shaper = planned("G1 X5 F6000", shaped(MILL, X=resonance(name, 40.0, damping)), "trapezoid")
    before, after = swing(plain, frequency, damping), swing(with_shaper, frequency, damping)
    expected = train(resonance(name, 40.0, damping)).residual(frequency, damping)[0]
    assert before > 1e-3
    assert after == pytest.approx(expected * before, abs=2e-4 * before)


@pytest.mark.parametrize("profile", sorted(PROFILES))
@pytest.mark.parametrize("kind", ["mill", "capped", "belts"])
def test_no_limit_is_exceeded_though_axes_have_different_shapers(profile, kind):
    machine = {"mill": MILL, "capped": dataclasses.replace(MILL, path=PathLimits(velocity=60.0, acceleration=500.0)),
               "belts": BELTS}[kind]  # fmt: skip
    if kind == "belts":
        joints = tuple(dataclasses.replace(joint, velocity=100.0, acceleration=1000.0) for joint in machine.joints[:2])
        machine = dataclasses.replace(machine, joints=(*joints, *machine.joints[2:]))
    machine = shaped(machine, X=resonance("zv", 45.0), Y=resonance("ei", 30.0))
    trajectory = planned(CORNER, machine, profile)
    limits, t = trajectory.limits, np.linspace(0, trajectory.duration, 20_001)
    velocity, acceleration = trajectory.velocity(t), trajectory.acceleration(t)
    assert (np.abs(velocity @ limits.matrix.T) <= limits.velocity * (1 + 1e-9)).all()
    assert (np.abs(acceleration @ limits.matrix.T) <= limits.acceleration * (1 + 1e-9)).all()
    assert (np.linalg.norm(velocity[:, :3], axis=1) <= limits.path_velocity * (1 + 1e-9)).all()
    assert (np.linalg.norm(acceleration[:, :3], axis=1) <= limits.path_acceleration * (1 + 1e-9)).all()
    if trajectory.schedule.jerk_limited:
        assert (np.abs(trajectory.jerk(t)[:, :3]) <= limits.jerk[:3] * (1 + 1e-9)).all()


def test_motion_ends_later_by_the_last_impulse_and_at_its_place():
    plain, one = planned(CORNER, MILL), planned(CORNER, shaped(MILL, X=resonance("zvd"), Y=resonance("zv")))
    assert one.duration == pytest.approx(plain.duration + one.shaping.delay)
    assert sum(one.times.values()) == pytest.approx(one.duration)
    ends = [0.0, one.duration]
    assert one.position(ends) == pytest.approx(plain.position([0.0, plain.duration]))
    assert one.velocity(ends) == pytest.approx(np.zeros((2, 3)), abs=1e-9)


def test_at_even_speed_no_axis_is_late():
    one = planned("G1 X100 Y50 F3000", shaped(MILL, X=resonance("zvd"), Y=resonance("zv", 25.0)))
    x, y, _ = one.position([one.duration / 2])[0]
    assert y == pytest.approx(x / 2, abs=1e-12)


def test_a_circle_shrinks_as_the_impulses_turn_apart():
    name, radius, speed = "zv", 10.0, 50.0
    machine = shaped(MILL, X=resonance(name, 20.0), Y=resonance(name, 20.0))
    one = planned(f"G2 X0 Y0 I{radius} J0 F{60 * speed}\nG2 X0 Y0 I{radius} J0", machine)
    impulses = train(resonance(name, 20.0))
    mean = np.exp(1j * speed / radius * np.array(impulses.times)) @ np.array(impulses.amplitudes)
    found = deviation(one, 0.001)
    assert found.peak == pytest.approx(radius * (1 - abs(mean)), rel=0.03)
    assert deviation(planned("G1 X10 F600", MILL), 0.001) is None


def test_shaped_motion_has_no_phases_along_the_path():
    with pytest.raises(LimitError, match="shaped"):
        planned("G1 X1 F600", shaped(MILL, X=resonance("zv"))).blocks()


def test_damping_beyond_a_swing_is_refused():
    with pytest.raises(ConfigError, match=r"at most 0\.9"):
        Resonance(frequency=40.0, damping=0.95)


@pytest.mark.parametrize("profile", sorted(PROFILES))
def test_cubics_in_its_place_have_phases_and_are_as_good_as_it(profile):
    machine = shaped(MILL, X=resonance("zvd"), Y=resonance("zv", 25.0))
    one = planned(CORNER, machine, profile)
    cubics = fitted(one, machine)
    t = np.linspace(0.0, one.duration, 7919)
    assert np.abs(cubics.position(t) - one.position(t)).max() < 0.001**2 / 32 * 800.0 + 1e-7
    assert sum(len(block) for block in cubics.blocks()) == math.ceil(one.duration / machine.servo_period)
    assert (cubics.line_at(t) == one.line_at(t)).mean() > 0.99
    plain = planned(CORNER, MILL, profile)
    assert fitted(plain, MILL) is plain
