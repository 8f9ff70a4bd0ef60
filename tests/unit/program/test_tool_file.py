"""Tool tables: what is read, what is refused, and that writing is the inverse of reading."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.errors import ConfigError
from trochia.program.tool_file import read_tools, write_tools
from trochia.program.tools import Tool

INCH = 25.4


def test_words_in_any_order_with_a_remark():
    (tool,) = read_tools("; table\n\np3 Z+12.5 T7 D.5 x-1 Q2 I10 J-20 ;end mill ; 4 mm\n", "t")
    assert (tool.number, tool.pocket, tool.diameter, tool.orientation) == (7, 3, 0.5, 2)
    assert (tool.front, tool.back, tool.remark) == (10.0, -20.0, "end mill ; 4 mm")
    assert tool.offset == (-1.0, 0.0, 12.5, 0, 0, 0, 0, 0, 0)


def test_lengths_in_inches_angles_in_degrees():
    (tool,) = read_tools("T1 Z1 A2 U3 D4\n", "t", unit=INCH)
    assert tool.offset == (0, 0, 25.4, 2.0, 0, 0, pytest.approx(76.2), 0, 0)
    assert tool.diameter == pytest.approx(101.6)


@pytest.mark.parametrize(
    ("text", "said"),
    [("T1 P1 foo", "'foo'"), ("P1 Z2", "no number T"), ("T1 T2", "stands twice"), ("T1.5", "whole number"),
     ("T-1", "whole number"), ("T1 ZX", "'ZX'"), ("T1 Q12", "orientation"), ("T1\nT1 Z2", "line 1 already"),
     ("T5P1", "'T5P1'")],
)  # fmt: skip
def test_wrong_lines_are_named(text, said):
    with pytest.raises(ConfigError, match=r"tool\.tbl, line") as caught:
        read_tools(text, "tool.tbl")
    assert said in str(caught.value)


NUMBER = st.integers(-(10**7), 10**7).map(lambda n: n / 1000)
TOOL = st.builds(
    Tool, number=st.integers(0, 9999), pocket=st.integers(0, 999), offset=st.tuples(*[NUMBER] * 9),
    diameter=NUMBER, front=NUMBER, back=NUMBER, orientation=st.integers(0, 9),
    remark=st.text("abc ;.", max_size=9).map(str.strip),
)  # fmt: skip


@given(st.lists(TOOL, max_size=5, unique_by=lambda tool: tool.number))
def test_what_is_written_is_read_again(tools):
    assert read_tools(write_tools(tools), "t") == tuple(tools)
    again = read_tools(write_tools(tools, unit=INCH), "t", unit=INCH)
    for tool, other in zip(tools, again, strict=True):
        assert other.offset == pytest.approx(tool.offset, abs=2e-5)
