"""The corner model: planned times against the optimum by the curvature of the programmed chain, and older rules.

One limit on the whole acceleration vector (``[path]``), one on speed; start and end at rest; P = 0.01 mm.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from shapes import chain, curve, hatch, mixed, zigzag
from trochia.machine.axes import PathLimits
from trochia.machine.load import load
from trochia.planner import plan
from trochia.toolpath import build

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.machine import Machine

    Array = NDArray[np.float64]

TOLERANCE = 0.01
JERK = 25.0  #: times the acceleration, a second: what the reference mill's axes have


@dataclass(frozen=True, slots=True, kw_only=True)
class Chain:
    """A chain of chords: lengths (k,) [mm], turning angles between them (k - 1,) [rad]."""

    length: Array
    turn: Array


def chain_of(points: Array) -> Chain:
    steps = np.diff(points, axis=0)
    heading = np.arctan2(steps[:, 1], steps[:, 0])
    turn = np.abs((np.diff(heading) + math.pi) % (2.0 * math.pi) - math.pi)
    return Chain(length=np.hypot(steps[:, 0], steps[:, 1]), turn=turn)


def optimum(chord: Chain, speed: float, acceleration: float) -> float:
    """Return the least time [s] of a chain each of whose corners is spread over what P and half its chords allow.

    On a stretch of constant curvature k, w = v² obeys dw/ds = 2 √(A² - k² w²), so that k w / A = sin(2 k s + c): the
    passes back and forth need no steps.  Speed is counted over the corner's own length, which is a little less than
    that of its legs.
    """
    jump = 2.0 * np.sin(0.5 * chord.turn)
    half = 0.5 * chord.length
    leg = np.minimum(4.0 * TOLERANCE / np.maximum(jump, 1e-12), np.minimum(half[1:], half[:-1]))
    leg[jump < 1e-9] = 0.0
    lengths = np.zeros(2 * len(chord.length) - 1)
    bends = np.zeros_like(lengths)
    lengths[::2] = chord.length
    lengths[:-2:2] -= leg
    lengths[2::2] -= leg
    lengths[1::2], bends[1::2] = 2.0 * leg, jump / np.maximum(2.0 * leg, 1e-12)
    keep = lengths > 1e-12
    return _time(lengths[keep].tolist(), bends[keep].tolist(), speed * speed, acceleration)


def _grow(w: float, bend: float, way: float, limit: float) -> float:
    """Return the greatest w after a way of even bend."""
    if bend * limit * way < 1e-9:
        return w + 2.0 * limit * way if bend * w < 0.99 * limit else w
    angle = math.asin(min(bend * w / limit, 1.0)) + 2.0 * bend * way
    return limit / bend * math.sin(min(angle, 0.5 * math.pi))


def _time(lengths: list[float], bends: list[float], most: float, limit: float) -> float:
    """Return the time over stretches of even bend, each passed as fast as its ends allow."""
    count = len(lengths)
    ceiling = [most if bend <= 0.0 else min(most, limit / bend) for bend in bends]
    ends = [0.0] * (count + 1)
    for k in range(count - 1, 0, -1):
        ends[k] = min(_grow(ends[k + 1], bends[k], lengths[k], limit), ceiling[k], ceiling[k - 1])
    total = 0.0
    for k in range(count):
        ends[k + 1] = min(_grow(ends[k], bends[k], lengths[k], limit), ends[k + 1])
        total += _pass((ends[k], ends[k + 1]), bends[k], lengths[k], ceiling[k], limit)
    return total


def _pass(ends: tuple[float, float], bend: float, way: float, ceiling: float, limit: float) -> float:
    """Return the time of one stretch: up, even, down; by parts where it bends."""
    w0, w1 = ends
    parts = 8
    if bend <= 0.0:
        top = min(ceiling, 0.5 * (w0 + w1) + limit * way)
        v0, v1, v = math.sqrt(w0), math.sqrt(w1), math.sqrt(top)
        even = max(way - (2.0 * top - w0 - w1) / (2.0 * limit), 0.0)
        return (2.0 * v - v0 - v1) / limit + (even / v if v > 0.0 else 0.0)
    if min(w0, w1) >= ceiling * (1.0 - 1e-12):
        return way / math.sqrt(ceiling)
    speeds = [
        math.sqrt(
            min(_grow(w0, bend, way * k / parts, limit), _grow(w1, bend, way * (parts - k) / parts, limit), ceiling)
        )
        for k in range(parts + 1)
    ]
    return sum(2.0 * way / parts / (a + b) for a, b in pairwise(speeds))


def junction_time(chord: Chain, speed: float, acceleration: float, *, centripetal: bool) -> float:
    """Return the time by the usual rule of junction deviation, with or without a bound on v² k beside it."""
    sine = np.cos(0.5 * chord.turn)  # of half the angle between the chords
    with np.errstate(divide="ignore"):
        square = acceleration * TOLERANCE * sine / np.maximum(1.0 - sine, 1e-300)
    if centripetal:  # half a chord against the tangent of half the turn
        near = 0.5 * np.minimum(chord.length[1:], chord.length[:-1])
        square = np.minimum(square, acceleration * near / np.maximum(np.tan(0.5 * chord.turn), 1e-12))
    ends = [0.0, *np.minimum(square, speed * speed).tolist(), 0.0]
    lengths = chord.length.tolist()
    for k in range(len(lengths) - 1, -1, -1):
        ends[k] = min(ends[k], ends[k + 1] + 2.0 * acceleration * lengths[k])
    total = 0.0
    for k, way in enumerate(lengths):
        ends[k + 1] = min(ends[k + 1], ends[k] + 2.0 * acceleration * way)
        total += _pass((ends[k], ends[k + 1]), 0.0, way, speed * speed, acceleration)
    return total


def worst_bend(chord: Chain, speed: float, acceleration: float) -> float:
    """Return the greatest v² k that junction deviation alone asks for at joints of less than 30 degrees [mm/s²]."""
    sine = np.cos(0.5 * chord.turn)
    square = np.minimum(acceleration * TOLERANCE * sine / np.maximum(1.0 - sine, 1e-300), speed * speed)
    bend = 2.0 * np.sin(0.5 * chord.turn) / (0.5 * (chord.length[1:] + chord.length[:-1]))
    return float((square * bend)[chord.turn < math.radians(30.0)].max(initial=0.0))


def machine_of(acceleration: float) -> Machine:
    """Return the reference mill with limits on the whole vector only: what its axes may do is out of reach."""
    mill = load("reference-mill")
    axes = tuple(
        dataclasses.replace(axis, velocity=1000.0, acceleration=1e6, jerk=1e9, minimum=-1e7, maximum=1e7)
        for axis in mill.axes
    )
    path = PathLimits(acceleration=acceleration, jerk=JERK * acceleration)
    return dataclasses.replace(mill, axes=axes, path=path, path_tolerance=TOLERANCE)


def main() -> None:
    rows = {
        "curve, 100,000 x 0.2 mm": (curve(), 100.0, 1000.0),
        "… chords 0.14 to 0.26 mm": (curve(spread=0.3), 100.0, 1000.0),
        "mixed, 100,000": (mixed(), 100.0, 1000.0),
        "zig-zag, 100,000 x 1 mm": (zigzag(), 100.0, 1000.0),
        "hatch, 200,000": (hatch(), 100.0, 1000.0),
        "curve, faster": (curve(), 300.0, 2000.0),
        "… chords 0.14 to 0.26 mm, faster": (curve(spread=0.3), 300.0, 2000.0),
        "mixed, faster": (mixed(), 300.0, 2000.0),
        "zig-zag, faster": (zigzag(), 300.0, 2000.0),
        "hatch, faster": (hatch(), 300.0, 2000.0),
    }
    print("\n## Corner model\n")
    print(
        "| file | junction deviation [s] | its v²κ [mm/s²] | with centripetal rule [s] | optimum by curvature [s]"
        " | ours [s] | over the optimum | greatest acceleration [mm/s²] | limited jerk [s] | over the optimum |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|")
    for name, (points, speed, acceleration) in rows.items():
        chord, machine = chain_of(points), machine_of(acceleration)
        program = chain(points, speed)
        trajectory = plan(build(program, machine), machine, program=program, profile="trapezoid")
        smooth = plan(build(program, machine, continuity=2), machine, program=program, profile="s-curve").duration
        best = optimum(chord, speed, acceleration)
        times = np.linspace(0.0, trajectory.duration, 200_001)
        used = np.linalg.norm(trajectory.acceleration(times), axis=1).max()
        print(
            f"| {name} | {junction_time(chord, speed, acceleration, centripetal=False):.3f}"
            f" | {worst_bend(chord, speed, acceleration):,.0f}"
            f" | {junction_time(chord, speed, acceleration, centripetal=True):.3f} | {best:.3f}"
            f" | {trajectory.duration:.3f} | {100.0 * (trajectory.duration / best - 1.0):+.3f} % | {used:,.0f}"
            f" | {smooth:.3f} | {100.0 * (smooth / best - 1.0):+.1f} % |",
            flush=True,
        )


if __name__ == "__main__":
    main()
