"""A line between a host and a chip that goes wrong where it is told to, or now and then.

In: bytes both ways.  Out: the same, but for what was done to them, and how often that was.
"""

from __future__ import annotations

import itertools
from collections import deque
from dataclasses import dataclass
from typing import Any

import numpy as np

KINDS = ("drop", "flip", "double", "burst", "delay", "cut")
TO_CHIP, TO_HOST = 0, 1
ALWAYS = 1e9  #: s, of a cut that nobody mends


@dataclass(frozen=True, slots=True, kw_only=True)
class Fault:
    """What is done to the byte number ``at`` of a way.

    ``size`` is the bit of a flip, the bytes of a burst (garbage in their place), the seconds of a delay or a cut: in a
    delay what comes after waits as well, in a cut nothing arrives either way.
    """

    kind: str
    way: int
    at: int
    size: float = 0.0


class SpoiltLine:
    """A transport's ``exchange`` with faults in between.

    Parameters
    ----------
    line
        Has ``exchange(data, now)``.
    faults
        Each is done once.
    rate
        Of bytes to which a short fault is done beside these.
    """

    def __init__(self, line: Any, seed: int, *, faults: tuple[Fault, ...] = (), rate: float = 0.0) -> None:
        self.line, self.rate, self.edges = line, rate, getattr(line, "edges", None)
        self.rng = np.random.default_rng(seed)
        self.passed, self.faults, self.done = [0, 0], 0, []
        self._due = list(faults)
        self._burst, self._cut = [0, 0], 0.0
        self._held: list[deque[tuple[float, bytes]]] = [deque(), deque()]
        self._until = [0.0, 0.0]

    def arm(self, *faults: Fault) -> None:
        """Do these as well, their bytes counted from here on."""
        for fault in faults:
            at = self.passed[fault.way] + fault.at
            self._due.append(Fault(kind=fault.kind, way=fault.way, at=at, size=fault.size))

    def mend(self) -> None:
        """No more faults: what waits comes, a cut is joined."""
        self._due.clear()
        self.rate, self._burst, self._cut, self._until = 0.0, [0, 0], 0.0, [0.0, 0.0]

    def exchange(self, data: bytes, now: float) -> bytes:
        there = self._late(TO_CHIP, self._spoil(data, TO_CHIP, now), now)
        return self._late(TO_HOST, self._spoil(self.line.exchange(there, now), TO_HOST, now), now)

    def _late(self, way: int, data: bytes, now: float) -> bytes:
        """Return what comes out now: bytes behind a delay wait for its end."""
        held = self._held[way]
        if data:
            held.append((self._until[way], data))
        come = b""
        while held and (held[0][0] <= now or not self._until[way]):
            come += held.popleft()[1]
        return come

    def _spoil(self, data: bytes, way: int, now: float) -> bytes:
        due = {fault.at: fault for fault in self._due if fault.way == way}
        if not (due or self.rate or self._burst[way] or now < self._cut):
            self.passed[way] += len(data)
            return data
        kept = bytearray()
        for byte, number in zip(data, itertools.count(self.passed[way]), strict=False):
            fault = due.get(number) or self._chance(way, number)
            if fault is not None:
                self._count(fault, now)
            if now < self._cut:
                continue
            if self._burst[way]:
                self._burst[way] -= 1
                kept.append(int(self.rng.integers(256)))
            elif fault is None or fault.kind not in {"drop", "flip", "double"}:
                kept.append(byte)
            elif fault.kind == "flip":
                kept.append(byte ^ 1 << int(fault.size))
            elif fault.kind == "double":
                kept += bytes([byte, byte])
        self.passed[way] += len(data)
        return bytes(kept)

    def _chance(self, way: int, number: int) -> Fault | None:
        draw = self.rng.random() / self.rate if self.rate else 1.0
        if draw >= 1.0:
            return None
        if draw < 0.9:
            return Fault(kind=KINDS[int(draw / 0.3)], way=way, at=number, size=float(self.rng.integers(8)))
        return Fault(kind="burst", way=way, at=number, size=float(self.rng.integers(2, 40)))

    def _count(self, fault: Fault, now: float) -> None:
        self.faults += 1
        self.done.append(fault)
        if fault in self._due:
            self._due.remove(fault)
        if fault.kind == "burst":
            self._burst[fault.way] = int(fault.size)
        elif fault.kind == "delay":
            self._until[fault.way] = now + fault.size
        elif fault.kind == "cut":
            self._cut = now + fault.size
