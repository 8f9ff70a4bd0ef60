"""Quantities that must stay exact: gearing, from the text to integers."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia import units
from trochia.errors import UnitError


@pytest.mark.parametrize(
    ("text", "dimension", "value"),
    [
        ("2 mm", "length", Fraction(2)),
        ("0.2 in", "length", Fraction(127, 25)),
        ("3.175 mm", "length", Fraction(127, 40)),
        ("25/8 mm", "length", Fraction(25, 8)),
        ("1e-3 m", "length", Fraction(1)),
        ("1/3 rev", "angle", Fraction(120)),
        ("90 arcmin", "angle", Fraction(3, 2)),
    ],
)
def test_reads_exactly(text: str, dimension: str, value: Fraction):
    assert units.parse_fraction(text, dimension) == value


@pytest.mark.parametrize("text", ["2", "2 A", "1 rad", "1/0 mm", "mm", "1/2/3 mm", "1e999999999 mm", 2, None, "nan mm"])
def test_refuses_what_is_not_exact(text: object):
    dimension = "angle" if text == "1 rad" else "length"
    with pytest.raises(UnitError) as caught:
        units.parse_fraction(text, dimension)
    assert str(text) in str(caught.value)


@pytest.mark.parametrize(
    ("value", "ratio"),
    [
        (5, 5),
        ("5/2", Fraction(5, 2)),
        ("26:1", 26),
        ("0.75", Fraction(3, 4)),
        (Decimal("2.5"), Fraction(5, 2)),
        (-3, -3),
    ],
)
def test_reads_ratios(value: object, ratio: Fraction):
    assert units.parse_ratio(value) == ratio


@pytest.mark.parametrize("value", ["1/0", "2 mm", "five", True, None, "", Decimal("nan"), Decimal("inf"), [1]])
def test_refuses_other_ratios(value: object):
    with pytest.raises(UnitError, match="bare number"):
        units.parse_ratio(value)


@given(st.fractions(), st.sampled_from(["length", "angle", None]))
def test_what_is_written_reads_back_exactly(value: Fraction, dimension: str | None):
    text = units.render_fraction(value, dimension)
    back = units.parse_fraction(text, dimension) if dimension else units.parse_ratio(text)
    assert back == value


def test_a_quantity_is_rounded_once():
    assert units.parse("6 in", "length") == 152.4


def test_names_the_dimension_of_a_foreign_unit():
    with pytest.raises(UnitError, match=r"A is a unit of current"):
        units.parse("2 A", "velocity")


def test_names_the_nearest_unit():
    with pytest.raises(UnitError, match=r"did you mean mm/s\?"):
        units.parse("5 mm/sec", "velocity")
