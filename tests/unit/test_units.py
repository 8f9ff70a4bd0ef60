"""Quantities: text with units to base units, by dimension, and back."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia import units
from trochia.errors import UnitError


@pytest.mark.parametrize(
    ("text", "dimension", "value"),
    [
        ("300 mm/s", "velocity", 300.0),
        ("18 m/min", "velocity", 300.0),
        ("1 in", "length", 25.4),
        ("1in/s^2", "acceleration", 25.4),
        ("0.8 m/s²", "acceleration", 800.0),
        ("20000 mm/s3", "jerk", 20000.0),
        ("442 us", "time", 442e-6),
        ("2 rev/s", "rotation speed", 120.0),
        ("1 rev", "angle", 360.0),
        ("-.5 mm", "length", -0.5),
        ("1e3 µm", "length", 1.0),
    ],
)
def test_reads(text: str, dimension: str, value: float):
    assert units.parse(text, dimension) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    "text", ["300", "300 A", "mm/s", "", "3 00 mm/s", "nan mm/s", "inf mm/s", 300, None, "1e999 mm/s"]
)
def test_refuses(text: object):
    with pytest.raises(UnitError) as caught:
        units.parse(text, "velocity")
    assert repr(text) in str(caught.value)


def test_says_which_units_would_do():
    with pytest.raises(UnitError, match=r"Units that would do: mm, m, cm"):
        units.parse("3 furlong", "length")


@given(st.floats(allow_nan=False, allow_infinity=False), st.sampled_from(sorted(units.UNITS)))
def test_what_is_written_reads_back_exactly(value: float, dimension: str):
    assert units.parse(units.render(value, dimension), dimension) == value


@given(st.sampled_from([(d, u) for d, row in units.UNITS.items() for u in row]))
def test_the_first_unit_of_a_dimension_is_its_base(pair: tuple[str, str]):
    dimension, unit = pair
    assert units.parse(f"1 {unit}", dimension) == units.UNITS[dimension][unit]
    assert next(iter(units.UNITS[dimension].values())) == 1.0
