"""Step times against closed forms: what can be written down is what must come out, to half a tick."""

from __future__ import annotations

import math

import numpy as np
import pytest

from trochia.kernels.layout import PHASE, SEGMENT
from trochia.kernels.steps import JointSteps

CLOCK = 1e6
HALF = 0.5 + 1e-6
LINE, ARC, CUBIC = range(3)


def phases_of(*rows: tuple[float, float, float, float, float, float], flags: int = 0) -> np.ndarray:
    """Return PHASE rows of (t, duration, s, v, a, j)."""
    phases = np.zeros(len(rows), PHASE)
    for number, row in enumerate(rows):
        for name, value in zip(("t", "duration", "s", "v", "a", "j"), row, strict=True):
            phases[name][number] = value
    phases["flags"] = flags
    return phases


def segment_of(kind: int, length: float = 1000.0) -> np.ndarray:
    segments = np.zeros(1, SEGMENT)
    segments["kind"], segments["length"], segments["second"] = kind, length, 1
    return segments


def steps_of(
    kind: int, pool: list[float], row: list[float], phases: np.ndarray, count: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    maker = JointSteps(segment_of(kind), np.array(pool, dtype=float), np.array(row, dtype=float), CLOCK, count)
    maker.load(phases)
    return maker.until()


X_LINE = [0.0, 0.0, 1.0, 0.0]


def test_constant_speed_steps_at_even_times() -> None:
    ticks, directions = steps_of(LINE, X_LINE, [10, 0], phases_of((2.0, 1.0, 0, 7.0, 0, 0)))
    assert ticks.tolist() == [round((2 + k / 70) * CLOCK) for k in range(1, 71)]
    assert (directions == 1).all()


@pytest.mark.parametrize("acceleration", [1e-3, 1.0, 1e5])
def test_from_rest_the_k_th_step_is_at_the_root_of_2k_over_a(acceleration: float) -> None:
    duration = math.sqrt(2 * 500 / acceleration)
    ticks, _ = steps_of(LINE, X_LINE, [1, 0], phases_of((0, duration, 0, 0, acceleration, 0)))
    exact = [CLOCK * math.sqrt(2 * k / acceleration) for k in range(1, 501)]
    assert len(ticks) == 500
    assert np.abs(ticks - exact).max() <= HALF


def test_to_rest_the_last_step_is_made_at_the_end() -> None:
    """v = 100, a = -50 stops after 2 s on step 100 exactly: a double root, found in spite of rounding."""
    ticks, _ = steps_of(LINE, X_LINE, [1, 0], phases_of((0, 2.0, 0, 100.0, -50.0, 0)))
    assert len(ticks) == 100
    assert abs(ticks[-1] - 2 * CLOCK) <= 1
    exact = [CLOCK * (2 - math.sqrt(4 - 4 * k / 100)) for k in range(1, 100)]
    assert np.abs(ticks[:-1] - exact).max() <= HALF


def test_a_negative_row_steps_backwards_at_the_same_times() -> None:
    phases = phases_of((0, 1.0, 0, 3.0, 8.0, 0), (1.0, 1.0, 7.0, 11.0, -8.0, 0))
    there, back = (steps_of(LINE, X_LINE, [row, 0], phases) for row in (33, -33))
    assert there[0].tolist() == back[0].tolist()
    assert (there[1] == -back[1]).all()


def test_jerk_alone_steps_at_cube_roots() -> None:
    ticks, _ = steps_of(LINE, X_LINE, [1, 0], phases_of((0, 2.0, 0, 0, 0, 6e3)))
    exact = [CLOCK * (k / 1e3) ** (1 / 3) for k in range(1, 8001)]
    assert len(ticks) == 8000
    assert np.abs(ticks - exact).max() <= HALF


def test_a_circle_steps_at_arc_cosines_and_turns_back() -> None:
    """q = 1000 cos(t): down to -1000 and back in a turn, each step at t = acos(k / 1000)."""
    pool = [0, 0, 100.0, 0, 0.01, 0, 0, 0, 0, 0, 0]
    ticks, directions = steps_of(ARC, pool, [10, 0], phases_of((0, 2 * math.pi, 0, 100.0, 0, 0)), 1000)
    down = [math.acos(k / 1000) for k in range(999, -1001, -1)]
    back = [2 * math.pi - math.acos(k / 1000) for k in range(-999, 1001)]
    assert directions.tolist() == [-1] * 2000 + [1] * 2000
    assert np.abs(ticks[:2000] - np.array(down) * CLOCK)[:-1].max() <= HALF
    assert np.abs(ticks[2000:] - np.array(back) * CLOCK)[:-1].max() <= HALF
    # at the tips position is flat: a millionth of a step is 45 microseconds
    assert abs(math.cos(ticks[1999] / CLOCK) * 1000 + 1000) < 2e-6
    assert abs(math.cos(ticks[-1] / CLOCK) * 1000 - 1000) < 2e-6


def test_a_cubic_turns_twice_and_keeps_its_count() -> None:
    """q = 100 (s³ - 3 s² + 2 s): its extremes ±38.49 cost no step and gain none."""
    ticks, directions = steps_of(CUBIC, [0, 0, 2, 0, -3, 0, 1, 0], [100, 0], phases_of((0, 2.5, 0, 1.0, 0, 0)))
    q = [100 * (s**3 - 3 * s**2 + 2 * s) for s in ticks / CLOCK]
    count = np.cumsum(directions)
    assert np.abs(q - count).max() < 1e-3
    assert count.max() == 187
    assert count[:38].tolist() == list(range(1, 39))
    assert count[38 : 38 + 76].tolist() == list(range(37, -39, -1))
    assert len(ticks) == 38 + 76 + 38 + 187


def test_a_joint_that_turns_within_a_step_stays() -> None:
    """0.9 of a step out and back, over and over."""
    pool = [0, 0, 1.0, 0, 1.0, 0, 0, 0, 0, 0, 0]
    ticks, _ = steps_of(ARC, pool, [0.45, 0], phases_of((0, 100.0, 0, 1.0, 0, 0)))
    assert ticks.size == 0


def test_rests_and_joints_without_motion_make_no_step() -> None:
    rest = phases_of((0, 5.0, 0.5, 0, 0, 0), flags=1)
    assert steps_of(LINE, X_LINE, [1000, 0], rest, 500)[0].size == 0
    moving = phases_of((0, 5.0, 0, 1.0, 1.0, 1.0))
    for kind, pool in ((LINE, X_LINE), (ARC, [0, 0, 5, 0, 0.2, 0, 0, 0, 0, 0, 0]), (CUBIC, [0, 0, 1, 0, 1, 0, 1, 0])):
        assert steps_of(kind, pool, [0, 0], moving)[0].size == 0


def test_a_helix_moves_its_third_axis_evenly() -> None:
    segments = segment_of(ARC)
    pool = np.array([0, 0, 10, 0, 0.1, 0, 0, 0, 5.0, 0, 0, 0.25, 0])
    maker = JointSteps(segments, pool, np.array([0, 0, 8.0]), CLOCK, 40)
    maker.load(phases_of((0, 10.0, 0, 4.0, 0, 0)))
    ticks, _ = maker.until()
    assert ticks.tolist() == [round(CLOCK * k / 8) for k in range(1, 81)]
    assert maker.count == 120


def test_no_step_is_lost_where_a_buffer_ends() -> None:
    """More steps than one call of the core takes, with turning points inside."""
    pool = [0, 0, 100.0, 0, 0.01, 0, 0, 0, 0, 0, 0]
    ticks, directions = steps_of(ARC, pool, [250, 0], phases_of((0, 2 * math.pi, 0, 100.0, 0, 0)), 25_000)
    assert len(ticks) == 100_000
    assert directions.sum() == 0
    assert (np.diff(ticks) > 0).all()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"clock": 0.0}, "clock"),
        ({"row": [math.nan, 0.0]}, "finite"),
        ({"pool": [0.0, 0.0, 1.0]}, "pool"),
        ({"segment": 1}, "not there"),
        ({"t": 1e12}, "longer"),
        ({"t": math.nan}, "longer"),
    ],
)
def test_what_does_not_fit_is_refused(change: dict[str, object], message: str) -> None:
    given = {"clock": CLOCK, "row": [1.0, 0.0], "pool": X_LINE, "segment": 0, "t": 0.0} | change
    phases = phases_of((0, 1.0, 0, 1.0, 0, 0))
    phases["segment"], phases["t"] = given["segment"], given["t"]
    with pytest.raises(ValueError, match=message):
        JointSteps(
            segment_of(LINE), np.array(given["pool"]), np.array(given["row"]), float(str(given["clock"])), 0
        ).load(phases)
