"""A program measured in parts is the program measured whole."""

from __future__ import annotations

import numpy as np
import pytest

import trochia
from trochia.toolpath import build, measure, measure_program


@pytest.fixture
def small_parts(monkeypatch: pytest.MonkeyPatch):
    import sys  # noqa: PLC0415

    monkeypatch.setattr(sys.modules["trochia.toolpath.measure"], "_PART", 7)


@pytest.mark.usefixtures("small_parts")
def test_parts_add_up():
    mill = trochia.load("reference-mill")
    lines = [f"G{i % 3} X{(7 * i) % 50} Y{(3 * i) % 40} " + ("R60" if i % 3 == 2 else "") for i in range(1, 60)]
    program = trochia.gcode("G21 F600 M3 S100\n" + "\n".join(lines) + "\nG95 F0.1 G1 X0\nM3 S50\nX9\nM2\n")
    whole, parts = measure(build(program, mill, blend=False)), measure_program(program, mill)
    assert (parts.moves, parts.feed_moves) == (whole.moves, whole.feed_moves)
    assert parts.feed_length == pytest.approx(whole.feed_length, rel=1e-14)
    assert parts.rapid_length == pytest.approx(whole.rapid_length, rel=1e-14)
    np.testing.assert_array_equal(parts.extents, whole.extents)
    np.testing.assert_array_equal(parts.feed_extents, whole.feed_extents)


def test_a_program_without_moves_has_the_extents_of_its_start():
    size = measure_program(trochia.gcode("M2\n"), trochia.load("reference-mill"))
    assert (size.moves, size.feed_length) == (0, 0.0)
    np.testing.assert_array_equal(size.extents, np.zeros((2, 3)))
