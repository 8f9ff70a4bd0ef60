"""Motors whose machine's errors are corrected: whatever is planned, none exceeds what its joint may do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import trochia
from trochia.api import gcode, plan
from trochia.machine.compensation import Compensation, Squareness
from trochia.machine.crossing import crossing_of
from trochia.machine.error_table import ErrorTable
from trochia.machine.reserve import limits_of
from trochia.pulses.motor_way import MotorWay

H = 0.001  #: between the places that are looked at [s]
spots = st.tuples(st.integers(105, 195), st.integers(105, 195))
moves = st.lists(st.tuples(spots, st.sampled_from(["G0", "G1", "arc"])), min_size=2, max_size=8)
#: of the table [mm], backlash [mm], its share, squareness [degree]
errors = st.tuples(st.floats(0.0, 0.02), st.floats(0.001, 0.1), st.floats(0.05, 0.4), st.floats(-0.5, 0.5))


def program(moves):
    """Return lines and arcs that turn round often."""
    lines, (x, y) = ["G21 G90 G64 P0.05 F30000", "G0 X150 Y150"], (150, 150)
    for (u, v), kind in moves:
        if kind == "arc" and (u, v) != (x, y):
            lines.append(f"G2 X{u} Y{v} I{(u - x) / 2} J{(v - y) / 2}")
        else:
            lines.append(f"{'G1' if kind == 'arc' else kind} X{u} Y{v}")
        x, y = u, v
    return "\n".join([*lines, "M2", ""])


def erring(name, height, backlash, share, skew):
    machine = trochia.load(name)
    joints = []
    for joint, axis in zip(machine.joints, machine.axes, strict=True):
        x = np.linspace(axis.minimum, axis.maximum, 31)
        table = ErrorTable(points=tuple(zip(x.tolist(), (height * np.sin(x / 11.0)).tolist(), strict=True)))
        given = Compensation(backlash=backlash, screw=table, share=share)
        joints.append(replace(joint, compensation=given))
    return replace(machine, joints=tuple(joints), squareness=Squareness(XY=skew))


@pytest.mark.parametrize("name", ["laser", "reference-mill"])
@settings(max_examples=25, deadline=None)
@given(moves=moves, errors=errors)
def test_no_motor_is_asked_for_more_than_its_joint_may(name, moves, errors):
    machine = erring(name, *errors)
    trajectory = plan(gcode(program(moves), machine), machine).trajectory
    way = MotorWay(machine, trajectory)
    times = np.arange(0.0, trajectory.duration + 0.5, H)
    places = np.concatenate([way.at(part) for part in np.array_split(times, 7)])
    for j in range(places.shape[1]):
        limit = limits_of(machine, j)
        velocity = np.diff(places[:, j]) / H
        acceleration = np.diff(velocity) / H
        assert np.abs(velocity).max() <= limit.velocity * (1 + 1e-6)
        assert np.abs(acceleration).max() <= limit.acceleration * (1 + 1e-4) + 1e-6
        if np.isfinite(limit.jerk):
            jerk = np.diff(acceleration) / H
            assert np.abs(jerk).max() <= limit.jerk * (1 + 1e-3) + 1e-2
    assert crossing_of(machine) is not None
