"""Programs as shapes need them: chains of chords of many kinds, as moves in memory, and programs as text.

In: sizes and seeds.  Out: points or G-code; the same for the same seed.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from trochia.program import MOVE, MoveKind, Program

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Points = NDArray[np.float64]


def chain(points: Points, feed: float = 100.0) -> Program:
    """Return a program of straight feeds through points (k, 2 or 3), from the first on."""
    moves = np.zeros(len(points) - 1, dtype=MOVE)
    moves["target"][:, : points.shape[1]], moves["kind"], moves["rate"] = points[1:], MoveKind.FEED, feed
    moves["line"] = np.arange(1, len(points))
    start = np.zeros(9)
    start[: points.shape[1]] = points[0]
    return Program(name="chain", lines=len(moves), start=start, moves=moves, actions=())


def curve(count: int = 100_000, chord: float = 0.2, spread: float = 0.0, seed: int = 1) -> Points:
    """Return a rosette of five leaves walked in chords: radius 8.3 mm at its tightest, straight between.

    ``spread`` is the part by which chords are longer or shorter, at random.
    """
    chance = np.random.default_rng(seed)
    fine = np.linspace(0.0, 2.0 * math.pi, 200_001)
    radius = 40.0 + 10.0 * np.cos(5.0 * fine)
    x, y = radius * np.cos(fine), radius * np.sin(fine)
    way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
    chords = chord * (1.0 + spread * chance.uniform(-1.0, 1.0, count))
    s = np.concatenate([[0.0], np.cumsum(chords)]) % way[-1]
    return np.stack([np.interp(s, way, x), np.interp(s, way, y)], axis=1)


def mixed(count: int = 100_000, seed: int = 1) -> Points:
    """Return lines of 1 to 20 mm at any angle, and between them bends of radius 2 to 30 mm in chords of 0.5 mm."""
    chance = np.random.default_rng(seed)
    steps: list[complex] = []
    heading = 0.0
    while len(steps) < count:
        if chance.uniform() < 0.6:
            heading += chance.uniform(-2.8, 2.8)
            steps.append(chance.uniform(1.0, 20.0) * np.exp(1j * heading))
            continue
        radius, chords = chance.uniform(2.0, 30.0), int(chance.integers(4, 30))
        turn = chance.choice([-1.0, 1.0]) * 2.0 * math.asin(0.25 / radius)
        for _ in range(chords):
            heading += turn
            steps.append(0.5 * np.exp(1j * heading))
    z = np.concatenate([[0j], np.cumsum(steps[:count])])
    return np.stack([z.real, z.imag], axis=1)


def zigzag(count: int = 100_000, chord: float = 1.0, degrees: float = 120.0) -> Points:
    """Return chords that turn by the same angle one way and the other."""
    half = math.radians(degrees) / 2.0
    along = np.arange(count + 1) * chord * math.cos(half)
    return np.stack([along, chord * math.sin(half) * (np.arange(count + 1) % 2)], axis=1)


def hatch(count: int = 200_000, width: float = 15.0, step: float = 0.2) -> Points:
    """Return there and back in lines of one width, a step to the side between them."""
    k = np.arange(count + 1)
    return np.stack([np.where((k + 1) // 2 % 2 == 1, width, 0.0), k // 2 * step], axis=1)
