"""Parameter files: which numbers mean what, what is refused, and that writing is the inverse of reading."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.errors import ConfigError
from trochia.program import WorkState
from trochia.program.parameter_file import read_variables, variables_of, work_from, write_variables

INCH = 25.4


def test_numbers_mean_offsets_and_points():
    text = "31 7\n5161 1\n5183 2\n5210 1\n5211 3\n5220 2\n5221 4\n5230 30\n5244 5\n5381 6\n"
    work = work_from(read_variables(text, "v"), unit=INCH)
    assert work.g28[0] == work.systems[0][0] / 4 == pytest.approx(25.4)
    assert work.g30[2] == pytest.approx(50.8)
    assert (work.g92[0], work.g92_on, work.active) == (pytest.approx(76.2), True, 2)
    assert (work.rotations[0], work.systems[1][3], work.systems[8][0]) == (30.0, 5.0, pytest.approx(152.4))
    assert work.variables == {31: 7.0}


def test_lines_that_are_no_variable_are_remarks():
    assert read_variables("# file\n\n5221 abc\n5222 2 remark\n", "v") == {5222: 2.0}


@pytest.mark.parametrize("active", ["0", "12", "-1"])
def test_a_system_that_is_none_counts_as_the_first(active):
    assert work_from(read_variables(f"5220 {active}", "v")).active == 1


@pytest.mark.parametrize(("text", "said"), [("9999 1", "no variable 9999"), ("0 1", "no variable 0"),
                                            ("5222 1\n5221 1", "behind 5222"), ("1 1\n1 2", "behind 1")])  # fmt: skip
def test_wrong_lines_are_named(text, said):
    with pytest.raises(ConfigError, match=r"work\.var, line") as caught:
        read_variables(text, "work.var")
    assert said in str(caught.value)


NUMBER = st.integers(-(10**9), 10**9).map(lambda n: n / 10**6)
POINT = st.tuples(*[NUMBER] * 9)


@given(systems=st.tuples(*[POINT] * 9), rotations=POINT, active=st.integers(1, 9), g92=POINT, g92_on=st.booleans(),
       g28=POINT, g30=POINT, variables=st.dictionaries(st.integers(31, 5000), NUMBER, max_size=5))  # fmt: skip
def test_what_is_written_is_read_again(**fields):
    work = WorkState(**fields)
    assert work_from(read_variables(write_variables(variables_of(work)), "v")) == work
