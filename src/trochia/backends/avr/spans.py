"""Spans, as the chip is sent them, from cubics of the joints.

In: rows of a queue by stream time.  Out: span after span, each as long as one tick segment of every motor can follow
the motion, with the steps each motor has made at its start.  Legend: tick = of stream time since the chip's BEGIN.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.backends.avr.powers import Powers
from trochia.errors import LimitError
from trochia.kernels.link import (
    AT_REST,
    FULL_RATE,
    PART,
    PAYLOAD,
    PIXEL,
    PIXELS,
    SET_OUTPUTS,
    SLICE,
    SPAN,
    cubic_steps,
    fit_one,
    pulses,
)  # fmt: skip
from trochia.kernels.ticks import BACKWARDS

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from trochia.backends.queue import Queue

LONGEST = 1 << 20  #: ticks of a span
TOLERANCE = 304.0  #: of a step [ticks]: 19 µs at 16 MHz; with slots and lateness 25
LOOKED = 1 << 20  #: ticks of steps made at once
SHARE = 0.92  #: of the slew its rows allow, at least, a span must allow
BRIEF, LESS = (
    0.016,
    0.5,
)  #: a span this short [s] may allow so much less: many short ones are more than a chip can take up
KEPT = 0.95  #: of the slew is used: the chip's clock is not the host's
CLOSEST = 64  #: two steps of a motor, unless its board needs more [ticks]: 4 µs

_POWERS = np.arange(4)


@dataclass(frozen=True, slots=True, kw_only=True)
class Span:
    """A span: its number, where it begins and ends [ticks], and steps made before it (motors,)."""

    number: int
    start: int
    end: int
    before: NDArray[np.int64]
    payload: bytes


class SpanMaker:
    """Makes spans of a queue.

    Parameters
    ----------
    steps_per_unit
        Of each joint (joints,).
    clock
        Ticks a second [Hz].
    power
        Beam's level, 0 … 255, of a row's power.
    closest
        Two steps of a motor may be [ticks].
    payload
        Of a span, at most [bytes].
    """

    def __init__(
        self, steps_per_unit: NDArray[np.float64], clock: int, power: Callable[[float], int], closest: int = CLOSEST,
        *, payload: int = PAYLOAD,
    ) -> None:  # fmt: skip
        self.clock, self.payload = clock, payload
        self._closest = closest
        self._scale = steps_per_unit
        self._power = power
        self.count = np.zeros(len(steps_per_unit), np.int64)
        self.offset = np.zeros(len(steps_per_unit))
        self.restart(0.0)

    def restart(self, origin: float) -> None:
        """Begin at tick 0, which is stream time ``origin`` [s]; ``count`` says where the motors are."""
        self.origin = origin
        self.at = 0  # where the next span begins
        self.number = 0
        self._looked = 0
        self._ticks = [np.empty(0, np.int64) for _ in self.count]
        self._ways = [np.empty(0, np.int8) for _ in self.count]

    def tick(self, time: float) -> int:
        """Return the tick of a stream time."""
        return round((time - self.origin) * self.clock)

    def time(self, tick: int) -> float:
        """Return the stream time of a tick."""
        return self.origin + tick / self.clock

    def back_to(self, tick: int, number: int, before: NDArray[np.int64]) -> None:
        """Go on from an earlier tick, with these steps made."""
        self.at, self.number = tick, number
        self.count = before.copy()
        self._looked = tick
        self._ticks = [np.empty(0, np.int64) for _ in self.count]
        self._ways = [np.empty(0, np.int8) for _ in self.count]

    def _look(self, queue: Queue, end: int) -> None:
        """Make the steps of the next stretch of the queue, up to ``end``."""
        starts = np.array([self.tick(t) for t in queue.starts], np.float64)
        first = max(int(starts.searchsorted(self._looked, side="right")) - 1, 0)
        last = int(starts.searchsorted(end, side="left"))
        edges = np.append(starts[first:last], min(end, self.tick(queue.end)))
        skip = max(self._looked - edges[0], 0.0)
        unit = (1.0 / self.clock) ** _POWERS
        for j, scale in enumerate(self._scale):
            rows = queue.held.joints[first:last, j] * scale * unit
            rows[:, 0] -= self.offset[j] * scale
            if skip > 0.0:
                rows[0] = _shifted(rows[0], skip)
            at = edges.copy()
            at[0] += skip
            standing = int(self.count[j] + self._ways[j].sum(dtype=np.int64))
            ticks, ways = cubic_steps(rows, at, standing)
            self._ticks[j] = np.concatenate([self._ticks[j], _spaced(ticks, self._looked, self._closest)])
            self._ways[j] = np.concatenate([self._ways[j], ways])
        self._looked = end

    def make(self, queue: Queue, boundaries: list[int], outputs: Callable[[int], int]) -> Span | None:
        """Return the next span, or None where the queue holds no more.

        Parameters
        ----------
        boundaries
            Ticks at which a span must end.
        outputs
            Levels of the outputs from a tick on.

        Raises
        ------
        LimitError
            For steps that are closer than the chip can make them.
        """
        last = self.tick(queue.end)
        if self.at >= last:
            return None
        end = min([last, self.at + LONGEST, *(b for b in boundaries if b > self.at)])
        if self._looked < end:
            self._look(queue, min(last, max(end, self._looked + LOOKED)))
        end, slew, powers = self._uniform(queue, end)
        fitted = [self._fitted(j, end) for j in range(len(self._scale))]
        end = min([end, *(reach for _, _, reach in fitted)])
        head = np.zeros((), SPAN)
        head["number"], head["power"], head["outputs"] = self.number & 0xFFFF, powers.first, outputs(self.at)
        head["slew"] = min(int(KEPT * slew * SLICE / self.clock * FULL_RATE), 0xFFFF)
        head["flags"] = SET_OUTPUTS | (AT_REST if end >= last and queue.ends_at_rest else 0)
        return self._made(head, end, fitted, powers)

    def _uniform(self, queue: Queue, end: int) -> tuple[int, float, Powers]:
        """Return where the slew changes too much or the powers no longer fit in, the slew, and the powers."""
        now = self.time(self.at) + 0.5 / self.clock + 1e-9  # a row begins within half a tick of its tick
        row = max(int(queue.starts.searchsorted(now, side="right")) - 1, 0)
        last = max(int(queue.starts.searchsorted(self.time(end), side="left")), row + 1)
        starts = np.rint((queue.starts[row:last] - self.origin) * self.clock).astype(np.int64)
        slews, lengths = queue.held.slew[row:last], queue.held.duration[row:last]
        least = np.minimum.accumulate(slews)
        reach = np.cumsum(lengths)
        share = np.where(reach <= BRIEF, LESS, SHARE)
        steep = np.flatnonzero(least * reach < share * np.cumsum(lengths * slews))
        rows = int(steep[0]) if steep.size else len(starts)
        end = min(end, int(starts[rows])) if rows < len(starts) else end
        levels = [self._power(power) for power in queue.held.power[row : row + rows].tolist()]
        moving = sum(1 for ticks in self._ticks if ticks.size and ticks[0] < end)
        room = self.payload - SPAN.itemsize - PART.itemsize * moving
        powers = Powers(self.at, levels[0], room // PIXEL.itemsize)
        for at, level in zip(starts[1:rows].tolist(), levels[1:], strict=True):
            if at >= end:
                break
            if not powers.add(at, level):
                end = at
                break
        return end, float(least[rows - 1]), powers

    def _fitted(self, joint: int, end: int) -> tuple[Any, NDArray[np.int64], int]:
        """Return a joint's part, the ticks it makes its steps at, and up to which tick it follows the joint."""
        ticks, ways = self._ticks[joint], self._ways[joint]
        count = int(ticks.searchsorted(end, side="left"))
        if count == 0:
            return None, ticks[:0], end
        turn = int(np.argmax(ways[:count] != ways[0]))
        if turn:
            end, count = int(ticks[turn]), turn
        gaps = np.diff(ticks[:count])
        if gaps.size and gaps.min() < self._closest:
            raise LimitError(
                f"joint {joint}: {self.clock / gaps.min():,.0f} steps/s are more than a motor can be given",
                hint=f"At most {self.clock // self._closest:,} a second: lower the speed or the micro-steps.",
            )
        part, at = fit_one(ticks[:count] - self.at, TOLERANCE)
        part["flags"] |= BACKWARDS if ways[0] < 0 else 0
        return part, at, end if len(at) >= count else int(ticks[len(at)])

    def _made(self, head: Any, end: int, fitted: list[tuple[Any, NDArray[np.int64], int]], powers: Powers) -> Span:  # noqa: ANN401 - a numpy record has no type of its own
        """Return the span up to ``end``, and stand there; parts that would go further are cut."""
        before, parts, latest = self.count.copy(), b"", end
        for j, (part, at, _) in enumerate(fitted):
            count = int(self._ticks[j].searchsorted(end, side="left"))
            if not head["flags"] & AT_REST:  # one that its segment makes a little late is the next span's
                count = min(count, int(at.searchsorted(end - self.at, side="left")))
            if not count:
                continue
            part["count"] = count - 1
            latest = max(latest, self.at + int(at[count - 1]) + 1)
            parts += part.astype(PART).tobytes()
            head["motors"] |= 1 << j
            self.count[j] += int(self._ways[j][0]) * count
            self._ticks[j], self._ways[j] = self._ticks[j][count:], self._ways[j][count:]
        self._ticks = [_spaced(ticks, latest, self._closest) for ticks in self._ticks]
        head["duration"] = latest - self.at
        pixels = powers.until(latest)
        head["flags"] |= PIXELS * len(pixels)
        parts += pixels.tobytes()
        made = Span(number=self.number, start=self.at, end=latest, before=before, payload=head.tobytes() + parts)
        self.at, self.number = latest, self.number + 1
        return made


def _spaced(ticks: NDArray[np.int64], at: int, closest: int) -> NDArray[np.int64]:
    """Return step ticks of which the first few that come too early are put off."""
    few = np.arange(min(len(ticks), 8)) * closest
    first = np.maximum.accumulate(np.maximum(ticks[:8], at) - few) + few
    return np.concatenate([first, ticks[8:]])


def _shifted(c: NDArray[np.float64], by: float) -> NDArray[np.float64]:
    """Return a cubic's coefficients from a later origin."""
    return np.array(
        [c @ by**_POWERS, c[1] + by * (2.0 * c[2] + 3.0 * c[3] * by), c[2] + 3.0 * c[3] * by, c[3]], np.float64
    )


def shortened(span: Span, tick: int) -> Span:
    """Return a span that ends at an earlier tick."""
    head = np.frombuffer(span.payload[: SPAN.itemsize], SPAN)[0].copy()
    head["duration"] = tick - span.start
    head["flags"] &= ~AT_REST & 255
    payload = head.tobytes() + span.payload[SPAN.itemsize :]
    return Span(number=span.number, start=span.start, end=tick, before=span.before, payload=payload)


def steps_made(span: Span) -> NDArray[np.int64]:
    """Return the steps each motor makes in a span (motors,), signed."""
    steps = np.zeros(len(span.before), np.int64)
    made = pulses(span.payload)
    made = made[made["tick"] < span.end - span.start]
    for j in range(len(steps)):
        mine = made["pins"] >> j & 1 == 1
        steps[j] = int(np.where(made["backwards"][mine] >> j & 1, -1, 1).sum())
    return steps
