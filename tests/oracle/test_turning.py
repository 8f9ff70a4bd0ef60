"""Lathe cycles against LinuxCNC's stand-alone interpreter: profiles by grammar, the cycles along them."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from trochia.program import WorkState

pytestmark = pytest.mark.oracle

HERE = Path(__file__).parent
OURS = runpy.run_path(str(HERE / "conftest.py"))["ours"]
HAS_VALLEY = runpy.run_path(str(HERE.parent / "soak" / "turning_laws.py"))["has_valley"]

MANY = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
STEP = 0.25  # of coordinates: the profile's ends never lie on a pass, whose depths are odd


def _steps(low: float, high: float) -> st.SearchStrategy[float]:
    return st.integers(round(low / STEP), round(high / STEP)).map(lambda count: count * STEP)


@st.composite
def profile(draw: st.DrawFn) -> list[str]:
    """A profile whose Z falls: slopes, steps, arcs."""
    x, z = draw(_steps(4, 20)), 0.0
    lines = [f"g0 x{x:g} z{z:g}"]
    before = ""
    for _ in range(draw(st.integers(2, 7))):
        kind = draw(st.sampled_from(["slope", "slope", "along", "across", "arc"]))
        kind = "slope" if kind == before else kind
        before = kind
        across, down = draw(_steps(-5, 7)), draw(_steps(0.5, 6))
        words = f"x{x + across:g}" if kind != "along" else ""
        words += f" z{z - down:g}" if kind != "across" else ""
        if kind == "across" and across == 0.0:
            continue
        radius = round((across * across + down * down) ** 0.5 * draw(st.integers(60, 200)) / 100 + 0.05, 2)
        code = draw(st.sampled_from(["g2", "g3"])) if kind == "arc" else draw(st.sampled_from(["g1", "g0", "g1"]))
        lines.append(f"{code} {words} {f'r{radius}' if kind == 'arc' else ''}")
        x, z = x + (across if kind != "along" else 0.0), z - (down if kind != "across" else 0.0)
    return lines


CYCLE = st.sampled_from(["g71", "g71", "g71.1", "g71.2", "g72", "g72.1", "g72.2"])
# never at the profile's beginning, from where the reference makes its first cut a rapid
START = st.tuples(_steps(-5, 40), st.one_of(_steps(0, 6), _steps(-40, 6))).map(
    lambda point: f"x{point[0] + 0.1:g} z{point[1]:g}"
)
DEEP = st.sampled_from(["i.51", "i.87", "i1.37", "i2.83", ""])
BACK = st.sampled_from(["", "r.2", "r0", "r1.3"])


def _program(lines: list[str], cycle: str, mode: str = "g8") -> bytes:
    head = ["g21 g18 g90 f100", mode, "o100 sub", *lines, "o100 endsub", "g0 x23 z7"]
    return "\n".join([*head, cycle, "x3", "m2", ""]).encode("latin-1")


@MANY
@given(lines=profile(), words=st.tuples(CYCLE, START, DEEP, BACK).map("{0[0]} q100 {0[1]} {0[2]} {0[3]}".format),
       mode=st.sampled_from(["g8", "g7"]))  # fmt: skip
def test_roughing_agrees(agree_or_hang, lines, words, mode):
    # The reference does not rough what falls again straight behind an arc that falls and rises.
    profile = OURS(_program(lines, "g70 q100 x50.1 z9", mode), fast=True, work=WorkState())
    assume(profile.rejected is not None or not HAS_VALLEY(profile.lines))
    agree_or_hang(_program(lines, words, mode))


@MANY
@given(lines=profile(), start=START, passes=st.integers(1, 4))
def test_finishing_agrees(agree_or_hang, lines, start, passes):
    agree_or_hang(_program(lines, f"g70 q100 {start} p{passes}"))


BENDS = st.lists(st.sampled_from(["x16 z-4", "x16 z-8", "x12 z-13", "x18 z-14.5", "x18 z-21", "x11 z-25"]),
                 min_size=2, max_size=6, unique=True)  # fmt: skip


@MANY
@given(points=BENDS, cycle=st.sampled_from(["g71 i.87", "g71.2 i1.37", "g70 e.2 p2"]), start=START,
       left=st.sampled_from(["d.3", "d.7", "d-.4"]))  # fmt: skip
def test_what_is_left_agrees(agree_or_hang, points, cycle, start, left):
    ordered = sorted(points, key=lambda point: -float(point.partition("z")[2]))
    lines = ["g0 x10.5 z0", *(f"g1 {point}" for point in ordered)]
    agree_or_hang(_program(lines, f"{cycle} q100 {start} {left}"))


ROUNDED = [
    "g0 x10 z0 | g1 z-8 a1 | g1 x18 z-12 c.7 | g1 z-20 a2 | g1 x30",
    "g0 x30 z0 | g1 x20 a1.5 | g1 z-8 c2 | g1 x10 z-20 | g1 x8",
    "g0 x10 z0 | g1 z-8 | g3 x18 z-16 r16 | g1 z-20 c.5 | g1 x20 z-22",
    "g0 x10 z0 | g1 u3 w-8 | w-3 | u4 | g2 x20 z-20 r40",
    "x10 z0 | f7 z-6 | g20 m8 x12 | (msg, no) | g1 z-9 y3 b4 | g0 x15 z-12",
]


@pytest.mark.parametrize("lines", ROUNDED)
@pytest.mark.parametrize("cycle", ["g71 i1.3", "g70 p2 d1", "g72 i1.7", "g71 i.9 d.4"])
@pytest.mark.parametrize("mode", ["g7", "g8"])
def test_words_of_a_profile_agree(agree_or_hang, lines, cycle, mode):
    agree_or_hang(_program(lines.split(" | "), f"{cycle} q100 x40 z3", mode))
