"""A recording held against another: the greatest deviation of every channel, when, and at which line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.analysis.replay.align import RUNNING, Pair
from trochia.analysis.replay.way import way_apart
from trochia.recorder import compare

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from trochia.recorder import Recording

WAY = "path"  #: what the distance between the two ways is called among the channels


@dataclass(frozen=True, slots=True, kw_only=True)
class Deviation:
    """How far a channel of the second is from the first: greatest and rms in its unit, when [s], source line."""

    unit: str
    peak: float
    rms: float
    time: float
    line: int | None

    def figures(self) -> dict[str, Any]:
        """Return it as plain data."""
        return {"unit": self.unit, "peak": self.peak, "rms": self.rms, "time_s": self.time, "line": self.line}


@dataclass(frozen=True, slots=True, kw_only=True)
class Held:
    """Two recordings held against each other.

    Attributes
    ----------
    deviations
        Of every channel both have; ``path`` is the distance of the second's place from the first's way, whenever.
    missing
        Channels only one of them has.
    seconds
        How long they were held against each other [s].
    began
        Where motion begins in each [s].
    """

    deviations: Mapping[str, Deviation]
    missing: tuple[str, ...]
    seconds: float
    began: tuple[float, float]

    def beyond(self, tolerance: float) -> list[str]:
        """Return the channels of positions in mm, and the way, that deviate by more than a tolerance [mm]."""
        judged = (WAY,) if WAY in self.deviations else tuple(
            name for name in self.deviations if name.endswith((".commanded", ".actual")))  # fmt: skip
        return [n for n in judged if self.deviations[n].unit == "mm" and not self.deviations[n].peak <= tolerance]


def hold_against(pair: Pair, whole: tuple[Recording, Recording]) -> Held:
    """Return how far the second of a pair is from the first; ``whole`` are both as they were recorded."""
    compared = compare(pair.a, pair.b)
    lines = pair.a.channels.get("path.line")
    deviations: dict[str, Deviation] = {}
    for name, figures in compared.differences.items():
        if name in {"state", "path.line", "path.time"}:
            continue
        line = None if lines is None else int(lines[figures.at])
        deviations[name] = Deviation(unit=pair.a.describe(name).unit, peak=figures.peak, rms=figures.rms,
                                     time=pair.a.start + figures.at * pair.a.period, line=line)  # fmt: skip
    if any(axis in "XYZ" for axis in pair.a.axes):
        deviations = {WAY: _way(pair, whole)} | deviations
    return Held(deviations=deviations, missing=compared.missing, seconds=pair.a.duration, began=pair.began)


def _way(pair: Pair, whole: tuple[Recording, Recording]) -> Deviation:
    """Return how far the second is from the first's way, over all that its job moved."""
    plan, run = whole
    job = _job(run, pair.began[1])
    apart = np.where(job, way_apart(plan, run), 0.0)
    at = int(np.argmax(apart))
    line = int(run["path.line"][at]) if "path.line" in run else None
    rms = float(np.sqrt(np.mean(np.square(apart[job])))) if job.any() else 0.0
    return Deviation(unit="mm", peak=float(apart[at]), rms=rms, time=at * run.period + run.start - pair.began[1],
                     line=line)  # fmt: skip


def _job(run: Recording, began: float) -> NDArray[np.bool_]:
    """Return which samples belong to the job (samples,): from its motion on, as long as it is under way."""
    job = run.time >= began - 0.5 * run.period
    if "state" not in run:
        return job
    under_way = (*RUNNING, "holding", "held", "resuming")
    codes = [code for code, name in enumerate(run.describe("state").values) if name in under_way]
    return job & np.isin(run["state"], codes)
