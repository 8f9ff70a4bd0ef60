"""A profile as a controller ran it: from the times it told of its steps (S1-F47).

In: a text, ``time_s`` or ``time_ms`` in its first line, then the time of each step, one a line.  Out: a profile, to be
laid over the one it was to be.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import ConfigError, Source
from trochia.pulses.ramps.demand import LONGEST, Demand
from trochia.pulses.ramps.profile import Profile

if TYPE_CHECKING:
    from pathlib import Path

LAW = "measured"
_UNITS = {"time_s": 1.0, "time_ms": 1e-3, "time_us": 1e-6}


def read_times(path: Path, *, steps_per_turn: int = 200, clock: float = 1e6) -> Profile:
    """Return the profile whose steps were made at the times of a file, from zero on.

    Raises
    ------
    ConfigError
        With file and line: for a first line that names no unit, a line that is no time, times that do not rise.
    OSError
        When the file cannot be read.
    """
    name = str(path)
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise ConfigError("is no text", source=Source(name, 1)) from None
    head = lines[0].strip() if lines else ""
    if head not in _UNITS:
        raise ConfigError(f"the first line must be one of {', '.join(_UNITS)}, not {head!r}", source=Source(name, 1))
    times: list[float] = []
    for number, line in enumerate(lines[1:], 2):
        if not line.strip():
            continue
        try:
            time = float(line) * _UNITS[head]
        except ValueError:
            raise ConfigError(f"expected a time, not {line.strip()!r}", source=Source(name, number)) from None
        if not (times[-1] if times else 0.0) < time < 1e9:
            raise ConfigError(f"{line.strip()} does not rise: each step is later than the one before",
                              source=Source(name, number))  # fmt: skip
        times.append(time)
    if not 1 <= len(times) <= LONGEST:
        raise ConfigError(f"expected the times of 1 to {LONGEST} steps, not {len(times)}", source=Source(name, 1))
    delays = np.diff(np.array([0.0, *times]))
    demand = Demand(steps=len(times), speed=float(1.0 / delays.min()), steps_per_turn=steps_per_turn,
                    clock=max(clock, float(1.0 / delays.min())))  # fmt: skip
    return Profile(law=LAW, title=f"Measured, {path.name}", demand=demand, delays=delays)
