"""Bytes dropped, flipped, doubled or cut on the line of a board's image: the same motion, or an alarm with the true
position; nothing else."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from trochia.backends.simulated_chip import PIN
from trochia.kernels.link import STATES, executed

if TYPE_CHECKING:
    from collections.abc import Callable

PINS = ("D2", "D3", "D4")


class Spoilt:
    """A line that spoils some of its bytes, and counts how many."""

    def __init__(self, line: Any, seed: int, rate: float) -> None:
        self.line, self.rate, self.faults, self.edges = line, rate, 0, line.edges
        self.rng = np.random.default_rng(seed)

    def spoil(self, data: bytes) -> bytes:
        kept = bytearray()
        for byte in data:
            kind = self.rng.random() / self.rate
            self.faults += kind < 1.0
            if kind >= 1.0:
                kept.append(byte)
            elif kind < 0.4:
                kept.append(byte ^ 1 << int(self.rng.integers(8)))
            elif kind < 0.6:
                kept += bytes([byte, byte])
            elif kind < 0.65:
                break
        return bytes(kept)

    def exchange(self, data: bytes, now: float) -> bytes:
        return self.spoil(self.line.exchange(self.spoil(data), now))


@pytest.mark.parametrize("seed", range(4))
def test_the_same_motion_or_an_alarm_with_the_true_position(talk: Callable[[str], Any], seed: int):
    spans = sys.modules["steady_spans"].steady([9_000, 8_000, 700], 36, slew=3000, stride=40)
    told = talk("uno-stepdir")
    told.switch(enable=1)
    told.begin()
    told.pass_on(0.01)
    clean, told.line = told.line, Spoilt(told.line, seed, 0.02)
    sent, started, until = 0, False, told.now + 1.2
    while told.now < until:
        while sent < len(spans) and told.session.room >= len(spans[sent]) and told.session.waiting < 2:
            told.session.order("span", spans[sent])
            sent += 1
        if not started and sent > 6:
            told.session.order("go")
            started = True
        told.pass_on(0.002)
        done = sent == len(spans) and not told.session.waiting
        stopped = told.status is not None and STATES[int(told.status["state"])] in {"idle", "stopped"}
        if started and (stopped or done) and told.now > until - 0.6:
            break
        if int(told.now * 1000) % 20 == 0:
            told.session.ask()
    faults, told.line = told.line.faults, clean
    told.pass_on(0.3)
    status, events = told.ask(), told.events()
    made = [
        int(np.count_nonzero((events["kind"] == PIN) & (events["unit"] == b"D") & (events["line"] == int(pin[1]))
                             & (events["value"] == 1))) for pin in PINS
    ]  # fmt: skip
    assert faults >= 50
    assert status["position"][:3].tolist() == made  # what it says is what it did
    if STATES[int(status["state"])] == "idle":
        assert made == executed(b"".join(spans)).position[:3].tolist()
    else:
        assert STATES[int(status["state"])] == "stopped"
