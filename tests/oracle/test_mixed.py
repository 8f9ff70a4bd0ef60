"""Canned cycles, threads, splines, lathe modes and everything at once against LinuxCNC's interpreter, by grammar.

Not asked, because the reference alone is at fault there: what test_offsets_tools.py lists, a curve of G5.2 that no G5.3
ends (its points are those of the next curve, too), G74 and G84 outside the XY plane (it taps along Z all the same, to a
point whose coordinates are exchanged).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from trochia.program import WorkState
from trochia.program.parameter_file import read_variables, work_from
from trochia.program.tool_file import read_tools

if TYPE_CHECKING:
    from collections.abc import Sequence

pytestmark = pytest.mark.oracle

MANY = settings(max_examples=2 * settings().max_examples)
MORE = settings(max_examples=3 * settings().max_examples)

INCH = 25.4
TOOLS = "T1 P1 Z0.5 D0.25\nT2 P2 X0.1 Y0.2 Z1.5 A1 D.3 I10 J20 Q2\nT3 P3 Z-2 D1\n"
VARIABLES = "5161 1\n5162 2\n5181 -1\n5210 0\n5211 .5\n5220 1\n5221 1\n5222 .2\n5230 0\n5241 2\n5250 30\n"
WORK = work_from(
    read_variables(VARIABLES, "v"), WorkState(unit=INCH, tools=read_tools(TOOLS, "t", unit=INCH)), unit=INCH
)
START = "g53 g0 x0 y0 z0 a0 b0 c0 f100 s100"


def _of(*texts: str) -> st.SearchStrategy[str]:
    return st.sampled_from(texts)


def _line(*parts: st.SearchStrategy[str] | str) -> st.SearchStrategy[str]:
    return st.tuples(*(st.just(part) if isinstance(part, str) else part for part in parts)).map(" ".join)


def _maybe(part: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    return st.one_of(st.just(""), part)


def _words(letters: Sequence[str], most: int = 3) -> st.SearchStrategy[str]:
    return st.lists(
        st.tuples(st.sampled_from(letters), NUMBER), min_size=1, max_size=most, unique_by=lambda word: word[0]
    ).map(lambda words: " ".join(letter + value for letter, value in words))


NUMBER = _of("-7.5", "-4", "-1", "0", ".25", "1", "2", "3.125", "6", "[1+2]", "#1", "[#1*2]")
HEIGHT = _of("-3", "-1", "0", "1", "2", "4", "5.5")
AXES = _words("xyzabc")
SPINDLE = _of("m3", "m3", "m4", "m5", "s200 m3")

# --- canned cycles


@st.composite
def cycle(draw: st.DrawFn) -> str:
    """Return the lines, parted by ``|``, of a cycle and its holes in one of the planes, mostly without a mistake."""
    plane, across, normal = draw(_of("g17 xy z", "g17 xy z", "g18 zx y", "g19 yz x")).split()
    code = draw(_of("g73", "m4 g74", "g81", "g81", "g82", "g83", "m3 g84", "g85", "m3 g86", "g88", "g89", "g87"))
    if plane != "g17" and code.endswith(("g74", "g84")):
        code = "g85"
    first = [letter + draw(NUMBER) for letter in across]
    top = draw(st.integers(0, 3))
    depth = f"{normal}{top - draw(st.sampled_from([0, 1, 2.5, 4]))}"
    line = [plane, draw(_of("", "g98", "g99", "g90", "g91")), code, *first, depth, f"r{top}"]
    wanted = {"g73": "q", "g83": "q", "g82": "p", "g89": "p", "g86": "p", "g88": "p"}.get(code.split()[-1], "")
    for letter, values in (("p", _of(".5", "1", "0")), ("q", _of(".7", "1", "3")), ("l", _of("1", "2", "3")),
                           ("f", _of("50", "80"))):  # fmt: skip
        if letter in wanted or not draw(st.integers(0, 5)):
            line.append(letter + draw(values))
    if code == "g87":
        line += [letter + draw(NUMBER) for letter in "ijk"]
    wrong = draw(st.integers(0, 39))
    if wrong < len(line):
        del line[wrong]
    holes = [_hole(draw, across, normal) for _ in range(draw(st.integers(0, 3)))]
    return "|".join(["g80", " ".join(line), *holes])


def _hole(draw: st.DrawFn, across: str, normal: str) -> str:
    """Return one more hole of a cycle."""
    words = [letter + draw(NUMBER) for letter in across if draw(st.booleans())] or [across[0] + "1"]
    if not draw(st.integers(0, 4)):
        words.append(draw(_of(f"{normal}-2", "r2", "l2", "g98", "g99", "f60", f"{normal}1 r3")))
    return " ".join(words)


BETWEEN = _of("g80", "g98", "g99", "g90", "g91", "g17", "g18", "g19", "g0 x1 y2 z3", "g1 z7", "f60", "m3", "m5", "m4",
              "g61", "g64 p.1", "g55", "g54", "g92 x1", "g92.1", "g20", "g21", "#1=[#1+1]", "g94 f70", "g95 f.1",
              "g80 g0 x9")  # fmt: skip


@MANY
@given(first=SPINDLE, lines=st.lists(st.one_of(cycle(), cycle(), BETWEEN), min_size=2, max_size=10))
def test_canned_cycles_agree(agree, first, lines):
    text = "\n".join([START, "g0 z6 #1=1", first, *"|".join(lines).split("|"), "m2", ""])
    agree(text.encode(), work=WorkState())


# --- threads and lathe modes


@st.composite
def thread(draw: st.DrawFn) -> str:
    """Return a G76 with most of its words, some of them wrong."""
    words = {"p": _of(".5", "1", "2", "0"), "z": _of("-5", "-10", "3"), "i": _of("-1", "1", "-2.5"),
             "j": _of(".2", ".5", "1", "0"), "k": _of(".6", "1", "2", ".1"), "r": _of("1", "1.5", "2", ".5"),
             "q": _of("0", "29.5", "30", "-10"), "h": _of("0", "1", "2"), "e": _of("0", ".5", "2", "9"),
             "l": _of("0", "1", "2", "3", "4"), "$": _of("0"), "x": _of("1")}  # fmt: skip
    given_ = [letter for letter in "pzijk" if draw(st.integers(0, 15))]
    given_ += [letter for letter in "rqhel" if draw(st.booleans())]
    given_ += [letter for letter in "$x" if not draw(st.integers(0, 11))]
    return "g76 " + " ".join(letter + draw(words[letter]) for letter in draw(st.permutations(given_)))


LATHE = st.one_of(
    thread(), thread(),
    _line(_of("g33", "g33", "g33.1"), _maybe(_words("xz", 2)), _of("k1", "k.5", "k-1", "k0", ""),
          _maybe(_of("$0", "y1"))),
    _line(_of("g0", "g1"), _words("xzxzy", 2)),
    _of("g7", "g8", "g7 g0 x4", "g8 g1 x3", "g18", "g18 g91 g2 x2 z2 i1", "g91 g3 x2 k1 z2", "g2 x4 z-2 r9",
        "g96 s50 d900",
        "g97 s100", "g96 s20", "g95 f.2", "g94 f90", "g43 h1", "g43 h2", "g49", "g20", "g21", "g10 l2 p1 x1 z2",
        "g10 l20 p1 x3", "g92 x3", "g92.1", "g28 x2", "g53 g0 x1", "g90", "g91", "g80", "g0 z0", "t1 m6",
        "m3", "m4", "m5", "g10 l10 p1 x2 z1", "g10 l1 p2 x3 r.2", "g7 g92 x2", "@3 ^40"),
)  # fmt: skip


@MANY
@given(first=SPINDLE, mode=_of("g7", "g8", "g8"), lines=st.lists(LATHE, min_size=2, max_size=10))
def test_lathe_lines_agree(agree, first, mode, lines):
    units = ["g20", "g21"]
    if any(line.startswith(("g43", "t1", "g10 l1 ", "g10 l10")) for line in lines):
        lines = [line for line in lines if line not in units]  # the reference does not convert a tool's offset
    text = "\n".join([START, "#1=1", "g18", mode, first, *lines, "m2", ""])
    agree(text.encode(), variables=VARIABLES, tools=TOOLS, work=WORK)


# --- splines


@st.composite
def spline(draw: st.DrawFn) -> list[str]:
    """Return the lines of a curve."""
    kind = draw(_of("g5", "g5", "g5.1", "g5.2"))
    pair = st.tuples(NUMBER, NUMBER)
    if kind == "g5":
        x, y = draw(pair)
        i, j = draw(pair)
        p, q = draw(pair)
        start = draw(_of(f"i{i} j{j} ", f"i{i} j{j} ", ""))
        return [f"g5 x{x} y{y} {start}p{p} q{q}", *(["p1 q-2 x7"] if draw(st.booleans()) else [])]
    if kind == "g5.1":
        return [f"g5.1 x{draw(NUMBER)} {draw(_of('y2 ', ''))}i{draw(NUMBER)} {draw(_of('j1', 'j-2', ''))}"]
    points = draw(st.lists(st.tuples(*pair_of()), min_size=2, max_size=5))
    lines = [f"{'g5.2 ' if not index else ''}x{x} y{y} p{w}" for index, (x, y, w) in enumerate(points)]
    return [lines[0] + draw(_of("", " l3", " l4", " l2")), *lines[1:], "g5.3"]


def pair_of() -> tuple[st.SearchStrategy[str], ...]:
    """Return strategies of a control point: X, Y, weight."""
    return (NUMBER, NUMBER, _of("1", "1", "2", ".5"))


SPLINES = st.one_of(
    spline(), spline(),
    _of("g0 x1 y1", "g1 x3 f50", "g90", "g91", "g20", "g21", "g55", "g54", "g92 x1 y1", "g92.1", "g18", "g17", "g93",
        "g94 f60", "g0 z1", "#1=[#1+1]").map(lambda line: [line]),
)  # fmt: skip


@MANY
@given(parts=st.lists(SPLINES, min_size=1, max_size=6))
def test_splines_agree(agree, parts):
    lines = [line for part in parts for line in part]
    agree("\n".join([START, "#1=1", *lines, "m2", ""]).encode(), work=WorkState())


# --- everything

OWORDS = _of(
    "o1 call [1] [2]", "o2 repeat [2]|g91 g0 x1|o2 endrepeat|g90", "o3 if [#1 gt 1]|g0 y#1|o3 else|g0 y2|o3 endif",
    "#<a>=0|o4 while [#<a> lt 3]|#<a>=[#<a>+1]|g1 x#<a> f[50+#<a>]|o4 endwhile", "#1=[#1*1.5]",
    "(debug,#1 #<_x> #5420)",
    "o1 call [#<_x>] [3]", "(print,#1)", "(msg,hello)", "m98 p50 l2", "#<_glob>=[#1+1] x#1", "g0 x#<_z> y[abs[#1]]",
)  # fmt: skip
ORIGINS = _of(
    "g54", "g55", "g56", "g59.3", "g10 l2 p1 x1 y2", "g10 l2 p2 z1 r15", "g10 l20 p0 x3", "g10 l2 p3 x1 r-45",
    "g92 x1 y1", "g92.1", "g92.2", "g92.3", "g28", "g30 z1", "g28.1", "g53 g0 x1", "g53 g1 z2 f70",
    "g52 x1 y-1", "g52 x0 y0",
)  # fmt: skip
LENGTHS = _of("g43 h1", "g43.1 z2 x1", "g43.2 h2", "g49", "g43 h2", "g43 h0", "g10 l1 p1 z2")
UNITS = _of("g20", "g21")
MODES = _of("g90", "g91", "g17", "g18", "g19", "g61", "g64 p.1", "g64", "g94 f80", "g95 f.1", "g98", "g99", "g80",
            "m3", "m5", "m8", "m9", "s50", "g4 p1", "g40", "m0", "m70", "m72", "m50 p0", "m62 p1", "m68 e1 q2", "g90.1",
            "g91.1")  # fmt: skip
MOVES = st.one_of(
    _line(_of("g0", "g1", "g1 f90", ""), AXES),
    _of("g91 g2 x2 i1 g90", "g90 g91.1 g3 i1 j1", "g91 g2 x3 y1 r4", "g17 g2 i2 p2 z1"),
    _line(_of("g0", "g1 f9"), _of("@2 ^30", "@3", "^45")), cycle(),
)  # fmt: skip
CONTOUR = _of(
    "g40|g17 g90 g94 f50 g80|g0 x-5 y-5|g41.1 d1 g1 x0 y0|y10|x10|g2 x15 y5 r5|g1 y0|x0|g40 g0 x-5 y-5",
    "g40|g17 g90 g94 f50 g80|g42.1 d.5 g1 x2 y2|x9|y9 z1|m8|g3 x4 y4 r5|g40 g1 x-3 y-3",
    "g40|g18 g90 g94 f50 g80|g41.1 d1 l2 g1 x4 z4|x9|z-3|x20 z-5|g40 g0 x30",
    "g40|g17 g80 g94 f9|g41 d1 g1 x20|y20 x25|x40|g40 g0 y50",
)  # fmt: skip
SUBS = ["o1 sub", "g0 x#1 y#2", "o9 if [#1 gt 90]", "o1 return [#2]", "o9 endif", "o1 endsub [#1]"]


def _everything(other: st.SearchStrategy[str]) -> st.SearchStrategy[list[str]]:
    parts = st.one_of(MOVES, MOVES, MODES, ORIGINS, OWORDS, other, spline().map("|".join), CONTOUR)
    return st.lists(parts, min_size=3, max_size=14).map(lambda found: "|".join(found).split("|"))


@MORE
@given(lines=st.one_of(_everything(UNITS), _everything(LENGTHS)))
def test_everything_together_agrees(agree, lines):
    text = "\n".join([START, "#1=1", *SUBS, "t1 m6" if "g20" not in lines else "", *lines, "m2", "o50", "g91 g0 z.5",
                      "m99", ""])  # fmt: skip
    agree(text.encode(), variables=VARIABLES, tools=TOOLS, work=WORK)
