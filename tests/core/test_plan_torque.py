"""The torque passes in C against a plain statement of them on a fine grid, and how the C core guards itself."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from trochia.kernels.torque import Falling
from trochia.languages import gcode
from trochia.machine.acceleration import AccelerationCurve
from trochia.machine.load import load
from trochia.planner import Limits, plan
from trochia.toolpath import build

MILL = load("reference-mill")
CURVE = AccelerationCurve(knots=((0.0, 900.0), (40.0, 700.0), (120.0, 150.0), (200.0, 60.0)))
STEP = 0.002  # mm


def machine():
    axes = (dataclasses.replace(MILL.axes[0], acceleration=5000.0, acceleration_curve=CURVE), *MILL.axes[1:])
    return dataclasses.replace(MILL, axes=axes)


def reference(lengths, speeds):
    """Time along X from rest to rest: v² by two passes over a grid of the way, dv²/ds = 2 A(v) [s]."""
    ceiling = np.concatenate(
        [np.full(round(length / STEP), speed) for length, speed in zip(lengths, speeds, strict=True)]
    )
    nodes = np.concatenate([[0.0], np.minimum(ceiling[1:], ceiling[:-1]), [0.0]])
    for order in (slice(None, None, -1), slice(None)):
        w, cell = nodes[order] ** 2, ceiling[order] ** 2
        for i in range(len(cell)):
            rise = w[i] + 2.0 * STEP * float(CURVE.at(np.sqrt(w[i])))
            w[i + 1] = min(w[i + 1], rise, cell[i])
        nodes[order] = np.sqrt(w)
    return float(np.sum(2.0 * STEP / (nodes[1:] + nodes[:-1])))


@pytest.mark.parametrize("seed", range(4))
def test_a_chain_of_feeds_takes_as_long_as_the_plain_passes_say(seed):
    chance = np.random.default_rng(seed)
    lengths, speeds = chance.integers(1, 12, 4) * 1.0, chance.uniform(5.0, 199.0, 4)
    lines = [f"G1 X{x:.1f} F{60 * speed:.6f}" for x, speed in zip(np.cumsum(lengths), speeds, strict=True)]
    program, on = gcode.read("\n".join(lines) + "\nM2\n"), machine()
    made = plan(build(program, on), on, program=program, profile="torque")
    assert made.duration == pytest.approx(reference(lengths, speeds), rel=2e-3)


def test_knots_out_of_order_never_reach_c():
    program = gcode.read("G1 X10 F600\nM2\n")
    path, limits = build(program, MILL), Limits.of(MILL)
    for knots in ([[0.0, 100.0], [10.0, 200.0]], [[10.0, 100.0], [5.0, 50.0]], [[0.0, 100.0], [5.0, 0.0]]):
        with pytest.raises(ValueError, match="never rise"):
            Falling(
                path.segments, path.pool, matrix=limits.matrix, velocity=limits.velocity,
                acceleration=limits.acceleration, knots={0: np.array(knots)}, caps=(np.inf, np.inf), linear=3,
                rests=(np.zeros(0, np.uint64), np.zeros(0)),
            )  # fmt: skip
