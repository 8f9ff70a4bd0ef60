"""The table of recorded quantities: which machine has which, and that a row is all a new one takes."""

from __future__ import annotations

import numpy as np
import pytest

from trochia.backends import Twin, signals
from trochia.backends.signals import AxisSignal, JointSignal, PathSignal
from trochia.machine.kinematics import CoreXY
from trochia.machine.load import load
from trochia.recorder import gather


def names(machine):
    return [channel.name for channel, _ in signals.signals(machine)]


def test_joints_have_the_quantities_they_have(machine, joint):
    bench = machine(joint("X", steps=200), joint("Y", counts=100), joint("Z", steps=200, counts=100))
    assert [name for name in names(bench) if name.startswith("joint")] == [
        "joint.X.steps", "joint.X.motor", "joint.X.actual",
        "joint.Y.motor", "joint.Y.counts", "joint.Y.actual",
        "joint.Z.steps", "joint.Z.motor", "joint.Z.counts", "joint.Z.actual",
    ]  # fmt: skip


def test_axes_come_first_and_belts_are_joints_of_their_own(machine, joint):
    bench = machine(joint("A"), joint("B"), kinematics=CoreXY(2))
    assert names(bench)[:5] == ["X.commanded", "Y.commanded", "X.actual", "Y.actual", "joint.A.motor"]


def test_units_are_those_of_the_axes():
    units = {channel.name: channel.unit for channel, _ in signals.signals(load("rotary-mill"))}
    assert units["X.actual"] == units["joint.X.motor"] == "mm"
    assert units["A.actual"] == units["joint.A.motor"] == "degree"
    assert (units["path.speed"], units["path.line"]) == ("mm/s", "")


@pytest.mark.parametrize(
    "case",
    [
        ("AXIS", AxisSignal("error", lambda block: block.actual - block.commanded), "X.error", -0.05),
        ("JOINT", JointSignal("play", lambda joint: joint.load - joint.motor), "joint.X.play", -0.05),
        ("PATH", PathSignal("path.time", lambda block: block.t, "s"), "path.time", 0.5),
    ],
)
def test_a_row_is_a_channel(machine, joint, triangle, monkeypatch, case):
    table, row, name, expected = case
    monkeypatch.setattr(signals, table, (*getattr(signals, table), row))
    twin = Twin(machine=machine(joint("X", backlash=0.1)))
    recording = gather(twin.header(triangle(10)), twin.run(triangle(10)))
    assert recording[name][500] == pytest.approx(expected)
    assert np.isfinite(recording[name]).all()
