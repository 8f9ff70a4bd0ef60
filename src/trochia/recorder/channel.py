"""What a recording says about itself: its channels, and the header that goes with every sample.

Channel names are ``owner.quantity``: an axis by its letter (``X.commanded``), a joint as ``joint.NAME``
(``joint.X.counts``), the path as ``path`` (``path.speed``); ``docs/reference/recording.md`` lists them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from trochia import __version__
from trochia.errors import RecordingError

FORMAT_VERSION = 1  #: of the files; raised when an older reader would misread them

Scalar = Literal["<f8", "<f4", "<i8", "<i4", "<u4", "|u1"]
SCALARS: tuple[str, ...] = get_args(Scalar)


@dataclass(frozen=True, slots=True, kw_only=True)
class Channel:
    """One recorded quantity.

    Attributes
    ----------
    name
        ``owner.quantity``.
    unit
        Unit text, empty for a bare number: ``"mm"``, ``"degree"``, ``"mm/s"``, ``"count"``, ``"step"``.
    dtype
        Little-endian scalar, spelled as numpy spells it.
    values
        What the values 0, 1, 2, … are called, where they are names by number.
    """

    name: str
    unit: str = ""
    dtype: Scalar = "<f8"
    values: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not self.name:
            raise RecordingError("a channel needs a name")
        if self.dtype not in SCALARS:
            raise RecordingError(f"channel {self.name}: expected a dtype of {', '.join(SCALARS)}, not {self.dtype!r}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Header:
    """Everything about a recording but its samples.

    Attributes
    ----------
    period, start
        Time between samples, and time of the first [s].
    duration
        Length of the recorded motion [s]; the last sample stands at it or less than a period after it.
    machine, program
        Names, for people and for reports.
    channels
        In the order of the file.
    origin
        What made the samples: a backend's kind and the conventions it used.
    """

    period: float
    channels: tuple[Channel, ...]
    duration: float = 0.0
    start: float = 0.0
    machine: str = ""
    program: str = ""
    origin: str = ""
    created_by: str = f"trochia {__version__}"
    format_version: int = FORMAT_VERSION

    def __post_init__(self) -> None:
        if not (math.isfinite(self.period) and self.period > 0):
            raise RecordingError(f"a recording's period must be above zero, not {self.period!r} s")
        if not self.channels:
            raise RecordingError("a recording needs at least one channel")
        names = [channel.name for channel in self.channels]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise RecordingError(f"a recording has each channel once; twice here: {', '.join(twice)}")

    @property
    def record(self) -> np.dtype[Any]:
        """One sample of every channel, aligned as C aligns a struct; a recording's binary file is an array of these."""
        return np.dtype([(channel.name, channel.dtype) for channel in self.channels], align=True)
