"""Programs of spans by seed: every motor now faster, now slower, now the other way round, now at rest."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.kernels.link import MOTORS, executed
from trochia.kernels.ticks import BACKWARDS, SEGMENT, SegmentRun

if TYPE_CHECKING:
    from numpy.typing import NDArray

CLOCK = 16e6
LEAST = 200  #: from a span's start to a motor's first step [ticks]


@dataclass(frozen=True, slots=True, kw_only=True)
class Kind:
    """How spans are drawn: their lengths [ticks], how fast one motor may step [Hz], how often interval and way change.

    ``stride`` is the least number of steps of one interval; of spans of one motor that are as fast as a chip can be,
    intervals may change only now and then.
    """

    motors: int
    fastest: float
    slowest: float = 300.0
    ticks: tuple[int, int] = (1 << 17, 1 << 19)
    stride: int = 1
    turns: float = 0.2
    rests: float = 0.1


def drawn(rng: np.random.Generator, kind: Kind, count: int, *, slew: int = 3000) -> list[bytes]:
    """Return spans, the last of which ends at rest."""
    spans = sys.modules["steady_spans"]
    back, whole = [False] * kind.motors, []
    for number in range(count):
        ticks, parts = int(rng.integers(*kind.ticks)), {}
        for motor in range(kind.motors):
            back[motor] ^= rng.random() < kind.turns
            if rng.random() >= kind.rests:
                parts[motor] = _part(rng, kind, ticks, back=back[motor])
        parts = {motor: part for motor, part in parts.items() if part is not None}
        power = int(rng.integers(256)) if rng.random() < 0.5 else 0
        last = number == count - 1
        whole.append(spans.span(parts, ticks=ticks, slew=slew, number=number & 0xFFFF, rest=last, power=power))
    return whole


def _part(rng: np.random.Generator, kind: Kind, ticks: int, *, back: bool) -> Any:
    """Return a motor's steps in a span, which end an interval before it does; None where there is no room."""
    low, high = CLOCK / kind.fastest, CLOCK / kind.slowest
    begin, end = np.exp(rng.uniform(np.log(low), np.log(high), 2))
    if rng.random() < 0.3:
        end = begin
    stride = int(rng.integers(kind.stride, max(kind.stride, 64) + 1))
    most = max(int(2.0 * ticks / (begin + end)), 1)
    first = float(rng.uniform(max(LEAST, low), max(LEAST, low) + begin))
    add = int(np.clip((end - begin) * stride / most, -120.0, 120.0) * (1 << 24))
    rows = np.array([(round(begin * 256), add, 0, most, stride, 0)], SEGMENT)
    intervals = SegmentRun().intervals(rows)
    good = int(np.argmax(np.append((intervals < low - 1.0) | (intervals > 4.0 * high), True)))
    at = first + np.concatenate([[0.0], np.cumsum(intervals[:good])])
    steps = int(np.count_nonzero(at < ticks - low))
    if not steps:
        return None
    flags = BACKWARDS if back else 0
    return sys.modules["steady_spans"].part(first, begin, steps, stride=stride, add=add, flags=flags)


def stream_of(steps: list[Any], ticks: list[Any], apart: int) -> NDArray[np.uint8]:
    """Return the stream of pulses: the motors that step at once, a bit each, and those of them that go backwards
    (pulses, 2); `apart` is the time from which on two pulses are not one."""
    motors = np.concatenate([np.full(len(one), 1 << motor) for motor, one in enumerate(steps)])
    back = np.where(np.concatenate(steps) < 0, motors, 0)
    at = np.concatenate(ticks)
    order = at.argsort(kind="stable")
    at = at[order]
    begins = np.flatnonzero(np.diff(at, prepend=-1_000_000) > apart)
    if not len(begins):
        return np.empty((0, 2), np.uint8)
    return np.column_stack([np.bitwise_or.reduceat(bits[order], begins) for bits in (motors, back)]).astype(np.uint8)


@dataclass(frozen=True, slots=True, eq=False)
class Planned:
    """What a host core makes of spans: each motor's steps, +1 or -1, their ticks, and where all ends."""

    steps: list[NDArray[np.int64]]
    ticks: list[NDArray[np.int64]]
    position: NDArray[np.int64]
    stream: int


def planned(spans: list[bytes]) -> Planned:
    """Return what a chip is to make of spans."""
    made = executed(b"".join(spans))
    assert not made.crowded, "the program's steps are too close"
    mine = [made.pulses["pins"] >> motor & 1 == 1 for motor in range(MOTORS)]
    way = [np.where(made.pulses["backwards"][rows] >> motor & 1, -1, 1) for motor, rows in enumerate(mine)]
    return Planned(way, [made.pulses["tick"][rows] for rows in mine], made.position, made.stream)


def at_pins(events: NDArray[Any], steps: tuple[str, ...], ways: tuple[str, ...]) -> tuple[list[Any], list[Any]]:
    """Return each motor's steps at the pins, +1 or -1, and their cycles; directions are 0 where the events begin."""
    pins = events[events["kind"] == 1]
    made, cycles = [], []
    for step, way in zip(steps, ways, strict=True):
        rows, turned = _of(pins, step), _of(pins, way)
        up = rows[rows["value"] == 1]
        row = turned["cycle"].searchsorted(up["cycle"], side="right")
        level = np.append(0, turned["value"])[row]
        made.append(np.where(level, -1, 1))
        cycles.append(up["cycle"].astype(np.int64))
    return made, cycles


def _of(pins: NDArray[Any], name: str) -> NDArray[Any]:
    return pins[(pins["unit"] == name[0].encode()) & (pins["line"] == int(name[1:]))]
