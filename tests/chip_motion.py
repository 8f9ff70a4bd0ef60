"""Motion of an image on the simulated chip: what its pins did, from the edges that were seen."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.backends.simulated_chip import PIN, PWM

if TYPE_CHECKING:
    from numpy.typing import NDArray


def edges(events: NDArray[np.void], pin: str, level: int) -> NDArray[np.int64]:
    mine = (events["kind"] == PIN) & (events["unit"] == pin[0].encode()) & (events["line"] == int(pin[1:]))
    return events["cycle"][mine & (events["value"] == level)].astype(np.int64)


def duties(events: NDArray[np.void]) -> list[tuple[int, int]]:
    """Return when the beam's duty changed [cycles], and to what."""
    beam = events[(events["kind"] == PWM) & (events["unit"] == b"2") & (events["line"] == 0)]
    seen: list[tuple[int, int]] = []
    for cycle, value in zip(beam["cycle"].tolist(), (beam["value"] & 255).tolist(), strict=True):
        if value and (not seen or seen[-1][1] != value):
            seen.append((cycle, value))
    return seen
