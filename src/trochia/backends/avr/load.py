"""What spans ask of a board's processor, and whether it is more than it has.

In: spans, one after the other.  Out: for each stretch of a few thousandths of a second the part of the processor's time
it takes.  The costs are measured: the table is what ``benchmarks/load_on_chip.py`` prints, and
``tests/firmware/test_load.py`` holds the image to it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from trochia.backends.avr.supply import Supply
from trochia.kernels.link import PART, PIXELS, SLOT, SPAN
from trochia.pulses.steps import CLOCK

if TYPE_CHECKING:
    from trochia.backends.avr.spans import Span


class Cost(NamedTuple):
    """Cycles: a step, a bend of an interval (one every ``stride`` steps), a span taken up with all its motors."""

    step: float
    bend: float
    span: float


_UNO = (
    Cost(60, 812, 12_580), Cost(149, 233, 13_407),
    Cost(123, 267, 20_583), Cost(138, 250, 26_798), Cost(200, 265, 35_619),
)  # fmt: skip
#: by board: one motor in runs of one interval; one whose interval bends often; two motors that share the grid, three …
#: The Uno's are measured, but that a step of four motors takes 140 cycles at full rate, and more while it brakes.  The
#: Mega's, measured up to three motors, are the Uno's and three tenths, which is more; five and six go by what can be
#: held.  The shield's step is what docs/reference/boards.md says, at worst.
COSTS: dict[str, tuple[Cost, ...]] = {
    "uno-stepdir": _UNO,
    "mega-stepdir": tuple(
        Cost(*(1.3 * value for value in cost)) for cost in (*_UNO, Cost(270, 265, 43_500), Cost(350, 265, 51_000))
    ),
    "uno-l293d": (Cost(450, 841, 15_000), Cost(450, 308, 15_000), Cost(450, 308, 20_000)),
}
PIXEL = 900.0  #: a change of the beam's power [cycles]
FULL = 0.97  #: of the processor's time
BENT = 8  #: a stride below it bends often
CLOSE = 160  #: ticks: one motor that is faster runs all the same
LEAD = 1 << 16  #: ticks over which figures are told
_NEAR = 0.005  #: how exactly it is told how much faster spans could be
BEHIND = 1 << 15  #: ticks by which it may fall behind: it works half as far again ahead


class Asked(NamedTuple):
    """What one span asks: cycles, motors, steps, and the busiest motor's part of the slots (1: one in each)."""

    cycles: float
    motors: int
    steps: int
    slots: float


def asked(span: Span, costs: tuple[Cost, ...]) -> Asked:
    """Return what a span asks of a processor with these costs."""
    head = np.frombuffer(span.payload, SPAN, 1)[0]
    motors, ticks = int(head["motors"]).bit_count(), span.end - span.start
    pixels = PIXEL * (int(head["flags"]) // PIXELS)
    if not motors:
        return Asked(costs[0].span + pixels, 0, 0, 0.0)
    parts = np.frombuffer(span.payload, PART, motors, SPAN.itemsize)
    counts = parts["count"].astype(np.int64) + 1
    bent = motors == 1 and int(parts["stride"][0]) < BENT and ticks > CLOSE * int(counts[0])
    cost = costs[min(int(bent) if motors < 2 else motors, len(costs) - 1)]
    steps = int(counts.sum())
    bends = float((counts / np.maximum(parts["stride"], 1)).sum())
    cycles = cost.step * steps + cost.bend * bends + cost.span + pixels
    busy = (int(counts.max()) - BENT) * SLOT / ticks if motors > 1 else 0.0  # a few may be late
    return Asked(cycles, motors, steps, busy)


@dataclass(frozen=True, slots=True, kw_only=True)
class Excess:
    """More than a board has, at a time of the motion.

    Attributes
    ----------
    kind
        ``processor``, ``slots``, ``line`` or ``queue``.
    at
        Tick of stream time.
    part
        Of what it has; above 1.
    motors
        That step there.
    rate
        Steps of all of them [Hz].
    spans
        A second [Hz].
    """

    kind: str
    at: int
    part: float
    motors: int
    rate: float
    spans: float


def faster(spans: list[tuple[float, int, bool]], behind: float, most: float) -> float:
    """Return how many times as fast, ``most`` at most, those of some spans can be run through that a feed rules.

    Spans are given by their cycles, ticks, and whether it does.
    """

    def keeps_up(factor: float) -> bool:
        late = behind
        for cycles, ticks, feed in spans:
            late = max(late + cycles / FULL - (ticks / factor if feed else ticks), 0.0)
            if late > BEHIND:
                return False
        return True

    low, high = 0.0, most
    if keeps_up(most):
        return most
    while high - low > _NEAR:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if keeps_up(middle) else (low, middle)
    return low


class Load:
    """Judges spans as they come.

    Parameters
    ----------
    board
        A name of :data:`COSTS`.
    baud
        Of the line.

    Attributes
    ----------
    worst, first
        The greatest and the first excess of each kind.
    busiest
        Greatest part of the processor's time that a stretch has asked for.
    behind
        What is still to be done when its time has come [cycles].
    count, steps
        Of spans, and of steps of all motors, so far.
    """

    def __init__(self, board: str, baud: int) -> None:
        self.worst: dict[str, Excess] = {}
        self.first: dict[str, Excess] = {}
        self.busiest = 0.0
        self.count = self.steps = 0
        self._costs = COSTS[board]
        self.behind = 0.0
        self._supply = Supply(board, baud)
        self._recent: list[tuple[Span, Asked]] = []  # the last LEAD ticks

    def add(self, span: Span) -> Asked:
        """Take the next span; return what it asks."""
        one = asked(span, self._costs)
        self.count, self.steps = self.count + 1, self.steps + one.steps
        self._recent.append((span, one))
        while len(self._recent) > 1 and span.end - self._recent[1][0].start >= LEAD:
            del self._recent[0]
        ticks = max(span.end - self._recent[0][0].start, LEAD)
        part = sum(each.cycles for _, each in self._recent) / ticks
        self.busiest = max(self.busiest, part)
        self.behind = max(self.behind + one.cycles / FULL - (span.end - span.start), 0.0)
        if self.behind > BEHIND:
            self._note("processor", span.start, max(part / FULL, 1.01))
        self._note("slots", span.start, one.slots)
        self._note(*self._supply.add(span))
        return one

    def _note(self, kind: str, at: int, part: float) -> None:
        """Note an excess, if it is one."""
        if part <= 1.0:
            return
        ticks = self._recent[-1][0].end - self._recent[0][0].start
        excess = Excess(
            kind=kind, at=at, part=part, motors=max(one.motors for _, one in self._recent),
            rate=sum(one.steps for _, one in self._recent) * CLOCK / ticks, spans=len(self._recent) * CLOCK / ticks,
        )  # fmt: skip
        self.first.setdefault(kind, excess)
        if kind not in self.worst or part > self.worst[kind].part:
            self.worst[kind] = excess
