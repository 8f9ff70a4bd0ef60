"""A live machine whose errors are corrected: motors keep their limits, loads are where they were asked to be."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import numpy as np
import pytest

import trochia
from trochia.api import gcode, plan, simulate
from trochia.backends.compensated import Compensated, compensated
from trochia.backends.live_twin import LiveTwin
from trochia.controller.recording import Take
from trochia.controller.runtime import PERIOD, Runtime
from trochia.machine.compensation import Compensation, Squareness
from trochia.machine.error_table import ErrorTable
from trochia.machine.joints import Servo
from trochia.machine.reserve import limits_of
from trochia.messages import command as c
from trochia.recorder import read

PLAY = 0.05
PLACES = np.linspace(0.0, 400.0, 41)
TABLE = ErrorTable(points=tuple(zip(PLACES.tolist(), (0.05 * np.sin(PLACES / 20) + 3e-4 * PLACES).tolist(),
                                    strict=True)))  # fmt: skip
PROGRAM = "G21 G90 G0 X30 Y30\nG1 X60 F3000\nG2 X60 Y30 I10 J0\nG1 X20 Y35\nX25 Y30\nX24.9\nX30\nG3 X30 Y30 I0 J5\nM2\n"


@pytest.fixture(scope="module")
def wrong():
    """A machine that errs: a table of servos that follow exactly, so that nothing is rounded to steps."""
    machine = trochia.load("laser")
    joints = tuple(replace(joint, motor=Servo(), driver=None, pulse_rate=None, backlash=PLAY, screw_error=TABLE,
                           following_error=None) for joint in machine.joints)  # fmt: skip
    return replace(machine, joints=joints, squareness_error=Squareness(XY=0.1), beam=None)


@pytest.fixture(scope="module")
def right(wrong):
    """The same, corrected."""
    given = Compensation(backlash=PLAY, screw=TABLE)
    joints = tuple(replace(joint, compensation=given) for joint in wrong.joints)
    return replace(wrong, joints=joints, squareness=Squareness(XY=0.1))


def limits_kept(machine, motors, tick):
    """Hold motors (ticks, joints) to velocity, acceleration of their joints."""
    velocity = np.diff(motors, axis=0) / tick
    for j in range(motors.shape[1]):
        limit = limits_of(machine, j)
        assert np.abs(velocity[:, j]).max() <= limit.velocity * (1 + 1e-6)
        steep = np.abs(np.diff(velocity[:, j])).max() / tick
        assert steep <= limit.acceleration * 1.02 + 1e-6, f"{steep} of {limit.acceleration}"


class Run:
    """A machine on its twin, with what its motors were told."""

    def __init__(self, machine, path=None):
        self.twin = LiveTwin(machine)
        self.motors = []
        self.runtime = Runtime(self.twin)
        if path is not None:
            self.runtime.recorder.start(Take(path=path))
        inner = self.twin.tap

        def tap(ticks):
            self.motors.append(ticks.commanded)
            if inner is not None:
                inner(ticks)

        self.twin.tap = tap
        self.now = 0.0
        self.ok(c.Enable())

    def ok(self, command):
        answer = self.runtime.command(command, self.now)
        assert answer.ok, answer.reason
        self.turn(0.01)

    def turn(self, seconds):
        end = self.now + seconds
        while self.now < end - 1e-9:
            self.now = round(self.now + PERIOD, 9)
            self.runtime.turn(self.now)

    def until(self, *states, most=60.0):
        end = self.now + most
        while self.runtime.controller.state.value not in states:
            self.turn(PERIOD)
            assert self.now < end, self.runtime.controller.state

    @property
    def places(self):
        report = self.runtime.controller.report
        return report.commanded, report.actual

    def told(self):
        return np.concatenate(self.motors)


def test_a_machine_without_corrections_has_its_backend_itself(wrong):
    twin = LiveTwin(wrong)
    assert compensated(twin) is twin
    assert Runtime(twin).backend is twin


def test_simulate_shows_the_error_with_and_without(wrong, right):
    peaks = {}
    for name, machine in (("without", wrong), ("with", right)):
        recorded = simulate(plan(gcode(PROGRAM, machine), machine))
        error = recorded["X.actual"] - recorded["X.commanded"]
        peaks[name] = np.sqrt(np.mean(error**2)), np.median(np.abs(error))
    assert peaks["without"][0] > 0.03
    assert peaks["with"][0] < 0.25 * peaks["without"][0]  # what is left is left while backlash is made up
    assert peaks["with"][1] < 2e-4


def test_a_run_is_the_plan_and_motors_keep_their_limits(right, tmp_path):
    planned = plan(gcode(PROGRAM, right), right)
    proof = simulate(planned)
    run = Run(right, tmp_path / "r")
    run.ok(c.Load(name="p", text=PROGRAM))
    run.ok(c.Run())
    run.until("idle")
    run.runtime.close()
    recorded = read(tmp_path / "r")
    moving = np.flatnonzero(np.diff(recorded["path.time"]) > 0)
    begin = moving[0]
    count = min(len(proof), len(recorded) - begin)
    for axis in "XY":
        live = recorded[f"{axis}.commanded"][begin : begin + count]
        assert live == pytest.approx(proof[f"{axis}.commanded"][:count], abs=2e-6)
        assert recorded[f"{axis}.actual"][begin : begin + count] == pytest.approx(
            proof[f"{axis}.actual"][:count], abs=1e-3
        )
    limits_kept(right, run.told(), right.servo_period)


def test_motors_keep_their_limits_in_holds_and_overrides(right):
    draw = Random(7)  # noqa: S311 - for tests
    run = Run(right)
    run.ok(c.Load(name="p", text=PROGRAM))
    run.ok(c.Run())
    for _ in range(25):
        run.turn(draw.uniform(0.02, 0.25))
        state = run.runtime.controller.state.value
        if state == "idle":
            run.ok(c.Run())
        elif state == "running" and draw.random() < 0.5:
            run.ok(c.Hold())
            run.until("held")
            run.ok(c.Resume())
        elif state == "running":
            run.ok(c.Override(feed=draw.uniform(0.3, 1.5)))
    run.until("idle")
    limits_kept(right, run.told(), right.servo_period)
    commanded, actual = run.places
    assert commanded == pytest.approx([30.0, 30.0], abs=1e-6)
    assert actual == pytest.approx(commanded, abs=2e-4)
    assert not run.runtime.status.alarms


@pytest.mark.parametrize("way", [0.5, 0.003])
def test_a_jog_back_ends_where_it_was_asked_however_short(right, way):
    run = Run(right)
    run.ok(c.JogTo(position={"X": 50.0, "Y": 40.0}))
    run.until("idle")
    for sign in (-1, 1, -1, -1, 1):
        before = run.places[0][0]
        run.ok(c.JogBy(way={"X": sign * way}))
        run.until("idle")
        commanded, actual = run.places
        assert commanded[0] == pytest.approx(before + sign * way, abs=1e-6)
        assert actual == pytest.approx(commanded, abs=2e-4)  # e e' of the table
    limits_kept(right, run.told(), right.servo_period)


def test_what_comes_while_backlash_is_made_up_begins_there(right):
    run = Run(right)
    run.ok(c.JogTo(position={"X": 50.0, "Y": 40.0}))
    run.until("idle")
    for k in range(30):
        run.ok(c.Jog(axis="X", speed=(-1) ** k * 20.0))
        run.turn(0.02 + 0.003 * k)
        run.ok(c.JogStop())
        run.until("idle")
    run.turn(0.5)
    commanded, actual = run.places
    assert actual == pytest.approx(commanded, abs=2e-4)
    limits_kept(right, run.told(), right.servo_period)


def test_a_stop_at_once_leaves_places_that_are_true(right):
    run = Run(right)
    run.ok(c.JogTo(position={"X": 50.0, "Y": 40.0}))
    run.until("idle")
    run.ok(c.JogTo(position={"X": 10.0}))
    run.turn(0.1)
    run.ok(c.EmergencyStop())
    run.turn(0.2)
    commanded, actual = run.places
    assert actual == pytest.approx(commanded, abs=PLAY)
    run.ok(c.Reset())
    run.ok(c.Enable())
    run.ok(c.Acknowledge()) if run.runtime.status.alarms else None
    assert isinstance(run.runtime.backend, Compensated)
    told = run.runtime.backend._here()
    assert told == pytest.approx(commanded, abs=1e-6)
