"""A two-axis machine of steppers as small as it can be, and motions over a line of it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
import pytest

from trochia.kernels.layout import PHASE, SEGMENT
from trochia.machine.joints import Stepper
from trochia.machine.load import load
from trochia.machine.transmissions import Leadscrew
from trochia.toolpath import Toolpath

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from trochia.machine.machine import Machine


@dataclass(frozen=True)
class LineMotion:
    """Phases over one line from ``start`` along ``direction``; blocks as they are given."""

    path: Toolpath
    given: tuple[np.ndarray, ...]

    def blocks(self) -> Iterator[np.ndarray]:
        yield from self.given


@pytest.fixture
def laser() -> Machine:
    """The shipped laser with 200 steps a turn on 4 mm, its drivers' defaults and no limit of rate."""
    machine = load("laser")
    lead = Leadscrew(lead=Fraction(4))
    joints = tuple(
        replace(joint, transmission=lead, motor=Stepper(), pulse_rate=None, velocity=None) for joint in machine.joints
    )
    return replace(machine, joints=joints)


@pytest.fixture
def line_motion() -> Callable[..., LineMotion]:
    """Return a maker of motions: start, direction, then blocks of rows (t, duration, s, v, a, j)."""

    def make(start: list[float], direction: list[float], *blocks: list[tuple[float, ...]]) -> LineMotion:
        segments = np.zeros(1, SEGMENT)
        segments["length"], segments["move"] = 1000.0, 7
        arrays: list[np.ndarray] = []
        for rows in blocks:
            phases = np.zeros(len(rows), PHASE)
            for number, row in enumerate(rows):
                for name, value in zip(("t", "duration", "s", "v", "a", "j"), row, strict=True):
                    phases[name][number] = value
            arrays.append(phases)
        path = Toolpath(axes="XY", start=np.array(start), segments=segments, pool=np.array([*start, *direction]))
        return LineMotion(path, tuple(arrays))

    return make
