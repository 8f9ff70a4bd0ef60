"""Peak and root mean square of a long signal, block by block."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

BLOCK = 1 << 18  #: samples looked at together: some 2 MB a channel


@dataclass(frozen=True, slots=True)
class Figures:
    """Greatest magnitude, root mean square, and the sample of the greatest magnitude (0 of none)."""

    peak: float
    rms: float
    at: int


def spans(samples: int) -> Iterator[slice]:
    """Yield slices that cover ``samples`` in blocks."""
    for first in range(0, samples, BLOCK):
        yield slice(first, min(first + BLOCK, samples))


def figures(samples: int, part: Callable[[slice], NDArray[Any]]) -> Figures:
    """Return the figures of a signal of which ``part`` gives any span; only one span is held at a time."""
    peak, at, squares = 0.0, 0, 0.0
    for span in spans(samples):
        magnitude = np.abs(part(span)).astype(np.float64, copy=False)
        place = int(np.argmax(magnitude))
        # a NaN must come through as the peak, not vanish in a comparison (argmax finds it first)
        if magnitude[place] > peak or math.isnan(magnitude[place]):
            peak, at = float(magnitude[place]), span.start + place
        squares += float(magnitude @ magnitude)
    return Figures(peak, math.sqrt(squares / samples) if samples else 0.0, at)
