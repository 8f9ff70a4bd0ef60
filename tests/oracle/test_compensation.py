"""Cutter compensation against LinuxCNC's stand-alone interpreter: contours of lines and arcs, corners of every kind.

Not asked, because the reference alone is at fault there: an entry arc with a lathe tool's orientation (it cuts straight
to the arc's end, then a whole turn), a last move before a closing ``%`` (it is lost), arcs of several turns that start
at a trimmed corner, an entry arc whose end is a straight continuation (its centre lies at infinity).
"""

from __future__ import annotations

from math import cos, pi, radians, sin

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from trochia.program import WorkState
from trochia.program.tool_file import read_tools

pytestmark = pytest.mark.oracle

MANY = settings(max_examples=3 * settings().max_examples)

TOOLS = "T1 P1 D.1\nT2 P2 D.2 Q3\nT3 P3 D-.1\n"
WORK = WorkState(unit=25.4, tools=read_tools(TOOLS, "t", unit=25.4))
OTHERS = ["m8", "m0", "(hi)", "f50", "g4 p1", "m3", "s100", "(msg,yo)", "g80", "g97", "m9", "g1", "g1 a5", "g0 a7"]
STEP = st.integers(-12, 12)
HANDS = [
        "f100 | g41.1 d2 | g1 x5 | y10 | x20 | g40 | x30 y30", "f100 | g42.1 d2 | g1 x5 | y10 | x20 | g40 g0 x9",
        "f100 | g41.1 d2 | g2 x5 y5 i5 | g1 x10 | g40 | g2 x12 i1", "f100 | g41.1 d2 | g1 x5 | g18",
        "g41.1 d2 | g20", "g41.1 d2 | g21", "g41.1 d2 | g17", "g41.1 d2 | g28", "g41.1 d2 | g53 g0 x1",
        "g41.1 d2 | g55",
        "g41.1 d2 | g92 x1", "g41.1 d2 | m6 t1", "g41.1 d2 | g49", "g41.1 d2 | g28.1", "g41.1 d2 | g92.1",
        "g92 x1 | g41.1 d2 | g92.1 | g0 x5 | g40 | g92.2 | g92.3", "g41.1 d2 | g98", "g41.1 d2 | g61", "g41.1 d2 | g64",
        "g41.1 d2 | g0 x10 | y10 | x0 | y5", "g41.1 d-2 | g0 x10", "g41.1 d2 l3", "g41.1", "g18 g41.1 d2 l1.5",
        "g18 g41.1 d2 l3 | g0 x10 | z10 | x5", "g41.1 d0 | g0 x10 | y10", "g41.1 d2 | g0 z5 | x10", "g19 g42.1 d1",
        "f100|g41.1 d2 | g2 x1 r.5", "f100|g41.1 d2 | g3 x2 r1", "f100|g41.1 d2 | g3 i2", "f100|g41.1 d2 | g2 i2",
        "f100|g41.1 d2|g1 x10|g3 i1", "f100|g41.1 d2|g1 x10|g3 i1.0001 p2", "g41.1 d2 | g42.1 d2",
        "f100|g93 g41.1 d2|g1 x10 f1|g3 j5 p2 z3 f1|g1 z1 f1|x20 f1", "f100|g41.1 d2|g1 x10|g1 x1 y.1|y9|g40|g0 x0",
        "f100|g41.1 d0|g2 x3 i1.5|g40|g2 x5 i1", "f100|g41.1 d4|g1 x10|y.5|x0", "f100|g41.1 d2|g1 x10|x20 y-.499",
        "f100|g41.1 d2|g1 x10|x20 y-.501", "f100|g41.1 d2|g1 x10|x20 y.499", "f100|g41.1 d2|g1 x10|x20 y.501",
        "f100|g41.1 d2|g1 x10|m0|y10|m1|x0", "f100|g41.1 d2|g1 x10|t1|(msg,hi)|(hello)|g17|g20|g1 y.5|g21 x0",
        "f100|g41.1 d2|g1 x10|g2 x10 y10 j5|g1 y-10", "f100|g42.1 d2|g1 x10|g3 x10 y10 j5|g1 y9",
        "f100|g41.1 d2|g1 x10|g3 x10 y10 j5|g1 y9|m0", "f100|g41.1 d2|g1 x10|g3 x10 y10 j5|g1 y9|g40", "g41 d1.5",
        "g41 d9", "g41 d-1", "f100|g41 d1|g1 x10|y10", "f100|g42 d1|g1 x10|y10", "g41 d2", "f100|g18 g41 d2|g1 x10|z9",
        "f100|g41 d3|g1 x10", "f100|t1 m6|g41|g1 x10|y20", "f100|t1 m6|g41 d0|g1 x10", "f100|g20 g41 d1|g1 x10|y10",
        "f100|g18|g42.1 d2 l6|g1 x10 z2|x20|z9|g3 z12 x23 r3",
]  # fmt: skip


def _check(agree, lines: list[str]) -> None:
    agree("\n".join([*lines, "m2", ""]).encode("latin-1"), tools=TOOLS, work=WORK)


@pytest.mark.parametrize("text", HANDS)
def test_written_contours_agree(agree, text):
    _check(agree, [line.strip() for line in text.split("|")])


class _Contour:
    """Writes moves that lead on from one another; XY, or ZX as a lathe has it."""

    def __init__(self, *, lathe: bool, feed: str) -> None:
        self.first, self.second, self.i, self.j, self.up = (
            ("z", "x", "k", "i", "y") if lathe else ("x", "y", "i", "j", "z")
        )
        self.at = (0.0, 0.0)
        self.feed = feed

    def line(self, code: str, step: tuple[float, float]) -> str:
        end = self.at[0] + step[0], self.at[1] + step[1]
        return f"{code} {self._end(end)}{self.feed}"

    def arc(self, code: str, *, radius: float, heading: float, sweep: float, form: str, climb: int | None) -> str:
        """An arc about a centre in the direction ``heading`` [degree]."""
        centre = self.at[0] + radius * cos(radians(heading)), self.at[1] + radius * sin(radians(heading))
        angle = radians(heading) + pi + radians(sweep) * (-1 if code == "g2" else 1)
        end = centre[0] + radius * cos(angle), centre[1] + radius * sin(angle)
        to_centre = centre[0] - self.at[0], centre[1] - self.at[1]
        words = self._end(end)
        if climb is not None:
            words += f" {self.up}{climb}"
        if form == "r":
            return f"{code} {words} r{radius if sweep < 180 else -radius:.6f}{self.feed}"
        return f"{code} {words} {self.i}{to_centre[0]:.6f} {self.j}{to_centre[1]:.6f}{self.feed}"

    def _end(self, point: tuple[float, float]) -> str:
        texts = f"{point[0]:.6f}", f"{point[1]:.6f}"
        self.at = float(texts[0]), float(texts[1])
        return f"{self.first}{texts[0]} {self.second}{texts[1]}"


@st.composite
def contours(draw: st.DrawFn) -> list[str]:
    """Compensation on by a line, a contour, and off by a line."""
    lathe = draw(st.sampled_from([False, False, True]))
    inverse = draw(st.sampled_from([False, False, False, True]))
    tip = draw(st.sampled_from(["", "", " l3", " l2", " l6", " l8"])) if lathe else ""
    contour = _Contour(lathe=lathe, feed=" f2" if inverse else "")
    lines = [f"f100 {'g18' if lathe else 'g17'}", "g93" if inverse else "g94 f100"]
    lines.append(f"{draw(st.sampled_from(['g41.1', 'g42.1']))} d{draw(st.sampled_from([1, 2, 2, 4, 0.5]))}{tip}")
    lines.append(contour.line("g1", (draw(STEP.filter(lambda n: abs(n) > 3)), draw(STEP))))
    for _ in range(draw(st.integers(1, 7))):
        kind = draw(st.sampled_from(["line", "line", "line", "arc", "arc", "other"]))
        if kind == "line":
            lines.append(contour.line(draw(st.sampled_from(["g1", "g1", "g0"])), (draw(STEP), draw(STEP))))
        elif kind == "arc":
            lines.append(contour.arc(
                draw(st.sampled_from(["g2", "g3"])), radius=draw(st.sampled_from([1.5, 2.75, 5.0, 8.125])),
                heading=draw(st.integers(0, 23)) * 15.0, sweep=draw(st.sampled_from([30.0, 90.0, 135.0, 200.0, 270.0])),
                form=draw(st.sampled_from(["i", "i", "r"])), climb=draw(st.sampled_from([None, None, 0, 2])),
            ))  # fmt: skip
        elif not inverse:
            lines.append(draw(st.sampled_from(OTHERS)))
    return [*lines, "g40", draw(st.sampled_from(["g94 g0 x50 y50 z9", "g94 f9 g1 x3", "g94 f9 g2 x9 y1 i1", "m0"]))]


@MANY
@given(lines=contours())
def test_contours_agree(agree, lines):
    _check(agree, lines)
