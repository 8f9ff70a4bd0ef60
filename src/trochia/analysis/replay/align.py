"""Two recordings brought onto one clock.  In: a plan's or a run's, and a run's.  Out: both on the times of the first.

A recording of a run begins before motion does, and a plan's with it.  So each is taken from where its job begins to
move: the last sample at rest before the first of motion, with a run's state ``running`` if it says states.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.errors import RecordingError
from trochia.recorder import Channel, Recording

if TYPE_CHECKING:
    from numpy.typing import NDArray

RUNNING = ("running", "stepping")
STILL = 1e-9  #: of a speed that is as good as none [mm/s or degree/s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Pair:
    """Two recordings on one clock, their times from the start of motion; ``began`` says where that is in each [s]."""

    a: Recording
    b: Recording
    began: tuple[float, float]


def aligned(a: Recording, b: Recording, *, by: str = "motion") -> Pair:
    """Return two recordings on the times of the first.

    Parameters
    ----------
    by
        ``motion``: from where each begins to move; ``start``: from the first sample of each; ``time``: as they stand.

    Raises
    ------
    RecordingError
        When they are of two machines, or one has no motion.
    """
    if a.machine != b.machine:
        raise RecordingError(f"these are recordings of two machines, {a.machine!r} and {b.machine!r}")
    began = (_begin(a, by), _begin(b, by))
    first = max(round((a.start - began[0]) / a.period), math.ceil((b.start - began[1]) / a.period - 1e-6))
    end = min(a.start - began[0] + (len(a) - 1) * a.period, b.start - began[1] + (len(b) - 1) * b.period)
    count = max(math.floor(end / a.period + 1e-6) - first + 1, 0)
    if not count:
        raise RecordingError("the recordings have no time in common")
    times = a.period * np.arange(first, first + count, dtype=np.float64)
    both = [_on(one, began[i] + times, times[0]) for i, one in enumerate((a, b))]
    return Pair(a=both[0], b=both[1], began=began)


def _begin(one: Recording, by: str) -> float:
    if by == "motion":
        return begin_of_motion(one)
    return one.start if by == "start" else 0.0


def begin_of_motion(one: Recording) -> float:
    """Return the time of the last sample at rest before the job moves [s]."""
    moving = _moving(one)
    if "state" in one:
        names = one.describe("state").values
        codes = [code for code, name in enumerate(names) if name in RUNNING]
        moving = moving & np.isin(one["state"], codes)
    if not moving.any():
        raise RecordingError(f"{one.program or one.machine}: nothing moves in this recording",
                             hint="Align by --align start.")  # fmt: skip
    return one.start + max(int(np.argmax(moving)) - 1, 0) * one.period


def _moving(one: Recording) -> NDArray[np.bool_]:
    """Return at which samples something is told to move (samples,)."""
    if not one.axes:
        raise RecordingError("this recording has no commanded positions", hint="Record the channels *.commanded.")
    moving = np.zeros(len(one), np.bool_)
    for axis in one.axes:
        moving[1:] |= np.abs(np.diff(one[f"{axis}.commanded"])) > STILL * one.period
    return moving


def _on(one: Recording, times: NDArray[np.float64], start: float) -> Recording:
    """Return a recording at other times: whole numbers as they last were, all else on straight lines."""
    place = (times - one.start) / one.period
    whole = np.clip(np.floor(place + 1e-6).astype(np.intp), 0, len(one) - 1)
    after = np.minimum(whole + 1, len(one) - 1)
    share = np.clip(place - whole, 0.0, 1.0)
    share[share < 1e-6] = 0.0

    def at(channel: Channel) -> NDArray[Any]:
        samples = one[channel.name]
        if samples.dtype.kind != "f" or channel.name == "beam":
            return samples[whole]
        return samples[whole] + np.where(share > 0.0, share * (samples[after] - samples[whole]), 0.0)

    channels = tuple(one.header.channels)
    period = float(times[1] - times[0]) if len(times) > 1 else one.period
    header = replace(one.header, period=period, start=float(start), duration=float(times[-1] - times[0]))
    return Recording(header=header, channels={c.name: at(c) for c in channels}, complete=one.complete)
