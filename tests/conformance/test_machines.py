"""Every machine shipped, and the registries a machine file names."""

from __future__ import annotations

from importlib import resources
from typing import TYPE_CHECKING

import numpy as np
import pytest

from trochia.machine.dump import dumps
from trochia.machine.joints import MOTORS
from trochia.machine.kinematics import KINEMATICS
from trochia.machine.load import load, loads, shipped
from trochia.machine.rates import step_rate
from trochia.machine.transmissions import TRANSMISSIONS

if TYPE_CHECKING:
    from trochia.machine.machine import Machine

NAMES = shipped()


@pytest.fixture(params=NAMES)
def machine(request: pytest.FixtureRequest) -> Machine:
    return load(request.param)


def test_the_promised_machines_are_there():
    assert {"xy-table", "laser", "lathe", "router", "corexy", "reference-mill"} <= set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_is_called_as_its_file_and_says_what_it_is(name: str):
    machine = load(name)
    assert machine.name == name
    assert machine.description


@pytest.mark.parametrize("name", NAMES)
def test_says_where_its_numbers_come_from(name: str):
    text = (resources.files("trochia") / "data" / "machines" / f"{name}.toml").read_text(encoding="utf-8")
    assert text.startswith("# ")


@pytest.mark.parametrize("comments", [False, True])
def test_what_is_written_reads_back_equal(machine: Machine, *, comments: bool):
    text = dumps(machine, comments=comments)
    assert loads(text) == machine
    assert dumps(loads(text), comments=comments) == text


def test_axis_positions_survive_the_way_to_joints_and_back(machine: Machine):
    matrix = machine.kinematics.matrix
    axes = np.array([[axis.minimum, axis.maximum, 1.0] for axis in machine.axes])
    np.testing.assert_allclose(np.linalg.pinv(matrix) @ (matrix @ axes), axes, atol=1e-9)


def test_no_joint_is_asked_for_more_steps_than_its_driver_takes(machine: Machine):
    for index, joint in enumerate(machine.joints):
        rate = step_rate(machine, index)
        if rate is not None:
            assert rate <= (joint.pulse_rate or np.inf)
            assert rate * (joint.pulses.length + joint.pulses.space) <= 1 + 1e-9


def test_the_shipped_machines_use_every_kind_there_is():
    machines = [load(name) for name in NAMES]
    joints = [joint for machine in machines for joint in machine.joints]
    assert {machine.kinematics.kind for machine in machines} == set(KINEMATICS)
    assert {joint.motor.kind for joint in joints} == set(MOTORS)
    # "travel" is what importers write: a transmission of which only the product is known
    assert {joint.transmission.kind for joint in joints} | {"travel"} == set(TRANSMISSIONS)


def test_the_yardstick_is_what_planners_were_promised():
    mill = load("reference-mill")
    assert [(a.velocity, a.acceleration, a.jerk, a.minimum, a.maximum) for a in mill.axes] == [
        (200.0, 800.0, 20000.0, -500.0, 500.0),
        (200.0, 800.0, 20000.0, -500.0, 500.0),
        (100.0, 400.0, 20000.0, -500.0, 500.0),
    ]
    assert mill.spindle is None or mill.spindle.spin_up == 0


def test_the_xy_table_is_the_one_described():
    table = load("xy-table")
    assert [joint.counts_per_unit for joint in table.joints] == [4096, 4096]
    assert {axis.velocity for axis in table.axes} == {40.0}
    assert {(axis.minimum, axis.maximum) for axis in table.axes} == {(-150.0, 150.0)}
    assert table.servo_period == 442e-6
    assert table.beam is not None
    assert table.beam.kind == "shutter"


def test_the_lathes_screw_is_exact():
    lathe = load("lathe")
    z = lathe.joints[1]
    assert z.counts_per_unit is not None
    assert z.counts_per_unit * 127 / 40 == 780  # counts for one turn of the screw of 3.175 mm
    assert lathe.spindle is not None
    assert lathe.spindle.encoder is not None
    assert lathe.spindle.encoder.counts == 40
