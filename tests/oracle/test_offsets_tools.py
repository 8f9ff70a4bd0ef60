"""Offsets, tools, spindle modes and machine actions against LinuxCNC's stand-alone interpreter, by grammar.

Not asked, because the reference alone is at fault there: a tool offset in force over a tool change (it reads the point
anew, and forgets the offset) or over G20 and G21 (it does not convert it); the turn of the active system changed by
G10 under a shift (it turns the point, and not the shift); G43 behind M61 (its spindle stays empty).
"""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from trochia.program import WorkState
from trochia.program.parameter_file import read_variables, work_from
from trochia.program.tool_file import read_tools

pytestmark = pytest.mark.oracle

MANY = settings(max_examples=2 * settings().max_examples)

INCH = 25.4
TOOLS = """T1 P1 Z0.5 D0.25 ;first
T2 P2 X0.1 Y0.2 Z1.5 A1 B2 C3 U4 V5 W6 D3 I10 J20 Q2 ;second
T10 P7 Z-2 D1
"""
VARIABLES = "5161 1\n5162 2\n5181 -1\n5210 0\n5211 .5\n5220 1\n5221 1\n5222 .2\n5230 0\n5241 2\n5250 30\n"
WORK = work_from(
    read_variables(VARIABLES, "v"), WorkState(unit=INCH, tools=read_tools(TOOLS, "t", unit=INCH)), unit=INCH
)


def _of(*texts: str) -> st.SearchStrategy[str]:
    return st.sampled_from(texts)


def _line(*parts: st.SearchStrategy[str] | str) -> st.SearchStrategy[str]:
    return st.tuples(*(st.just(part) if isinstance(part, str) else part for part in parts)).map(" ".join)


NUMBER = _of("-3", "-1", "0", ".5", "1", "2", "4", "7.25")
AXES = st.lists(st.tuples(_of(*"xyzabc"), NUMBER), min_size=1, max_size=3, unique_by=lambda word: word[0]).map(
    lambda words: " ".join(letter + value for letter, value in words)
)
SYSTEM = st.integers(0, 9).map("p{}".format)
FIRST = _of("", "t1 m6", "t2 m6", "t10 m6", "g10 l2 p7 r30", "g10 l2 p6 x1 r-45", "g10 l2 p1 x1 r40")
ORIGINS = st.one_of(
    _line("g10 l2", SYSTEM, AXES), _line("g10 l20", SYSTEM, AXES), _of("g54", "g55", "g56", "g59", "g59.3"),
    _line(_of("g92", "g52"), AXES), _of("g92.1", "g92.2", "g92.3", "g28", "g30", "g28.1", "g30.1"),
)  # fmt: skip
TABLE = _line("g10", _of("l1", "l10", "l11"), _of("p1", "p2", "p10"), AXES, _of("", "r2", "i10 j20", "q3"))
LENGTHS = st.one_of(
    _of("g43", "g43 h1", "g43 h2", "g43 h10", "g43 h0", "g43.2 h1", "g43.2 h2", "g49"), _line("g43.1", AXES), TABLE
)
MOVES = _line(_of("g0", "g1 f100", "g53 g0", "g53 g1 f20"), AXES)
MODES = _of(
    "g90", "g91", "g17", "g18", "g61", "g61.1", "g64 p.1", "g64", "g64 p.1 q.2", "g94", "g95", "g93", "f50", "t1", "t2",
    "t10", "t0", "s100", "s200 m3", "m4", "m5", "m3 $0", "m5 $-1", "m7", "m8", "m9", "g96 s50", "g96 s50 d100", "g97",
    "m19 r20", "m19 r30 q2 p1", "s50", "m60", "m0", "m1",
)  # fmt: skip
MACHINE = _of(
    "m48", "m49", "m50 p0", "m51 p0", "m50", "m52", "m52 p0", "m53 p0", "m53", "m62 p1", "m63 p2", "m64 p3", "m65 p0",
    "m67 e1 q2.5", "m68 e0 q-1", "m66 p1 l3 q2", "m66 e0", "m70", "m71", "m72", "m73", "m70", "m72", "m70 m8 m3",
)  # fmt: skip
WRONG = _of(
    "m61", "m61 q77", "t9", "g43 h5", "g10 l3 p1", "g10 l2 p11 x1", "g10 l20 p1 x1 r1", "g10 l1 p3 z1", "g10 l1 p1",
    "m62", "m67 q1", "m66", "m66 p1 l2", "m19 r400", "m3 $1", "g96", "m19 r1 p3", "m100", "g52", "m48 m50",
    "g10 l1 p1 q11", "m19 r1 q0", "g43.2", "g43.2 x1", "g10 l2 p1 i1", "$1", "g1 f1 x1 $0", "l2", "d1", "e1",
    "m6 m61 q1", "g43 h1.5", "g43 h-1", "g10 l1.5 p1 x1", "m66 p1 e1", "m66 e1 l1 q1", "g10 l10 p1", "g43 g49",
    "m62 p1 m64 p2", "g10 l2 p1 x1 g0",
)  # fmt: skip
GOOD = st.one_of(ORIGINS, LENGTHS, MOVES, MODES, MACHINE)


@MANY
@given(first=FIRST, lines=st.lists(GOOD, min_size=3, max_size=14), last=st.one_of(st.just(""), WRONG))
def test_offsets_and_tools_agree(agree, first, lines, last):
    # The stand-alone reference does not turn the point where it starts, so the first line gives the point anew.
    text = "\n".join(["g53 g0 x0 y0 z0 a0 b0 c0 f100 s100", first, *lines, last, "m2", ""])
    agree(text.encode(), variables=VARIABLES, tools=TOOLS, work=WORK)


@MANY
@given(lines=st.lists(st.one_of(ORIGINS, MOVES, TABLE, _of("g20", "g21", "g90", "g91")), min_size=2, max_size=12))
def test_offsets_in_both_units_agree(agree, lines):
    text = "\n".join(["g53 g0 x0 y0 z0 a0 b0 c0 f100", *lines, "m2", ""])
    agree(text.encode(), variables=VARIABLES, tools=TOOLS, work=replace(WORK, active=1))
