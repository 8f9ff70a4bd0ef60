"""Recordings held against each other: on one clock, channel by channel, and way by way."""

from __future__ import annotations

import json

import numpy as np
import pytest
from click.testing import CliRunner

from trochia import cli
from trochia.analysis.replay import aligned, hold_against, look, way_apart
from trochia.errors import RecordingError
from trochia.recorder import Channel, Header, Recording, read, save

STATES = ("idle", "running", "held")
PERIOD = 0.001


def made(t, x, y, *, start=0.0, state=None, machine="bench"):
    channels = {"X.commanded": x, "Y.commanded": y, "X.actual": x, "Y.actual": y,
                "path.line": np.asarray(1 + (t > 0.5), np.uint32)}  # fmt: skip
    described = [Channel(name=n, unit="mm") for n in list(channels)[:4]] + [Channel(name="path.line", dtype="<u4")]
    if state is not None:
        channels["state"] = np.asarray(state, np.uint8)
        described.append(Channel(name="state", dtype="|u1", values=STATES))
    header = Header(period=float(t[1] - t[0]), start=start, machine=machine, program="p.ngc",
                    channels=tuple(described))  # fmt: skip
    return Recording(header=header, channels=channels)


def circle(t, over=1.0):
    phase = 2 * np.pi * np.clip(t, 0.0, over) / over
    return 10 * np.cos(phase), 10 * np.sin(phase)


@pytest.fixture
def plan():
    t = PERIOD * np.arange(1001)
    return made(t, *circle(t))


def test_a_run_is_taken_from_where_its_job_moves(plan):
    t = PERIOD * np.arange(2500)
    way = circle(t - 1.2)
    jogged = np.where(t < 0.3, 0.01 * np.sin(20 * t), 0.0)  # before the job, in idle
    run = made(t, way[0] + jogged, way[1] + 0.02 * (t > 1.9) * (2.9 - t), state=(t > 1.0).astype(int))
    held = hold_against(aligned(plan, run), (plan, run))
    assert held.began == (0.0, pytest.approx(1.2, abs=PERIOD))
    assert held.deviations["X.commanded"].peak == pytest.approx(0.0, abs=1e-9)
    y = held.deviations["Y.commanded"]
    assert y.peak == pytest.approx(0.02, abs=3e-5)
    assert y.time == pytest.approx(0.7, abs=2 * PERIOD)
    assert y.line == 2
    assert held.missing == ("state",)
    assert held.deviations["path"].peak <= 0.02 + 1e-9
    assert held.beyond(0.01) == ["path"]
    assert held.beyond(0.03) == []


def test_where_it_went_does_not_ask_when(plan):
    t = PERIOD * np.arange(4000)
    phase = np.interp(t, [0.2, 1.0, 2.0, 3.5], [0.0, 0.3, 0.3, 1.0])  # a hold for a second, then half the speed
    state = np.select([(t > 1.0) & (t < 2.0), t > 0.1], [2, 1], 0)
    run = made(t, *circle(phase), state=state)
    held = hold_against(aligned(plan, run), (plan, run))
    assert held.deviations["X.commanded"].peak > 5.0
    assert held.deviations["path"].peak < 1e-4  # chords of the plan's samples: 10 mm / 8 of (2 pi / 1000)²
    off = made(t, circle(phase)[0] * 1.003, circle(phase)[1] * 1.003, state=state)
    assert hold_against(aligned(plan, off), (plan, off)).deviations["path"].peak == pytest.approx(0.03, abs=1e-4)


def test_the_distance_from_a_corner_is_that_of_the_nearest_chord():
    t = PERIOD * np.arange(3)
    plan = made(t, np.array([0.0, 10.0, 10.0]), np.array([0.0, 0.0, 10.0]))
    run = made(PERIOD * np.arange(4), np.array([5.0, 11.0, 13.0, 9.0]), np.array([1.0, 5.0, -4.0, 9.5]))
    assert way_apart(plan, run) == pytest.approx([1.0, 1.0, 5.0, 1.0])


def test_other_periods_are_read_in_between(plan):
    t = 0.0004 * np.arange(2501)
    fine = made(t, *circle(t))
    held = hold_against(aligned(plan, fine, by="time"), (plan, fine))
    assert held.deviations["X.commanded"].peak < 1e-5  # a straight line over 0.4 ms of a circle
    assert held.seconds == pytest.approx(1.0)
    assert hold_against(aligned(fine, plan, by="start"), (fine, plan)).deviations["X.commanded"].peak < 1e-4


def test_what_cannot_be_held_against_each_other_is_refused(plan):
    t = PERIOD * np.arange(10)
    other = made(t, t, t, machine="another")
    with pytest.raises(RecordingError, match="two machines"):
        aligned(plan, other)
    still = made(t, 0 * t, 0 * t)
    with pytest.raises(RecordingError, match="nothing moves"):
        aligned(plan, still)
    late = made(t, t, t, start=50.0)
    with pytest.raises(RecordingError, match="no time in common"):
        aligned(plan, late, by="time")


def test_a_look_says_spans_and_states():
    t = PERIOD * np.arange(100)
    one = made(t, t, -3 * t, state=np.repeat([0, 1, 2, 1], 25), start=2.0)
    seen = look(one)
    y = next(row for row in seen.channels if row["name"] == "Y.commanded")
    assert (y["least"], y["greatest"]) == (pytest.approx(-0.297), 0.0)
    assert y["time_s"] == pytest.approx(2.099)
    assert [name for _, name in seen.states] == ["idle", "running", "held", "running"]
    assert [time for time, _ in seen.states] == pytest.approx([2.0, 2.025, 2.05, 2.075])


@pytest.fixture
def call():
    def run(*words):
        return CliRunner().invoke(cli.group, list(map(str, words)), catch_exceptions=False)

    return run


def test_a_run_is_its_plan(call, tmp_path):
    program = tmp_path / "square.ngc"
    program.write_text("G21 G90 G0 X5 Y5\nG1 X20 F3000\nG2 X30 Y15 I0 J10\nG1 Y5\nM2\n")
    assert call("simulate", program, "-m", "laser", "-o", tmp_path / "out").exit_code == 0
    ran = call("run", program, "-m", "laser", "--virtual", "-y", "--record", tmp_path / "run")
    assert ran.exit_code == 0
    assert "recording" in ran.output
    done = call("replay", tmp_path / "out" / "recording", tmp_path / "run", "--tolerance", "1 um", "-o",
                tmp_path / "p.png", "--csv", tmp_path / "run.csv", "--json")  # fmt: skip
    assert done.exit_code == 0
    told = json.loads(done.output)
    assert told["ok"]
    assert told["deviations"]["X.commanded"]["peak"] < 1e-5
    assert (tmp_path / "p.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "run.csv").read_text().startswith("time [s],X.commanded [mm]")
    recorded = read(tmp_path / "run")
    moved = {name: np.array(samples) for name, samples in recorded.channels.items()}
    moved["X.commanded"] += 0.05 * (moved["path.line"] == 3)
    save(tmp_path / "other", Recording(header=recorded.header, channels=moved))
    failed = call("replay", tmp_path / "run", tmp_path / "other", "--tolerance", "10 um")
    assert failed.exit_code == 1
    assert "beyond 10 µm: path" in failed.output
    seen = call("replay", tmp_path / "run", "-o", tmp_path / "one.png")
    assert seen.exit_code == 0
    assert "states   idle" in seen.output


def test_a_tolerance_needs_two_and_a_unit(call, tmp_path):
    assert "give both" in call("replay", tmp_path, "--tolerance", "1 um").output
    assert call("replay", tmp_path, tmp_path, "--tolerance", "1 V").exit_code == 2


def test_the_channels_of_a_machine_are_listed(call):
    told = json.loads(call("machine", "channels", "xy-table", "--json").output)["channels"]
    names = [row["name"] for row in told]
    assert {"X.commanded", "X.error", "joint.X.encoder", "path.line", "state"} <= set(names)
    assert all(row["meaning"] for row in told)
    assert "following error" in call("machine", "channels", "xy-table").output


def test_a_recording_needs_its_folder(call, tmp_path):
    program = tmp_path / "p.ngc"
    program.write_text("M2\n")
    assert "--record FOLDER" in call("run", program, "-m", "laser", "--channel", "X.*").output
    wrong = call("run", program, "-m", "laser", "--record", tmp_path / "r", "--record-on", "noon")
    assert "noon" in wrong.output
    assert call("run", program, "-m", "laser", "--record", tmp_path / "r", "--before", "3 mm").exit_code == 2
