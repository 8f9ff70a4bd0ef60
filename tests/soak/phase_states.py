"""States inside phases, by the phases' own arithmetic: what laws of trajectories are held to."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.kernels import path as kernel

if TYPE_CHECKING:
    from trochia.planner import Trajectory

POINTS = 11


def inside(phases: np.ndarray) -> np.ndarray:
    """Return states at evenly spaced instants of every phase, ends included (phases x POINTS,)."""
    states = np.repeat(phases, POINTS)
    tau = np.tile(np.linspace(0, 1, POINTS), len(phases)) * states["duration"]
    states["s"] += tau * (states["v"] + tau * (states["a"] / 2 + tau * states["j"] / 6))
    states["v"] += tau * (states["a"] + tau * states["j"] / 2)
    states["a"] += tau * states["j"]
    return states


def derivative(trajectory: Trajectory, states: np.ndarray, order: int) -> np.ndarray:
    """Return the axes' positions (order 0) or their derivatives at states (states, axes)."""
    path = trajectory.path
    return kernel.sample(path.segments, path.pool, len(path.axes), states, order)
