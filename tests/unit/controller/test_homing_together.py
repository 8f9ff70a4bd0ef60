"""Axes of one order that go home together: where they end up, when they go, and what keeps them apart."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from trochia.controller.search import rounds
from trochia.machine.homing import LimitSwitch
from trochia.machine.kinematics import CoreXY
from trochia.messages import Cause
from trochia.messages import command as c

if TYPE_CHECKING:
    from trochia.machine.machine import Machine

STEP = 0.005  #: of the mill's motors [mm]
RESTS = 5.0  #: from the ends of travel [mm]


def homes(machine: Machine, **changes: dict[str, object]) -> Machine:
    """The machine with other keys in the homing of some axes."""
    axes = tuple(
        replace(axis, home=replace(axis.home, **changes[axis.name])) if axis.name in changes and axis.home else axis
        for axis in machine.axes
    )
    return replace(machine, axes=axes)


def moving(b) -> np.ndarray:
    """Which joints have moved from turn to turn (turns, joints)."""
    joints = np.array([entry[1] for entry in b.trace])
    return np.abs(np.diff(joints, axis=0)) > 1e-6


def at_rest(b, machine: Machine) -> None:
    """Hold the joints' real places against where the machine file has them rest."""
    rests = [axis.minimum + RESTS for axis in machine.axes]
    np.testing.assert_allclose(b.twin.plant.load, machine.kinematics.matrix @ np.array(rests), atol=3 * STEP)
    assert all(axis.trusted for axis in b.status.axes)


@pytest.fixture
def level_mill(homed_mill: Machine) -> Machine:
    """The mill whose axes are all of one order."""
    return homes(homed_mill, **{axis.name: {"order": 0} for axis in homed_mill.axes})


STARTS = [
    (0.0, 0.0, 0.0),
    (-3.0, -140.0, 20.0),
    (-199.5, 4.0, 0.0),  # X stands on its switch
    (-199.5, -149.9, -99.5),  # all do
    (-197.98, -100.0, -10.0),
]


@pytest.mark.parametrize("start", STARTS)
def test_axes_together_find_their_places_as_well_as_alone(bench, level_mill: Machine, start: tuple[float, ...]) -> None:
    real = {axis.name: axis.minimum + 60.0 + way for axis, way in zip(level_mill.axes, start, strict=True)}
    real = {name: max(at, axis.minimum + 0.2) for (name, at), axis in zip(real.items(), level_mill.axes, strict=True)}
    b = bench(level_mill, real=real).on()
    b.ok(c.Home())
    b.run(until="idle")
    at_rest(b, level_mill)


def test_switches_that_trip_in_the_same_instant_are_told_apart(bench, level_mill: Machine) -> None:
    same = {"search": 20.0, "latch": 2.0}
    machine = homes(level_mill, X=same, Y=same, Z=same)
    b = bench(machine, real={axis.name: axis.minimum + 30.0 for axis in machine.axes}).on()
    b.ok(c.Home())
    b.run(until="idle")
    at_rest(b, machine)


@pytest.mark.parametrize("orders", [{}, {"X": 3, "Y": 3, "Z": 2}])
def test_z_leaves_the_work_first_or_whom_the_file_says(bench, homed_mill: Machine, orders: dict[str, int]) -> None:
    machine = homes(homed_mill, **{axis: {"order": order} for axis, order in orders.items()})
    b = bench(machine, real={axis.name: axis.minimum + 40.0 for axis in machine.axes}).on()
    begin = len(b.trace)
    b.ok(c.Home())
    b.run(until="idle")
    ways = moving(b)[begin:]
    assert (ways[:, 0] & ways[:, 1]).sum() > 100
    assert not (ways[:, 2] & (ways[:, 0] | ways[:, 1])).any()
    assert np.flatnonzero(ways[:, 2]).max() < np.flatnonzero(ways[:, 0]).min()  # the lower order first
    at_rest(b, machine)


def test_together_takes_little_more_than_the_longest(bench, level_mill: Machine) -> None:
    def taken(machine: Machine, *axes: str) -> float:
        b = bench(machine, real={axis.name: axis.minimum + 40.0 for axis in machine.axes}).on()
        begin = b.now
        b.ok(c.Home(axes=axes))
        b.run(until="idle")
        return b.now - begin

    alone = [taken(level_mill, axis.name) for axis in level_mill.axes]
    assert taken(level_mill) < 1.5 * max(alone) < sum(alone)


def test_the_search_goes_at_the_speed_of_each(bench, level_mill: Machine) -> None:
    machine = homes(level_mill, X={"search": 12.0}, Y={"search": 30.0})
    b = bench(machine, real={"X": machine.axes[0].minimum + 150.0, "Y": machine.axes[1].minimum + 150.0}).on()
    b.ok(c.Home(axes=("X", "Y")))
    b.run(2.0)
    velocity = b.runtime.controller.report.velocity
    np.testing.assert_allclose(velocity[:2], [-12.0, -30.0], rtol=1e-3)


def test_a_switch_that_is_not_found_stops_all_and_names_its_axis(bench, level_mill: Machine) -> None:
    b = bench(level_mill, real={axis.name: axis.minimum + 40.0 for axis in level_mill.axes})
    b.twin._switches |= {"home-Y": lambda _: False, "limit-Y": lambda _: False}
    b.on().ok(c.Home())
    b.run(until="alarm")
    b.run(1.0)
    assert "home-Y was not found" in b.status.alarms[0].message
    assert "homing Y" in b.status.alarms[0].message
    assert not any(axis.trusted for axis in b.status.axes)
    assert not b.runtime.controller.report.velocity.any()


def test_a_limit_met_by_one_stops_all(bench, level_mill: Machine) -> None:
    b = bench(level_mill, real={axis.name: axis.minimum + 40.0 for axis in level_mill.axes})
    b.twin._switches["home-X"] = lambda _: False
    b.on().ok(c.Home())
    status = b.run(until="alarm")
    assert status.alarms[0].cause is Cause.HARD_LIMIT
    b.run(0.5)
    assert not b.runtime.controller.report.velocity.any()


def test_a_belt_over_both_motors_is_homed_in_both_directions_at_once(bench, level_mill: Machine) -> None:
    machine = replace(level_mill, kinematics=CoreXY(3))
    start = np.array([axis.minimum + way for axis, way in zip(machine.axes, (33.0, 21.0, 12.0), strict=True)])
    real = dict(zip((j.name for j in machine.joints), machine.kinematics.matrix @ start, strict=True))
    b = bench(machine, real=real).on()
    b.ok(c.Home())
    b.run(until="idle")
    at_rest(b, machine)


def names(machine: Machine) -> list[list[str]]:
    """The axes of each round."""
    return [[axis.name for axis in some] for some in rounds(machine.axes)]


def test_axes_that_share_a_switch_go_by_turns(level_mill: Machine) -> None:
    assert names(level_mill) == [["X", "Y", "Z"]]
    assert names(homes(level_mill, Y={"input": "home-X"})) == [["X", "Z"], ["Y"]]


def test_an_axis_that_would_brake_too_far_for_another_goes_by_itself(level_mill: Machine) -> None:
    slow = replace(level_mill.axes[2], acceleration=20.0)
    assert names(replace(level_mill, axes=(*level_mill.axes[:2], slow))) == [["X", "Y"], ["Z"]]


def test_an_axis_whose_limit_stands_close_behind_goes_by_itself(level_mill: Machine) -> None:
    x = level_mill.axes[0]
    x = replace(x, limit_minus=LimitSwitch(input="limit-X", at=x.minimum + 0.9999))
    assert names(replace(level_mill, axes=(x, *level_mill.axes[1:]))) == [["X"], ["Y", "Z"]]
