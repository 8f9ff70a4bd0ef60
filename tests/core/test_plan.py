"""The planner's passes in C against the same passes said plainly, constraint by constraint."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from trochia.languages import gcode
from trochia.machine.axes import PathLimits
from trochia.machine.load import load
from trochia.planner import Limits, plan
from trochia.toolpath import SegmentKind, build

MILL = load("reference-mill")


def belts():
    machine = load("corexy")
    joints = tuple(dataclasses.replace(j, velocity=200.0, acceleration=1500.0) if i < 2 else j
                   for i, j in enumerate(machine.joints))  # fmt: skip
    return dataclasses.replace(machine, joints=joints)


MACHINES = {
    "mill": MILL,
    "belts": belts(),
    "capped": dataclasses.replace(MILL, path=PathLimits(velocity=120.0, acceleration=500.0)),
}
PROGRAMS = {
    "lines": "G64 P0.05\nF6000\nG1 X10\nY3\nX12 Y8\nX12.5\nX13 Y8.4\nG0 X0 Y0 Z1",
    "arcs": "G64 P0.05\nF9000\nG1 X10\nG3 X20 Y10 J10\nG1 Y12\nG2 X22 Y14 I2\nG3 X22 Y14 I-2\nG1 X0 Z2 F600",
    "helix and spiral": "G64 P0.01\nF9000\nG3 X0 Y0 Z3 I6\nG2 X12.004 Y0 I6\nG1 X12.005 Y-5",
}


class Piece:
    """One stretch of a segment with everything divided by its row's acceleration limit."""

    def __init__(self, path, limits, row, part, parts):
        segment = path.segments[row]
        n = len(path.axes)
        self.length = segment["length"] / parts
        self.stop = bool(segment["stop"]) and part + 1 == parts
        s = np.array([part, part + 1]) * self.length
        rows = np.array([row, row])
        x1, x2 = path.points(rows, s, 1), path.points(rows, s, 2)
        third, fourth = self._bounds(path, segment, n)
        eighth = self.length**2 / 8
        scale = 1 / limits.acceleration
        self.t, self.k = x1 @ limits.matrix.T * scale, x2 @ limits.matrix.T * scale
        in_rows = np.array([math.hypot(*r[third > 0]) if (third > 0).any() else 0.0 for r in limits.matrix])
        cubic = segment["kind"] == SegmentKind.CUBIC
        sag3 = np.abs(limits.matrix @ third) if cubic else in_rows * third.max()
        self.sag_w, self.sag_a = eighth * in_rows * fourth * scale, 5 * eighth * sag3 * scale
        self.cap = limits.path_acceleration
        self.vectors = (x1[:, : limits.linear] / self.cap, x2[:, : limits.linear] / self.cap)
        size3, size4 = (np.linalg.norm(third), 0.0) if cubic else (third.max(), fourth)
        self.cap_w, self.cap_a = eighth * size4 / self.cap, 5 * eighth * size3 / self.cap
        along = np.linalg.norm(x1, axis=1).max() + eighth * size3
        slow = np.max((np.abs(x1 @ limits.matrix.T).max(axis=0) + eighth * sag3) / limits.velocity)
        # a cubic may be longer than its range of s
        stretch = max(np.linalg.norm(x1, axis=1).max() + eighth * np.linalg.norm(third), 1) if cubic else 1
        slow = max(slow, along / limits.path_velocity)
        feed = min((segment["speed_limit"] / stretch) ** 2, 1 / slow**2)
        bent = np.linalg.norm(self.vectors[1], axis=1) + self.cap_w
        self.ceiling = [
            min(feed, 1 / max((abs(k) + self.sag_w).max(), b, 1e-300)) for k, b in zip(self.k, bent, strict=True)
        ]

    @staticmethod
    def _bounds(path, segment, n):
        c = path.pool[int(segment["data"]) :]
        if segment["kind"] == SegmentKind.LINE:
            return np.zeros(n), 0.0
        if segment["kind"] == SegmentKind.CUBIC:
            return 6 * c[3 * n : 4 * n], 0.0
        third = np.zeros(n)
        ends = [0.0, segment["length"]]
        r, w = max(c[2] + c[5] * s for s in ends), max(abs(c[4] + 2 * c[6 + 2 * n] * s) for s in ends)
        d, u = abs(c[5]), abs(2 * c[6 + 2 * n])
        third[[segment["first"], segment["second"]]] = r * w**3 + 3 * d * w**2 + 3 * r * w * u + 3 * d * u
        return third, r * w**4 + 4 * d * w**3 + 6 * r * w**2 * u + 12 * d * w * u + 3 * r * u * u

    def reach(self, end, w):
        """Greatest change of w along the piece, from w at one end: every constraint at both ends in turn."""
        sign, found = (-1.0 if end else 1.0), math.inf
        for at, travelled in ((end, 0.0), (1 - end, 2 * self.length)):
            for k, t, sag_w, sag_a in zip(self.k[at], self.t[at], self.sag_w, self.sag_a, strict=True):
                slope, drain = travelled * k + sign * t, 2 * self.length * sag_w + sag_a
                for way in (1, -1):
                    if drain + way * slope > 0:
                        found = min(found, max(0.0, 1 - sag_w * w - way * k * w) / (drain + way * slope))
            if np.isfinite(self.cap):
                found = min(found, self._cap(at, sign, travelled, w))
        return 2 * self.length * found

    def _cap(self, at, sign, travelled, w):
        """The same for the vector: what is asked for is convex in alpha, so its last crossing is found by halving."""
        x1, x2 = self.vectors[0][at], self.vectors[1][at]
        drain = 2 * self.length * self.cap_w + self.cap_a

        def over(alpha):
            asked = np.linalg.norm(x2 * w + (travelled * x2 + sign * x1) * alpha)
            return asked + drain * alpha > 1 - self.cap_w * w

        low, high = 0.0, 1e-3
        while not over(high) and high < 1e9:
            low, high = high, high * 2
        for _ in range(100):
            middle = (low + high) / 2
            low, high = (low, middle) if over(middle) else (middle, high)
        return low


def reference_speeds(path, limits, parts):
    """ds/dt at the end of every piece: a pass back, a pass forward."""
    pieces = [Piece(path, limits, row, part, n) for row, n in enumerate(parts) for part in range(n)]
    most, following = [], 0.0
    for piece in reversed(pieces):
        end = 0.0 if piece.stop else min(following, piece.ceiling[1])
        most.append(end)
        following = piece.ceiling[0] if end >= piece.ceiling[0] else min(piece.ceiling[0], end + piece.reach(1, end))
    speeds, w = [], 0.0
    for piece, end in zip(pieces, reversed(most), strict=True):
        w = min(end, w + piece.reach(0, w)) if end > w else end
        speeds.append(math.sqrt(w))
    return speeds


@pytest.mark.parametrize("text", PROGRAMS.values(), ids=PROGRAMS)
@pytest.mark.parametrize("name", MACHINES)
def test_speeds_at_every_joint(name, text):
    machine = MACHINES[name]
    program = gcode.read(text + "\nM2\n")
    path = build(program, machine)
    trajectory = plan(path, machine, program=program)
    pieces = trajectory.schedule._planned.pieces
    parts = [int(pieces["parts"][pieces["segment"] == row][0]) for row in range(len(path))]
    expected = reference_speeds(path, Limits.of(machine), parts)
    assert pieces["exit"] == pytest.approx(expected, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("text", PROGRAMS.values(), ids=PROGRAMS)
@pytest.mark.parametrize("name", MACHINES)
def test_times_are_those_of_the_speeds(name, text):
    machine = MACHINES[name]
    program = gcode.read(text + "\nM2\n")
    path = build(program, machine)
    trajectory = plan(path, machine, program=program)
    t = np.linspace(0, trajectory.duration, 200_001)
    speed = trajectory.path_speed(t)
    assert np.trapezoid(speed, t) == pytest.approx(path.length, rel=1e-6)
    phases = np.concatenate(list(trajectory.blocks()))
    assert phases["duration"].sum() == pytest.approx(trajectory.duration, rel=1e-12)
