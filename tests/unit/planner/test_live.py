"""Live motion against closed forms: how long a stop takes, where the beam relights, what an override does."""

from __future__ import annotations

import numpy as np
import pytest

from trochia.errors import PlanningError
from trochia.languages import gcode
from trochia.machine.load import load
from trochia.planner import PROFILES, plan
from trochia.planner.live import LivePlan, Speeds, StreamPlanner
from trochia.planner.live.pieces import reversed_path
from trochia.planner.ramp import ramp
from trochia.toolpath import build

LINE = "G64 P0.02\nG1 X200 F6000\nM2\n"
ROUND = "G64 P0.02\nS500 M3\nF6000\nG1 X40\nG3 X60 Y20 J20\nG1 Y60\nG2 X80 Y80 I20\nG1 X200\nM2\n"


def live_of(text, profile):
    machine, program = load("reference-mill"), gcode.read(text)
    path = build(program, machine, continuity=PROFILES[profile].continuity)
    whole = plan(path, machine, program=program, profile=profile)
    return LivePlan.of(whole, machine), whole


@pytest.mark.parametrize(("profile", "seconds"), [("trapezoid", 100 / 800), ("s-curve", 100 / 800 + 800 / 20_000)])
def test_a_hold_at_speed_on_a_line_takes_the_least_time(profile, seconds):
    live, _ = live_of(LINE, profile)
    assert live.state(1.0).speed == pytest.approx(100.0)
    rest = live.hold(1.0)
    assert rest - 1.0 == pytest.approx(seconds, rel=1e-6)
    at_rest = live.state(rest)
    assert at_rest.speed == 0.0
    assert at_rest.position[0] == pytest.approx(live.state(1.0).position[0] + 50.0 * seconds, rel=1e-6)
    assert live.state(rest + 9.0).position == pytest.approx(at_rest.position)


@pytest.mark.parametrize("profile", ["trapezoid", "s-curve"])
def test_held_and_resumed_it_ends_where_it_would_have(profile):
    live, whole = live_of(LINE, profile)
    rest = live.hold(0.7)
    assert live.held
    assert live.resume(rest + 1.0) == rest + 1.0
    assert not live.held
    assert live.end is not None
    # the stop and the new start cost what one more start and stop cost
    slack = (100 / 800) + (800 / 20_000 if profile == "s-curve" else 0.0)
    assert live.end == pytest.approx(whole.duration + 1.0 + slack, abs=1e-6)
    assert live.state(live.end).position == pytest.approx([200, 0, 0], abs=1e-9)


@pytest.mark.parametrize("profile", ["trapezoid", "s-curve"])
@pytest.mark.parametrize("t", [0.3, 0.62, 0.9, 1.5])
def test_the_beam_relights_at_speed_where_it_went_out(profile, t):
    live, _ = live_of(ROUND, profile)
    out = live.state(t)
    assert out.power == 500.0
    rest = live.hold(t)
    assert live.state(t + 1e-6).power == 0.0
    lit = live.resume(rest + 0.25, relight=True)
    assert live.state(lit - 1e-5).power == 0.0
    again = live.state(lit + 1e-6)
    assert again.power == 500.0
    assert again.position == pytest.approx(out.position, abs=1e-3)
    assert again.speed >= out.speed * (1 - 1e-3)
    backing = live.state(rest + 0.3)
    assert backing.speed < 0.0
    assert backing.power == 0.0


def test_a_lower_feed_is_taken_up_at_once_and_a_higher_one_too():
    live, _ = live_of(LINE, "s-curve")
    live.override(0.6, feed=0.5)
    assert live.state(0.6).speed == pytest.approx(100.0)
    assert live.state(0.9).speed == pytest.approx(50.0)
    live.override(1.0, feed=1.5)
    assert live.state(1.4).speed == pytest.approx(150.0)
    assert live.end is not None
    assert live.state(live.end).position == pytest.approx([200, 0, 0], abs=1e-9)


def test_rapids_have_an_override_of_their_own():
    live, _ = live_of("G0 X300\nM2\n", "trapezoid")
    assert live.state(0.5).speed == pytest.approx(200.0)
    live.override(0.5, rapid=0.25, feed=2.0)
    assert live.state(0.9).speed == pytest.approx(50.0)


def test_a_hold_in_a_dwell_rests_there_and_dwells_again():
    live, _ = live_of("G1 X10 F6000\nG4 P2\nX20\nM2\n", "s-curve")
    rest = live.hold(1.0)
    assert rest == 1.0
    live.resume(5.0)
    assert live.state(6.9).position == pytest.approx([10, 0, 0])
    assert live.state(7.2).position[0] > 10.0


def test_what_is_not_held_is_not_resumed():
    live, _ = live_of(LINE, "s-curve")
    with pytest.raises(PlanningError, match="rests in a hold"):
        live.resume(0.5)
    rest = live.hold(0.5)
    with pytest.raises(PlanningError, match="rests in a hold"):
        live.resume(rest - 0.01)


@pytest.mark.parametrize("speeds", [{"feed": 0.0}, {"feed": 2.1}, {"rapid": 1.1}, {"rapid": 0.0}])
def test_overrides_have_bounds(speeds):
    with pytest.raises(ValueError, match="lies within"):
        Speeds(**speeds)


def test_a_streamed_program_is_live_too():
    machine, program = load("reference-mill"), gcode.read(ROUND)
    live = LivePlan.streaming([program], machine)
    rest = live.hold(0.5)
    live.resume(rest)
    whole = list(StreamPlanner([program], machine))[-1]
    assert live.end is not None
    assert live.state(live.end).position == pytest.approx(whole.position([whole.end])[0], abs=1e-9)


def test_the_way_back_is_the_same_path():
    _, whole = live_of(ROUND, "s-curve")
    path, axes = whole.path, 3
    last = len(path) - 1
    start, end = (last, 0.4 * float(path.segments["length"][last])), (1, 0.3 * float(path.segments["length"][1]))
    rows, pool = reversed_path(path.segments, path.pool, axes, start, end)
    back = type(path)(axes=path.axes, start=path.start, segments=rows, pool=pool)
    assert rows["length"].sum() == pytest.approx(path.segments["length"][1:last].sum() - end[1] + start[1])
    for k, row in enumerate(range(last, 0, -1)):
        high = start[1] if row == last else float(path.segments["length"][row])
        s = np.linspace(0.0, float(rows["length"][k]), 7)
        there, here = np.full(7, k), np.full(7, row)
        assert back.points(there, s) == pytest.approx(path.points(here, high - s), abs=1e-9)
        assert back.points(there, s, 1) == pytest.approx(-path.points(here, high - s, 1), abs=1e-9)
        assert back.points(there, s, 2) == pytest.approx(path.points(here, high - s, 2), abs=1e-9)


def _stairs(step, tolerance):
    return "".join([f"G64 P{tolerance}\nF6000\n", *(f"G1 X{step * (k + 1)} Y{step * k}\nY{step * (k + 1)}\n"
                                                    for k in range(8)), "M2\n"])  # fmt: skip


@pytest.mark.parametrize("part", [0.23, 0.31, 0.37, 0.43, 0.52, 0.64, 0.71])
def test_a_hold_on_stairs_passes_one_corner_at_most(part):
    """Up to a corner both axes do what a stop would do; behind it that which began to move stops too."""
    live, whole = live_of(_stairs(1.0, 0.01), "s-curve")
    t = part * whole.duration
    state = live.state(t)
    straight = sum(piece.duration for piece in ramp((state.speed, state.acceleration), (0.0, 0.0), 800.0, 20_000.0))
    # through the corner at 6.6 mm/s, 0.17 mm, and from there with a = 2 v² / L to rest: 0.077 s
    assert live.hold(t) - t <= straight + 0.026 + 0.077


@pytest.mark.parametrize("profile", ["trapezoid", "s-curve"])
def test_motion_behind_is_forgotten_and_changes_nothing(profile):
    text = "G64 P0.01\nF1200\n" + "".join(f"G1 X{k * 0.5:g} Y{k % 2 * 0.3:g}\n" for k in range(1, 400)) + "M2\n"
    (live, whole), (other, _) = live_of(text, profile), live_of(text, profile)
    stop, most, in_hand = live.rules.stopping_time, 0, 0
    for t in np.arange(0.0, 0.8 * whole.duration, 0.5).tolist():
        ours, theirs = list(live.portions(t, t + 0.5)), list(other.portions(t, t + 0.5))
        times = np.linspace(t, t + 0.5, 9)
        assert (ours[0].position(times) == theirs[0].position(times)).all()
        live.forget(t - 1.0)
        in_hand = max(in_hand, len(live._legs[0].ahead.phases))
        most = len(other._legs[0].ahead.phases)
    assert stop < 1.0
    assert in_hand < 0.75 * most
    for held in (live, other):
        held.hold(t)
    assert live.end == other.end
    assert live.back_up(live.end, 30.0) == other.back_up(other.end, 30.0)  # the path is still there
    assert (live.state(live.end).position == other.state(other.end).position).all()
