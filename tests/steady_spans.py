"""Spans as a chip is sent them, for tests: motors that keep a rate."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.kernels.link import AT_REST, PART, PIXEL, PIXELS, SPAN

if TYPE_CHECKING:
    from numpy.typing import NDArray

SLOT = 128
SPAN_TICKS = 1 << 17


def part(first: float, interval: float, count: int, *, stride: int = 16, add: int = 0, flags: int = 0) -> Any:
    made = np.zeros((), PART)
    made["first"], made["interval"] = round(first * 256), round(interval * 256)
    made["add"], made["count"], made["stride"], made["flags"] = add, count - 1, stride, flags
    return made


def span(
    parts: dict[int, Any],
    *,
    ticks: int = SPAN_TICKS,
    slew: int = 1000,
    number: int = 0,
    rest: bool = True,
    power: int = 0,
    pixels: tuple[tuple[int, int], ...] = (),
) -> bytes:
    head = np.zeros((), SPAN)
    head["duration"], head["slew"], head["number"], head["flags"] = ticks, slew, number, AT_REST * rest
    head["power"] = power
    head["flags"] |= PIXELS * len(pixels)
    for motor in parts:
        head["motors"] |= 1 << motor
    light = np.array(list(pixels), PIXEL).tobytes()
    return head.tobytes() + b"".join(parts[motor].tobytes() for motor in sorted(parts)) + light


def steady(
    rates: list[float],
    spans: int = 4,
    *,
    slew: int = 1000,
    stride: int = 16,
    rest: bool = True,
    ticks: int = SPAN_TICKS,
    power: int = 0,
) -> list[bytes]:
    """Return spans in which each motor keeps a rate [Hz], from its first interval on."""
    whole, intervals = [], [round(16e6 / rate * 256) for rate in rates]
    due = list(intervals)
    for number in range(spans):
        parts = {}
        for motor, interval in enumerate(intervals):
            count = max((ticks * 256 - 1 - due[motor]) // interval + 1, 0)
            if count:
                parts[motor] = part(due[motor] / 256, interval / 256, count, stride=stride)
            due[motor] += count * interval - ticks * 256
        last = rest and number == spans - 1
        whole.append(span(parts, slew=slew, number=number, rest=last, ticks=ticks, power=power))
    return whole


def due_ticks(rate: float, until: int) -> NDArray[np.int64]:
    """The stream tick of every step of `steady` before one."""
    interval = round(16e6 / rate * 256)
    return np.arange(interval, until * 256, interval, dtype=np.int64) // 256
