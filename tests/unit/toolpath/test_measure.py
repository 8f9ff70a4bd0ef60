"""Lengths, counts and travel against numbers known beforehand."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from trochia.languages import gcode
from trochia.machine.load import load
from trochia.toolpath import build, first_outside, fitting_shift, measure

PROGRAMS = Path(__file__).parents[3] / "programs"
MILL = load("reference-mill")


def read(text):
    return gcode.read(text if isinstance(text, bytes) else text + "\nM2\n")


def measured(text, machine=MILL):
    return measure(build(read(text), machine, blend=False))


def narrowed(**travel):
    axes = []
    for axis in MILL.axes:
        low, high = travel.get(axis.name, (axis.minimum, axis.maximum))
        axes.append(dataclasses.replace(axis, minimum=low, maximum=high))
    return tuple(axes)


@pytest.mark.parametrize(
    ("name", "moves", "length", "least", "greatest"),
    [
        ("contour", 194, 1319.713, (8.006, 8.008), (91.992, 91.994)),
        ("hatch", 160, 2107.600, None, None),
    ],
)
def test_the_specimens_of_the_table(name, moves, length, least, greatest):
    size = measured((PROGRAMS / f"{name}.ngc").read_bytes(), load("xy-table"))
    assert size.feed_moves == moves
    assert size.feed_length == pytest.approx(length, abs=5e-4)
    if least:
        assert size.feed_extents == pytest.approx(np.array([least, greatest]), abs=5e-4)


def test_rapids_and_feeds_are_kept_apart():
    size = measured("G0 X3 Y4\nG1 Z-1 F100\nX3\nG0 Z0")
    assert (size.moves, size.feed_moves) == (3, 1)
    assert (size.feed_length, size.rapid_length) == (1.0, 6.0)
    assert size.extents == pytest.approx(np.array([[0, 0, -1], [3, 4, 0]]))
    assert size.feed_extents == pytest.approx(np.array([[3, 4, -1], [3, 4, 0]]))


def test_turning_an_axis_is_no_length():
    size = measured("G1 X10 F100\nA90", load("rotary-mill"))
    assert (size.feed_moves, size.feed_length) == (2, 10.0)


def test_no_feed_no_extents():
    assert np.isinf(measured("G0 X1").feed_extents).all()


def test_an_arc_that_bulges_out_is_found_though_its_ends_are_inside():
    program = read("G0 X10\nG1 X20 F100\nG3 X20 Y10 J5\nG1 X0")
    path = build(program, MILL, blend=False)
    found = first_outside(path, narrowed(X=(0, 22)))
    assert (found.axis, found.segment) == ("X", 2)
    assert program.moves["line"][path.segments["move"][found.segment]] == 3
    assert found.position == pytest.approx(25)
    assert found.excess == pytest.approx(3)


def test_below_the_travel_the_excess_is_negative():
    path = build(read("G0 X-4"), MILL)
    assert first_outside(path, narrowed(X=(-1, 1))).excess == pytest.approx(-3)


def test_the_very_end_of_travel_is_inside():
    assert first_outside(build(read("G0 X500"), MILL), MILL.axes) is None


@pytest.mark.parametrize("count", [1, 2, 7, 64])
def test_the_first_of_many_is_named(count):
    text = "G61\n" + "\n".join(f"G0 X{k % 3}" for k in range(1, count + 1)) + "\nG0 X9\nG0 X1\nG0 X12"
    path = build(read(text), MILL, blend=False)
    assert path.segments["move"][first_outside(path, narrowed(X=(-5, 5))).segment] == count


def test_the_least_shift_that_fits():
    bounds = np.array([[-10.0, 0, 0], [20, 5, 0]])
    assert fitting_shift(bounds, narrowed(X=(0, 40))) == pytest.approx([10, 0, 0])
    assert fitting_shift(bounds, narrowed(X=(-40, 15))) == pytest.approx([-5, 0, 0])
    assert fitting_shift(bounds, narrowed(X=(0, 29))) is None
