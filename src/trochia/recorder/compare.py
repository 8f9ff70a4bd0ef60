"""Two recordings held against each other, channel by channel."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.errors import RecordingError
from trochia.recorder.figures import Figures, figures

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from trochia.recorder.recording import Recording


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """What two recordings differ in.

    Attributes
    ----------
    differences
        Figures of ``b - a`` for every channel both have, over the samples both have, in the channel's unit.
    missing
        Channels only one of them has.
    samples
        Number of samples of each.
    """

    differences: Mapping[str, Figures]
    missing: tuple[str, ...]
    samples: tuple[int, int]

    @property
    def alike(self) -> bool:
        """Whether both have the same channels and equally many samples (their values may differ)."""
        return not self.missing and self.samples[0] == self.samples[1]


def compare(a: Recording, b: Recording) -> Comparison:
    """Return how far two recordings are apart, sample by sample from their common start.

    Raises
    ------
    RecordingError
        When their periods or starts differ: samples would be compared that do not belong together.
    """
    for what, first, second in (("period", a.period, b.period), ("start", a.start, b.start)):
        if not math.isclose(first, second, rel_tol=1e-9, abs_tol=1e-12):
            raise RecordingError(f"recordings of one {what} are comparable; these have {first!r} s and {second!r} s")
    samples = min(len(a), len(b))
    return Comparison(
        differences={
            name: figures(samples, lambda span, name=name: _difference(b[name][span], a[name][span]))
            for name in a.channels
            if name in b
        },
        missing=tuple(sorted(set(a.channels) ^ set(b.channels))),
        samples=(len(a), len(b)),
    )


def _difference(left: NDArray[Any], right: NDArray[Any]) -> NDArray[np.float64]:
    """Return ``left - right`` in doubles, so that unsigned channels do not wrap."""
    return left.astype(np.float64) - right.astype(np.float64)
