"""What is in one recording: the span of every channel, the states it went through, the greatest errors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from trochia.recorder import Recording


@dataclass(frozen=True, slots=True, kw_only=True)
class Look:
    """A recording in figures.

    Attributes
    ----------
    channels
        Of each: name, unit, least, greatest, rms; and the time and line of the greatest magnitude.
    states
        (time [s], name) of every change of state, the first included; empty where none are recorded.
    """

    about: dict[str, Any]
    channels: list[dict[str, Any]]
    states: list[tuple[float, str]]

    def figures(self) -> dict[str, Any]:
        """Return it as plain data."""
        return self.about | {"channels": self.channels,
                             "states": [{"time_s": time, "state": name} for time, name in self.states]}  # fmt: skip


def look(one: Recording) -> Look:
    """Return a recording in figures."""
    about = {
        "machine": one.machine, "program": one.program, "origin": one.header.origin,
        "created_by": one.header.created_by, "period_s": one.period, "start_s": one.start, "samples": len(one),
        "duration_s": max(len(one) - 1, 0) * one.period, "complete": one.complete,
    }  # fmt: skip
    return Look(about=about, channels=[_channel(one, c.name) for c in one.header.channels] if len(one) else [],
                states=_states(one))  # fmt: skip


def _channel(one: Recording, name: str) -> dict[str, Any]:
    samples = one[name].astype(np.float64)
    finite = np.where(np.isfinite(samples), samples, 0.0)
    at = int(np.argmax(np.abs(finite)))
    line = int(one["path.line"][at]) if "path.line" in one else None
    return {
        "name": name, "unit": one.describe(name).unit, "least": float(finite.min()), "greatest": float(finite.max()),
        "rms": float(np.sqrt(np.mean(finite * finite))), "time_s": one.start + at * one.period, "line": line,
    }  # fmt: skip


def _states(one: Recording) -> list[tuple[float, str]]:
    if "state" not in one or not len(one):
        return []
    codes, names = one["state"], one.describe("state").values
    changes = np.concatenate([[0], np.flatnonzero(np.diff(codes)) + 1])
    return [(one.start + int(k) * one.period, names[codes[k]] if codes[k] < len(names) else str(codes[k]))
            for k in changes]  # fmt: skip
