"""The twin's joint in C against a plain statement of it, and the laws of its parts."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.errors import ConfigError, LimitError
from trochia.kernels.twin import TwinJoint

SNAP = 1e-6

commands = st.lists(st.floats(-50, 50), min_size=1, max_size=60).map(np.array)
widths = st.sampled_from([0.0, 0.003, 0.02, 1.5])
slacks = st.sampled_from([-1.0, 0.0, 0.4, 1.0])
gearings = st.sampled_from([Fraction(200, 5), Fraction(-3200, 7), Fraction(254, 100), Fraction(1, 3)])


def play(path, width, slack, start):
    """Plain statement of the play operator: the load is dragged along, never more than half the width away."""
    load = start + slack * width / 2
    for motor in path:
        load = max(motor - width / 2, min(load, motor + width / 2))
        yield load


def steps(path, per_unit, start):
    """Plain statement of the stepper: go step by step until the next one would pass the command."""
    at = math.floor(start * per_unit + 0.5)
    for command in path:
        while at + 1 <= command * per_unit + SNAP:
            at += 1
        while at - 1 >= command * per_unit - SNAP:
            at -= 1
        yield at


def near_boundary(path, per_unit):
    """Whether rounding could decide which side of a boundary a command is on."""
    scaled = np.abs(np.asarray(path) * float(per_unit))
    return bool((np.abs(np.abs(scaled - np.rint(scaled)) - SNAP) < 1e-8).any())


@given(commands, gearings, widths, slacks)
def test_stepper_equals_reference(path, per_unit, width, slack):
    if near_boundary(path, per_unit):
        return
    joint = TwinJoint(path[0], steps_per_unit=per_unit, counts_per_unit=Fraction(1000, 3), backlash=width, slack=slack)
    block = joint.run(path)
    expected = list(steps(path, float(per_unit), path[0]))
    np.testing.assert_array_equal(block.position, expected)
    np.testing.assert_allclose(block.motor, np.array(expected) / float(per_unit), rtol=1e-15)
    np.testing.assert_array_equal(block.counts, [math.floor(at / per_unit * Fraction(1000, 3)) for at in expected])
    first = math.floor(path[0] * float(per_unit) + 0.5) / float(per_unit)
    np.testing.assert_allclose(block.load, list(play(block.motor, width, slack, first)), atol=1e-12)


@given(commands, gearings)
def test_stepper_stays_within_a_step_of_its_command(path, per_unit):
    block = TwinJoint(path[0], steps_per_unit=per_unit).run(path)
    assert np.abs(block.position - path * float(per_unit)).max() <= 1 - SNAP + 1e-9
    on_step = np.round(path * float(per_unit)) / float(per_unit)
    arrived = TwinJoint(on_step[0], steps_per_unit=per_unit).run(on_step)
    np.testing.assert_array_equal(arrived.position, np.round(on_step * float(per_unit)))


def test_last_step_passed_takes_a_whole_step_to_turn_back():
    up_and_down = np.array([0, 0.9, 1.0, 2.5, 2.0, 1.5, 1.0, 0.5, 0.0, -0.9, -1.0])
    block = TwinJoint(0.0, steps_per_unit=Fraction(1)).run(up_and_down)
    assert block.position.tolist() == [0, 0, 1, 2, 2, 2, 1, 1, 0, 0, -1]


def test_last_step_of_a_job_is_not_lost_to_rounding():
    tenths = np.cumsum(np.full(1000, 0.1))  # ends at 99.9999999999986
    assert tenths[-1] < 100
    assert TwinJoint(0.0, steps_per_unit=Fraction(200)).run(tenths).position[-1] == 20_000


@given(commands, gearings)
def test_servo_stands_on_the_nearest_count(path, per_unit):
    block = TwinJoint(path[0], counts_per_unit=per_unit).run(path)
    assert np.abs(block.position - path * float(per_unit)).max() <= 0.5 + 1e-9
    np.testing.assert_array_equal(block.counts, block.position)


@given(commands, widths, slacks)
def test_joint_without_steps_and_encoder_follows_exactly(path, width, slack):
    block = TwinJoint(path[0], backlash=width, slack=slack).run(path)
    assert block.position is None
    assert block.counts is None
    np.testing.assert_array_equal(block.motor, path)
    np.testing.assert_allclose(block.load, list(play(path, width, slack, path[0])), atol=1e-15)


@given(commands, widths)
def test_encoder_on_the_load_reads_the_floor_of_the_load(path, width):
    block = TwinJoint(
        path[0], steps_per_unit=Fraction(40), counts_per_unit=Fraction(250), on_load=True, backlash=width
    ).run(path)
    np.testing.assert_array_equal(block.counts, np.floor(block.load * 250 + SNAP))


@given(commands, widths, slacks)
def test_play_keeps_the_load_within_half_the_dead_zone(path, width, slack):
    block = TwinJoint(path[0], backlash=width, slack=slack).run(path)
    assert np.abs(block.load - block.motor).max() <= width / 2 + 1e-12


@given(commands, st.lists(st.floats(0, 5), min_size=60, max_size=60), widths)
def test_play_is_monotone(path, more, width):
    above = path + np.array(more[: len(path)])
    low = TwinJoint(path[0], backlash=width).run(path)
    high = TwinJoint(above[0], backlash=width).run(above)
    assert (high.load >= low.load - 1e-12).all()


@given(commands, st.integers(1, 7), widths, gearings)
def test_joint_is_rate_independent(path, cuts, width, per_unit):
    """The same way at another speed ends in the same places: straight moves cut into pieces change nothing."""
    slow = np.concatenate([np.linspace(a, b, cuts, endpoint=False) for a, b in pairwise(path)] or [[]])
    slow = np.append(slow, path[-1])
    for parameters in ({"backlash": width}, {"backlash": width, "steps_per_unit": per_unit}):
        fast, fine = (TwinJoint(path[0], **parameters).run(way) for way in (path, slow))
        np.testing.assert_allclose(fine.load[::cuts], fast.load, atol=1e-12)


@given(commands, st.lists(st.integers(0, 60), max_size=5), widths, gearings)
def test_any_cut_into_blocks_gives_the_same_samples(path, cuts, width, per_unit):
    given = {"steps_per_unit": per_unit, "counts_per_unit": Fraction(77, 3), "backlash": width, "slack": -0.3}
    whole = TwinJoint(path[0], **given).run(path)
    joint = TwinJoint(path[0], **given)
    blocks = [joint.run(part) for part in np.split(path, sorted(min(cut, len(path)) for cut in cuts))]
    for field in ("position", "motor", "counts", "load"):
        np.testing.assert_array_equal(np.concatenate([getattr(b, field) for b in blocks]), getattr(whole, field))


@pytest.mark.parametrize("command", [math.nan, math.inf, -math.inf, 1e12])
def test_what_cannot_be_counted_is_refused(command):
    with pytest.raises(LimitError, match="joint Z counts to less than"):
        TwinJoint(command, name="Z", steps_per_unit=Fraction(200))
    with pytest.raises(LimitError):
        TwinJoint(0.0, steps_per_unit=Fraction(200)).run(np.array([0.0, command]))


def test_parameters_out_of_range_are_refused():
    with pytest.raises(ConfigError, match="backlash"):
        TwinJoint(0.0, backlash=-0.1)
    with pytest.raises(ConfigError, match="encoder"):
        TwinJoint(0.0, steps_per_unit=Fraction(1, 2**31 - 1), counts_per_unit=Fraction(2))
