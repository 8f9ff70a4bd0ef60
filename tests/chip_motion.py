"""Motion of an image on the simulated chip: spans in, edges of its pins out."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.backends.simulated_chip import PIN, PWM
from trochia.kernels.link import STATES

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


def stream(told: Any, spans: list[bytes], *, status: float = 0.01) -> Any:
    """Send spans as there is room, a status asked for every so often, until all is done."""
    told.switch(enable=1)
    told.begin()
    sent, started, asked = 0, False, told.now
    while True:
        while sent < len(spans) and told.session.room >= len(spans[sent]) and told.session.waiting < 3:
            told.session.order("span", spans[sent])
            sent += 1
        full = sent == len(spans) or told.session.room < len(spans[0])
        if not started and full and not told.session.waiting:
            told.session.order("go")
            started, told.status = True, None
        if told.now - asked >= status:
            told.session.ask()
            asked = told.now
        told.pass_on(0.0005)
        if started and told.status is not None and STATES[int(told.status["state"])] in {"idle", "stopped"}:
            return told.ask()
