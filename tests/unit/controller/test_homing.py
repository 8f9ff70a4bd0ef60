"""Ways home: an index pulse, a switch and an index, an encoder that knows, the two joints of a gantry."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
import pytest

from trochia.errors import ConfigError
from trochia.machine.homing import Homing, LimitSwitch
from trochia.machine.io import Channel
from trochia.machine.joints import Encoder, Servo
from trochia.machine.kinematics import Cartesian
from trochia.messages import command as c

if TYPE_CHECKING:
    from trochia.machine.machine import Machine

STEP = 0.005  #: of the mill's motors [mm]
TURN = 10.0  #: of its screws [mm]


def with_home(machine: Machine, home: Homing, *names: str, limit: float | None = None) -> Machine:
    """The machine with a way home for X alone, its joint a servo with an index."""
    io = (*machine.io, *(Channel(name=name, kind="input") for name in names))
    end = None if limit is None else LimitSwitch(input="end", at=limit)
    x = replace(machine.axes[0], home=home, limit_minus=end)
    joint = replace(machine.joints[0], motor=Servo(), encoder=Encoder(counts=Fraction(20000), index=True))
    return replace(machine, axes=(x, *machine.axes[1:]), joints=(joint, *machine.joints[1:]), io=io)


@pytest.mark.parametrize(("towards", "edge"), [("-", -40.0), ("+", -30.0)])
def test_an_index_alone_is_the_next_one_in_its_direction(bench, mill: Machine, towards: str, edge: float) -> None:
    b = bench(with_home(mill, Homing(method="index", towards=towards, position=7.0)), real={"X": -33.3}).on()
    b.ok(c.Home(axes=("X",)))
    b.run(until="idle")
    assert b.status.axes[0].trusted
    real = b.twin.plant.load[0]
    assert b.at("X") - 7.0 == pytest.approx(real - edge, abs=2e-3)  # counts of half a µm, and a share of a tick


def test_a_switch_and_then_the_index_beyond_it(bench, mill: Machine) -> None:
    home = Homing(method="switch-index", input="near", towards="-", position=-203.0, rest=-190.0)
    b = bench(with_home(mill, home, "near"), real={"X": -150.0}).on()
    b.ok(c.Home(axes=("X",)))
    b.run(until="idle")
    # the switch trips at -203 of the truth, the next whole turn is -210: that is called -203
    assert b.at("X") == pytest.approx(-190.0, abs=1e-6)
    assert b.twin.plant.load[0] == pytest.approx(-197.0, abs=2e-3)


def test_the_index_has_to_lie_before_the_limit(bench, mill: Machine) -> None:
    home = Homing(method="switch-index", input="near", towards="-", position=-501.0, search=5.0)
    b = bench(with_home(mill, home, "near", "end", limit=-511.0)).on()
    answer = b.command(c.Home(axes=("X",)))
    assert not answer.ok
    assert "finds an index in 11 mm" in answer.reason


def test_an_index_that_does_not_come_is_an_alarm(bench, mill: Machine) -> None:
    b = bench(with_home(mill, Homing(method="index")), real={"X": -33.3}).on()
    b.twin._indexes.passed = lambda *_: None
    b.ok(c.Home(axes=("X",)))
    assert "no index pulse came" in b.run(until="alarm").alarms[0].message


def test_a_backend_without_indexes_is_not_asked_for_one(bench, mill: Machine) -> None:
    b = bench(with_home(mill, Homing(method="index"))).on()
    del b.twin.inputs["X.index"]
    b.run(0.01)
    assert "cannot catch" in b.command(c.Home(axes=("X",))).reason


def test_an_absolute_encoder_knows_at_power_up(bench, mill: Machine) -> None:
    b = bench(with_home(mill, Homing(method="absolute")), real={"X": -33.3}).on()
    assert b.at("X") == pytest.approx(-33.3)
    b.ok(c.Home(axes=("X",)))
    b.run(until="idle")
    assert b.status.axes[0].trusted
    b.ok(c.JogTo(position={"X": -30.0}))
    b.run(until="idle")
    assert b.twin.plant.load[0] == pytest.approx(-30.0, abs=2e-3)


@pytest.fixture
def gantry(mill: Machine) -> Machine:
    home = Homing(input="left", second="right", towards="-", position=-400.0, rest=-390.0, back_off=3.0, square=0.25)
    x = replace(mill.axes[0], minimum=-500.0, maximum=500.0, home=home)
    joints = (*mill.joints, replace(mill.joints[0], name="X2"))
    io = (*mill.io, Channel(name="left", kind="input"), Channel(name="right", kind="input"))
    return replace(mill, axes=(x, *mill.axes[1:]), joints=joints, kinematics=Cartesian((0, 1, 2, 0), 3), io=io)


@pytest.mark.parametrize("rack", [-0.8, 0.0, 1.3])
def test_both_joints_of_a_gantry_go_to_their_own_switch_and_stand_square(bench, gantry: Machine, rack: float) -> None:
    b = bench(gantry, real={"X": -380.0, "X2": -380.0 + rack}).on()
    b.ok(c.Home(axes=("X",)))
    b.run(until="idle")
    assert b.at("X") == pytest.approx(-390.0, abs=1e-6)
    first, second = b.twin.plant.load[[0, 3]]
    assert first == pytest.approx(-390.0, abs=3 * STEP)
    assert second == pytest.approx(-390.0, abs=3 * STEP)
    commanded = b.runtime.controller.report.commanded
    assert commanded[0] == pytest.approx(commanded[3], abs=1e-9)
    b.ok(c.JogBy(way={"X": 4.0, "Y": 1.0}))
    b.run(until="idle")
    np.testing.assert_allclose(b.twin.plant.load[[0, 3]], -386.0, atol=3 * STEP)


def test_a_gantry_racked_too_far_is_an_alarm_and_can_be_moved_then(bench, gantry: Machine) -> None:
    b = bench(gantry, real={"X": -380.0, "X2": -360.0}).on()
    b.ok(c.Home(axes=("X",)))
    b.run(until="alarm")
    assert "other joint of the gantry" in b.status.alarms[0].message
    b.run(1.0)
    b.ok(c.Acknowledge())
    b.run(until="idle")
    b.ok(c.JogBy(way={"X": 2.0}))
    b.run(until="idle")
    assert not b.status.alarms


def test_a_gantry_whose_homing_is_held_can_be_moved_then(bench, gantry: Machine) -> None:
    b = bench(gantry, real={"X": -398.0, "X2": -397.0}).on()
    b.ok(c.Home(axes=("X",)))
    apart = 0.0
    while apart < 0.2:  # the second joint goes alone
        b.run(0.005)
        commanded = b.runtime.controller.report.commanded
        apart = abs(commanded[0] - commanded[3])
    b.ok(c.Hold())
    b.run(until="idle")
    b.run(0.01)
    b.ok(c.JogBy(way={"X": 2.0}))
    b.run(until="idle")
    assert not b.status.alarms


def test_a_gantry_stopped_while_apart_is_not_jogged_but_homed(bench, gantry: Machine) -> None:
    b = bench(gantry, real={"X": -398.0, "X2": -397.0}).on()
    b.ok(c.Home(axes=("X",)))
    apart = 0.0
    while apart < 0.2:
        b.run(0.005)
        commanded = b.runtime.controller.report.commanded
        apart = abs(commanded[0] - commanded[3])
    b.ok(c.EmergencyStop())
    b.run(0.02)
    b.ok(c.Reset())
    b.on()
    assert "stand apart" in b.command(c.JogBy(way={"X": 2.0})).reason
    b.ok(c.Home(axes=("X",)))
    b.run(until="idle")
    np.testing.assert_allclose(b.twin.plant.load[[0, 3]], -390.0, atol=3 * STEP)


def test_only_a_pair_of_joints_has_a_second_switch(gantry: Machine) -> None:
    with pytest.raises(ConfigError, match="two joints"):
        replace(gantry, kinematics=Cartesian((0, 1, 2, 1), 3))


@pytest.mark.parametrize(
    ("change", "why"),
    [({"method": "limit"}, "method must be switch"), ({"second": "nowhere"}, "no input 'nowhere'")],
)
def test_a_gantry_is_homed_by_switches_that_are_there(gantry: Machine, change: dict[str, str], why: str) -> None:
    x = gantry.axes[0]
    assert x.home is not None
    x = replace(x, home=replace(x.home, **change), limit_minus=LimitSwitch(input="left", at=-502.0))
    with pytest.raises(ConfigError, match=why):
        replace(gantry, axes=(x, *gantry.axes[1:]))
