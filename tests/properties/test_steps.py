"""Laws of step times: every step falls on the tick nearest to the root of position = k, none is lost, none too many.

The other method is independent of the kernel's: velocity's sign changes from a dense sample, refined by Brent's method,
cut the motion into monotone pieces; in each the boundaries passed are counted and their times found by Brent's method.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from hypothesis import assume, example, given
from hypothesis import strategies as st
from scipy.optimize import brentq

from trochia.kernels.layout import PHASE, SEGMENT
from trochia.kernels.steps import JointSteps

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

CLOCK = 1e6
SLACK = 1e-6  # steps, as the kernel states it
LINE, ARC, CUBIC = 0, 1, 2


@dataclass(frozen=True)
class Case:
    """One segment in two axes, its coefficients, the joint's row, and phases over it."""

    kind: int
    pool: tuple[float, ...]
    row: tuple[float, float]
    phases: tuple[tuple[float, float, float, float, float, float], ...]  # t duration s v a j

    def arrays(self) -> tuple[NDArray[np.void], NDArray[np.void], NDArray[np.float64]]:
        phases = np.zeros(len(self.phases), PHASE)
        for field, column in zip(("t", "duration", "s", "v", "a", "j"), zip(*self.phases, strict=True), strict=True):
            phases[field] = column
        segments = np.zeros(1, SEGMENT)
        _, duration, s, v, a, j = self.phases[-1]
        segments["length"] = s + duration * (v + duration * (a / 2 + duration * j / 6))
        segments["kind"] = self.kind
        segments["second"] = 1
        return phases, segments, np.array(self.pool)

    def along(self, index: int, tau: float) -> tuple[float, float]:
        """Return s and ds/dt in a phase."""
        _, _, s, v, a, j = self.phases[index]
        return s + tau * (v + tau * (a / 2 + tau * j / 6)), v + tau * (a + tau * j / 2)

    def joint(self, s: float) -> tuple[float, float]:
        """Return q and dq/ds."""
        x, y = self.row
        p = self.pool
        if self.kind == ARC:
            phi, dphi = p[3] + s * (p[4] + s * p[10]), p[4] + 2 * s * p[10]
            r = p[2] + p[5] * s
            along, across = x * math.cos(phi) + y * math.sin(phi), y * math.cos(phi) - x * math.sin(phi)
            return x * p[0] + y * p[1] + r * along, p[5] * along + r * dphi * across
        c = [x * p[2 * i] + y * p[2 * i + 1] for i in range(len(p) // 2)] + [0.0, 0.0]
        return c[0] + s * (c[1] + s * (c[2] + s * c[3])), c[1] + s * (2 * c[2] + s * 3 * c[3])


def monotone_pieces(case: Case, index: int) -> list[float]:
    """Return the times in a phase at which the joint's velocity changes its sign, with both ends."""
    duration = case.phases[index][1]

    def velocity(tau: float) -> float:
        s, v = case.along(index, tau)
        return case.joint(s)[1] * v

    times = np.linspace(0, duration, 1001)
    values = np.array([velocity(tau) for tau in times])
    turns = np.flatnonzero(values[:-1] * values[1:] < 0)
    return [0.0, *(brentq(velocity, times[i], times[i + 1], xtol=1e-15) for i in turns), duration]


def reference(case: Case) -> tuple[list[Callable[[float], float]], list[tuple[int, int, int, float, float]], int, int]:
    """Return q of each phase's time, and (phase, k, direction, from, to) of every step; first and last count."""
    rows: list[tuple[int, int, int, float, float]] = []
    positions = [lambda tau, i=i: case.joint(case.along(i, tau)[0])[0] for i in range(len(case.phases))]
    first = count = math.floor(positions[0](0.0) + 0.5)
    for index, q in enumerate(positions):
        pieces = monotone_pieces(case, index)
        for start, end in pairwise(pieces):
            # a tip so near a boundary that rounding decides is no test
            assume(abs(abs(q(end) - round(q(end))) - SLACK) > 1e-8)
            direction = 1 if q(end) >= q(start) else -1
            while direction * (q(end) - count) >= 1 - SLACK:
                count += direction
                rows.append((index, count, direction, start, end))
    return positions, rows, first, count


@st.composite
def cases(draw: st.DrawFn) -> Case:
    real = st.floats(-1, 1, allow_subnormal=False)
    kind = draw(st.sampled_from([LINE, ARC, CUBIC]))
    t, s, v = draw(st.sampled_from([0.0, 1.25, 3600.0])), 0.0, draw(st.sampled_from([0.0, 0.5, 20.0]))
    phases: list[tuple[float, float, float, float, float, float]] = []
    for _ in range(draw(st.integers(1, 3))):
        goal, half = draw(st.sampled_from([0.0, 1.0, 7.5, 30.0])), draw(st.sampled_from([0.01, 0.05, 0.3]))
        if draw(st.booleans()):  # constant acceleration, or jerk up and down again
            stretches = [((goal - v) / (2 * half), 0.0, 2 * half)]
        else:
            jerk = (goal - v) / half**2
            stretches = [(0.0, jerk, half), (jerk * half, -jerk, half)]
        for a, j, duration in stretches:
            phases.append((t, duration, s, v, a, j))
            t, s = t + duration, s + duration * (v + duration * (a / 2 + duration * j / 6))
            v = max(0.0, v + duration * (a + duration * j / 2))
        v = goal
    if kind == LINE:
        angle = draw(st.floats(0, 6.3))
        pool = (10 * draw(real), 0.0, math.cos(angle), math.sin(angle))
    elif kind == ARC:
        radius = draw(st.floats(0.5, 20))
        spiral = draw(st.sampled_from([0.0, 0.1]))
        rate = draw(st.sampled_from([1.0, -1.0])) / radius
        pool = (draw(real), 0.0, radius, 6 * draw(real), rate, spiral * draw(real), *(0.0,) * 4, spiral * rate * 0.01)
    else:
        pool = tuple(draw(real) * scale for scale in (10, 10, 1, 1, 0.2, 0.2, 0.02, 0.02))
    row = (draw(st.floats(1, 80)) * draw(st.sampled_from([1.0, -1.0])), draw(st.sampled_from([0.0, 33.3])))
    return Case(kind, pool, row, tuple(phases))


@given(cases())
# the corners: from rest by jerk alone, a whole circle from a tip, a cubic that turns twice
@example(Case(LINE, (0.0, 0.0, 1.0, 0.0), (80.0, 0.0), ((0.0, 0.5, 0.0, 0.0, 0.0, 40.0),)))
@example(Case(ARC, (0.0, 0.0, 10.0, 0.0, 0.1, *(0.0,) * 6), (8.0, 0.0), ((0.0, 2 * math.pi, 0.0, 10.0, 0.0, 0.0),)))
@example(Case(CUBIC, (0.0, 0.0, 1.0, 0.0, -1.5, 0.0, 0.5, 0.0), (40.0, 0.0), ((0.0, 2.2, 0.0, 1.0, 0.0, 0.0),)))
def test_every_step_is_the_root_of_position_equals_k(case: Case) -> None:
    positions, rows, first, last = reference(case)
    assume(len(rows) < 20_000)
    phases, segments, pool = case.arrays()
    maker = JointSteps(segments, pool, np.array(case.row), CLOCK, first)
    maker.load(phases)
    ticks, directions = maker.until()
    assert maker.count == last
    assert directions.tolist() == [row[2] for row in rows]
    assert (np.diff(ticks) > 0).all()
    for at in {
        *range(min(4, len(rows))),
        *range(0, len(rows), max(1, len(rows) // 40)),
        *range(max(0, len(rows) - 4), len(rows)),
    }:
        index, k, _, start, end = rows[at]
        q, tau = positions[index], int(ticks[at]) / CLOCK - case.phases[index][0]
        low, high = q(start) - k, q(end) - k
        root = start if low * high > 0 and abs(low) < abs(high) else end
        root = brentq(lambda t, q=q, k=k: q(t) - k, start, end, xtol=1e-15) if low * high < 0 else root
        # where the joint all but stands, time says nothing and position everything
        assert abs(tau - root) <= 1 / CLOCK or abs(q(tau) - k) <= 2 * SLACK


@given(cases(), st.lists(st.floats(0, 1), max_size=5), st.integers(0, 4))
def test_no_cut_changes_a_step(case: Case, cuts: list[float], split: int) -> None:
    phases, segments, pool = case.arrays()
    first = round(case.joint(0.0)[0])
    whole = JointSteps(segments, pool, np.array(case.row), CLOCK, first)
    whole.load(phases)
    ticks, directions = whole.until()
    cut = JointSteps(segments, pool, np.array(case.row), CLOCK, first)
    parts: list[tuple[NDArray[np.int64], NDArray[np.int8]]] = []
    begin, end = phases["t"][0] * CLOCK, (phases["t"][-1] + phases["duration"][-1]) * CLOCK
    for block in (phases[:split], phases[split:]):
        cut.load(block)
        parts += [cut.until(begin + share * (end - begin)) for share in sorted(cuts)]
        parts.append(cut.until())
    assert cut.count == whole.count
    assert np.concatenate([part[1] for part in parts]).tolist() == directions.tolist()
    # cutting shifts the polynomials' middles: a tick may round the other way where a root lies half-way
    assert np.abs(np.concatenate([part[0] for part in parts]) - ticks).max(initial=0) <= 1
