"""What a live run records: every servo tick, around triggers, in bounded space, readable after a kill."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import trochia
from trochia.backends.live_twin import LiveTwin
from trochia.controller.recording import STATES, Recorder, Take
from trochia.controller.runtime import PERIOD, Runtime
from trochia.errors import RecordingError
from trochia.machine.joints import Encoder
from trochia.messages import command as c
from trochia.recorder import parts_of, read

SQUARE = "G21 G90 G94 F1800\nG1 X10\nY10\nX0\nY0\nM2\n"


class Machine:
    """A mill on its twin, recorded."""

    def __init__(self, folder, **take):
        machine = trochia.load("reference-mill")
        first = replace(machine.joints[0], encoder=Encoder(counts=4000), backlash=0.0)
        self.machine = replace(machine, joints=(first, *machine.joints[1:]))
        self.now = 0.0
        self.runtime = Runtime(LiveTwin(self.machine), recordings=folder)
        self.path = folder / "run"
        self.runtime.recorder.start(Take(path=self.path, **take), program="square")
        self.told: list[tuple[float, float]] = []

    def ok(self, command):
        answer = self.runtime.command(command, self.now)
        assert answer.ok, answer.reason
        return answer

    def turn(self, seconds):
        end = self.now + seconds
        while self.now < end - 1e-9:
            self.now = round(self.now + PERIOD, 9)
            self.runtime.turn(self.now)
            report = self.runtime.controller.report
            self.told.append((report.time, report.commanded[0]))

    def start(self):
        for command in (c.Enable(), c.Load(name="square", text=SQUARE), c.Run()):
            self.ok(command)
            self.turn(0.05)
        return self

    def recorded(self):
        self.runtime.close()
        return read(self.path, verify=True)


def test_every_servo_tick_is_there_and_says_what_the_reports_say(tmp_path):
    bench = Machine(tmp_path).start()
    bench.turn(3.0)
    recorded = bench.recorded()
    assert recorded.period == bench.machine.servo_period
    assert len(recorded) == round(bench.now / bench.machine.servo_period)
    for time, at in bench.told:
        assert recorded["joint.X.commanded"][round(time / recorded.period) - 1] == pytest.approx(at, abs=1e-12)
    assert recorded["X.commanded"].max() == pytest.approx(10.0)
    speed = np.hypot(np.gradient(recorded["X.commanded"]), np.gradient(recorded["Y.commanded"])) / recorded.period
    inside = slice(5, -5)
    assert recorded["path.speed"][inside] == pytest.approx(speed[inside], abs=0.5)
    assert np.all(np.abs(recorded["X.error"]) < 0.01)
    assert {STATES[code] for code in np.unique(recorded["state"])} == {"idle", "running"}
    assert recorded.describe("state").values == STATES
    assert set(np.unique(recorded["path.line"])) >= {2, 3, 4, 5}
    assert "joint.X.encoder" in recorded
    assert "joint.Y.encoder" not in recorded
    assert recorded["joint.X.encoder"] == pytest.approx(recorded["joint.X.commanded"], abs=0.01)


def test_a_hold_is_recorded_with_the_time_around_it(tmp_path):
    bench = Machine(tmp_path, triggers=("hold",), before=0.2, after=0.3, channels=("X.*", "state")).start()
    bench.turn(0.5)
    bench.ok(c.Hold())
    at = bench.now
    bench.turn(1.0)
    recorded = bench.recorded()
    assert list(recorded.channels) == ["X.commanded", "X.actual", "X.error", "X.velocity", "state"]
    names = [STATES[code] for code in recorded["state"]]
    assert recorded.start == pytest.approx(at - 0.2, abs=PERIOD)
    assert len(recorded) * recorded.period == pytest.approx(0.5, abs=2 * recorded.period)
    first = names.index("holding")
    assert set(names[:first]) == {"running"}
    assert first * recorded.period == pytest.approx(0.2, abs=2 * recorded.period)


def test_each_line_and_alarm_is_a_part_of_its_own(tmp_path):
    bench = Machine(tmp_path, triggers=("line 3", "alarm"), before=0.05, after=0.05).start()
    bench.turn(1.0)
    bench.ok(c.EmergencyStop())
    bench.turn(0.5)
    bench.runtime.close()
    parts = [read(part) for part in parts_of(bench.path)]
    assert len(parts) == 2
    lines = parts[0]["path.line"]
    assert lines[50] == 3
    assert set(lines[:50]) == {2}
    assert "estop" in {STATES[code] for code in parts[1]["state"]}
    assert read(bench.path).start == parts[1].start


def test_clients_start_and_end_a_recording_in_any_state(tmp_path):
    bench = Machine(tmp_path / "all")
    refused = bench.runtime.command(c.Record(name="other"), 0.0)
    assert not refused.ok
    assert "run" in refused.reason
    assert bench.ok(c.RecordStop()).told == "run"
    bench.turn(0.05)
    assert not bench.runtime.command(c.RecordStop(), bench.now).ok
    bench.runtime.recorder.stop(wait=True)
    told = bench.ok(c.Record(channels=("path.*",))).told
    assert told == "recording-1"
    bench.turn(0.1)
    bench.ok(c.RecordStop())
    bench.runtime.recorder.stop(wait=True)
    assert list(read(tmp_path / "all" / told).channels) == ["path.speed", "path.line", "path.time"]
    assert bench.ok(c.Record()).told == "recording-2"
    bench.ok(c.RecordStop())
    bench.runtime.recorder.stop(wait=True)
    for wrong, why in (
        (c.Record(name="recording-1"), "already"),
        (c.Record(channels=("Q.*",)), "no channel"),
        (c.Record(triggers=("full moon",)), "full moon"),
    ):
        answer = bench.runtime.command(wrong, bench.now)
        assert not answer.ok
        assert why in answer.reason
    bench.runtime.close()


def test_without_a_folder_clients_are_told_how_to_get_one():
    runtime = Runtime(LiveTwin(trochia.load("reference-mill")))
    answer = runtime.command(c.Record(), 0.0)
    assert not answer.ok
    assert "--recordings" in answer.reason
    runtime.close()


class Board:
    """A backend that tells of no ticks."""

    kind = "board"

    def __init__(self, machine):
        self.machine = machine


def test_a_board_is_recorded_by_its_reports(tmp_path):
    twin = LiveTwin(trochia.load("reference-mill"))
    report = twin.open(0.0)
    recorder = Recorder(Board(twin.machine), turn=PERIOD)
    recorder.start(Take(path=tmp_path / "b"))
    runtime = Runtime(twin)
    for turn in (0, 1, 2, 5, 6):  # two turns late
        recorder.turn(replace(report, time=turn * PERIOD, line=turn), runtime.controller.state)
    recorder.stop(wait=True)
    recorded = read(tmp_path / "b")
    assert recorded.period == PERIOD
    assert recorded["path.line"].tolist() == [1, 2, 5, 5, 5, 6]


def test_a_disk_that_refuses_ends_the_recording_and_not_the_machine(tmp_path):
    bench = Machine(tmp_path)
    (tmp_path / "run").rmdir()
    (tmp_path / "run").write_text("in the way")
    bench.start()
    bench.turn(1.0)
    assert bench.runtime.recorder.path is None
    assert bench.runtime.status.state == "running"
    bench.runtime.close()


def test_wrong_times_are_refused(tmp_path):
    with pytest.raises(RecordingError, match="zero or more"):
        Take(path=tmp_path, before=-1.0)


RUN = """
import sys
from pathlib import Path
import trochia
from trochia.backends.live_twin import LiveTwin
from trochia.controller.recording import Take
from trochia.controller.runtime import PERIOD, Runtime
from trochia.messages import command as c
runtime = Runtime(LiveTwin(trochia.load("laser")))
runtime.recorder.start(Take(path=Path(sys.argv[1]), limit=400_000))
now = 0.0
for command in (c.Enable(), c.ArmBeam(on=True), c.Load(name="job", text=Path(sys.argv[2]).read_text()), c.Run()):
    assert runtime.command(command, now).ok
while True:
    now += PERIOD
    runtime.turn(now)
    sys.stdout.write(f"{now:.6f} {runtime.controller.report.commanded[0]:.12f}\\n")
    sys.stdout.flush()
    if now > 1.0:  # else the disk is never behind, and nothing is being written at the kill
        import time
        time.sleep(0.004)
"""


@pytest.mark.parametrize("instant", [1.2, 2.2])
def test_a_killed_process_leaves_all_but_the_last_block(tmp_path, instant):
    program = Path(__file__).parents[3] / "programs" / "contour.ngc"
    told = []
    with subprocess.Popen([sys.executable, "-c", RUN, str(tmp_path / "r"), str(program)], stdout=subprocess.PIPE,
                          text=True) as process:  # fmt: skip
        assert process.stdout is not None
        for line in process.stdout:
            told.append([float(word) for word in line.split()])
            if told[-1][0] >= instant:
                os.kill(process.pid, signal.SIGKILL)
                break
    recorded = read(tmp_path / "r")
    assert sum(file.stat().st_size for file in (tmp_path / "r").rglob("samples.bin")) <= 400_000
    assert recorded.time[-1] >= instant - 0.5  # a block of 50 ms, and what a loaded machine has kept from the writer
    places = dict(told)
    for sample in range(len(recorded) - 1, 0, -97):
        time = round(recorded.time[sample] + recorded.period, 6)
        if time in places:
            assert recorded["joint.X.commanded"][sample] == pytest.approx(places[time], abs=1e-9)
