"""How an experiment is run: checked before, watched while it runs, and the motor off at its end whatever happens.

In: an axis, a loop, set-points.  Out: samples, a row a tick.
"""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import fields
from typing import TYPE_CHECKING

import numpy as np

from trochia.kernels.servo import ServoSamples

if TYPE_CHECKING:
    from collections.abc import Generator

    from numpy.typing import NDArray

    from trochia.experiments.protocol import AxisUnderTest, Bounds
    from trochia.servo.axis import Loop

    Array = NDArray[np.float64]

BLOCK = 0.01  #: how often bounds are looked at [s]


@contextmanager
def powered(axis: AxisUnderTest, loop: Loop) -> Generator[None]:
    """Power the motor for a block of code; it is off when the block is left, by whatever way."""
    try:
        axis.enable(loop)
        yield
    finally:
        axis.off()


def perform(
    axis: AxisUnderTest, loop: Loop, bounds: Bounds, wanted: Array, injected: Array | None = None
) -> ServoSamples:
    """Run set-points (ticks, 3), with values injected into the command (ticks,), and return the samples.

    Raises
    ------
    LimitError
        Before anything moves where the bounds would be left; while it runs where they are.
    """
    bounds.refuse(wanted, injected)
    with powered(axis, loop):
        return watched(axis, bounds, wanted, injected)


def watched(axis: AxisUnderTest, bounds: Bounds, wanted: Array, injected: Array | None = None) -> ServoSamples:
    """Run set-points on an axis that is powered, block by block, looking at the bounds after each."""
    ticks = max(1, round(BLOCK / axis.period))
    parts: list[ServoSamples] = []
    for start in range(0, len(wanted), ticks):
        part = slice(start, start + ticks)
        samples = axis.advance(wanted[part], None if injected is None else injected[part])
        bounds.watch(samples)
        parts.append(samples)
    return joined(parts)


def joined(parts: list[ServoSamples]) -> ServoSamples:
    """Return parts one behind the other."""
    return ServoSamples(
        **{field.name: np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(ServoSamples)}
    )
