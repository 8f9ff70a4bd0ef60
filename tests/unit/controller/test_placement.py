"""Rules for the places of switches, by hand."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from trochia.controller.placement import braking_distance, placement
from trochia.machine.homing import Homing, LimitSwitch
from trochia.messages import command as c

if TYPE_CHECKING:
    from trochia.machine.axes import Axis
    from trochia.machine.machine import Machine


@pytest.fixture
def axis(mill: Machine) -> Axis:
    made = mill.axes[0]
    return replace(made, minimum=0.0, maximum=100.0, velocity=50.0, acceleration=500.0, jerk=None,
                   home=Homing(input="home", towards="+", position=100.0, search=50.0),
                   limit_plus=LimitSwitch(input="limit", at=103.0))  # fmt: skip


def test_the_braking_distance_is_that_of_a_ramp(axis: Axis) -> None:
    assert braking_distance(axis, 50.0) == pytest.approx(2.5)
    assert braking_distance(replace(axis, jerk=5000.0), 50.0) == pytest.approx(2.5 + 50.0 * 500.0 / 10000.0)


def test_switches_in_their_right_places_are_all_right(axis: Axis) -> None:
    assert list(placement(axis)) == []
    assert list(placement(replace(axis, home=None))) == []


@pytest.mark.parametrize(("at", "why"), [(102.0, "brakes in 2.5 mm"), (99.0, "inside the travel"), (100.0, "behind")])
def test_each_rule_is_told_when_it_is_broken(axis: Axis, at: float, why: str) -> None:
    assert any(why in text for text in placement(replace(axis, limit_plus=LimitSwitch(input="limit", at=at))))


def test_home_before_the_limit_binds_on_the_side_of_the_search_alone(axis: Axis) -> None:
    assert list(placement(replace(axis, limit_minus=LimitSwitch(input="other", at=-0.1)))) == []


def test_the_limit_may_be_home_itself_and_rest_lies_in_the_travel(axis: Axis) -> None:
    home = Homing(method="limit", towards="+", position=100.0, rest=120.0)
    texts = list(placement(replace(axis, home=home, limit_plus=LimitSwitch(input="limit", at=99.0))))
    assert len(texts) == 1
    assert "rest at 120" in texts[0]


def test_an_axis_with_its_switches_in_wrong_places_is_not_homed(bench, homed_mill: Machine) -> None:
    x = replace(homed_mill.axes[0], limit_minus=LimitSwitch(input="limit-X", at=homed_mill.axes[0].minimum + 50.0))
    b = bench(replace(homed_mill, axes=(x, *homed_mill.axes[1:]))).on()
    answer = b.command(c.Home())
    assert not answer.ok
    assert "cannot be homed safely" in answer.reason
    assert b.status.state == "idle"
