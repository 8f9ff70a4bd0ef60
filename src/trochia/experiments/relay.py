"""A relay in place of a controller: the axis swings, and tells its ultimate gain.

In: an axis, the size of the relay.  Out: :class:`Relayed`.

The describing function Ku = 4 d / (pi sqrt(a² - e²)) (Astrom and Hagglund 1984; d relay, a swing, e hysteresis) takes
the swing for a sine and the gain where the loop lags by hysteresis and a tick's delay: on an axis with little phase to
spare it is some 20 % low.  Here neither is taken: G is the ratio of the fundamentals of what was measured and what
was commanded, over whole swings, whatever the relay's shape; and the relay switches ahead of the zero by an angle that
is led to where the phase of G is -180 degrees, so that Ku = 1 / |G| is read there and not beside it.  Offset, and
friction that differs by direction, are taken away by a bias that makes both halves of a swing last alike.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from trochia.analysis.identification.estimate import Number
from trochia.analysis.tuning.models import Ultimate
from trochia.errors import LimitError, RecordingError
from trochia.experiments.perform import powered
from trochia.servo.axis import Loop

if TYPE_CHECKING:
    from trochia.experiments.protocol import AxisUnderTest, Bounds

_SKIPPED = 4  # swings before it is even
_PATIENCE = 20  # times two swings more
_EVEN = 0.005  # change of size and time within two swings
_ALIKE = 0.05  # how much the last swings may differ
_FEWEST = 3  # swings for a spread
_TRIES = 8  # angles
_NEAR = math.radians(0.3)  # of -180 degrees
_FAR = math.radians(5.0)  # of it, from where no line leads there
_MOST_LEAD = 0.9  # of the swing, at which it may switch
_TURN = math.radians(12.0)  # the greatest change of the angle from try to try


class Relayed(NamedTuple):
    """Ultimate gain and period, each with the scatter of its swings; the amplitude; the bias that was needed."""

    gain: Number
    time: Number
    amplitude: float
    bias: float

    @property
    def ultimate(self) -> Ultimate:
        """What tuning rules take."""
        return Ultimate(gain=self.gain.value, time=self.time.value)


class Seen(NamedTuple):
    """Of one angle: phase of G above -180 degrees [rad], logarithms of gain and period, and the scatter of each."""

    phase: float
    gain: float
    time: float
    phase_sigma: float
    gain_sigma: float
    time_sigma: float


def relay(
    axis: AxisUnderTest, bounds: Bounds, *, size: float, hysteresis: float, swings: int = 12, most_time: float = 60.0
) -> Relayed:
    """Return the ultimate gain of command to position.

    Parameters
    ----------
    size
        Command of the relay.
    hysteresis
        Error at which it switches: above the encoder's count, so that noise does not switch it.
    most_time
        Of the whole [s].

    Raises
    ------
    LimitError
        Before it moves where the relay is more than the bounds allow; while it moves where they are left.
    RecordingError
        When it does not swing evenly, or its phase does not come to -180 degrees.
    """
    bounds.refuse(np.array([[axis.position, 0.0, 0.0]]), np.array([size]))
    least = 2.0 / axis.counts if axis.counts else 0.0
    if hysteresis < least:
        raise LimitError(f"a hysteresis of {hysteresis:.3g} is less than two counts ({least:.3g})",
                         hint="Nothing has moved.  Give a wider one.")  # fmt: skip
    swing = _Swing(axis, bounds, size, hysteresis, round(most_time / axis.period))
    with powered(axis, Loop(period=axis.period)):
        swing.settle()
        seen = [swing.look(swings)]
        angle, before = 0.0, 0.0
        while abs(seen[-1].phase) > _NEAR and len(seen) < _TRIES:
            slope = -1.0
            if len(seen) > 1 and abs(angle - before) > 1e-9:
                slope = min((seen[-1].phase - seen[-2].phase) / (angle - before), -0.2)
            turn = max(-_TURN, min(_TURN, -seen[-1].phase / slope))
            before, angle = angle, max(-math.pi / 3, min(angle + turn, math.asin(_MOST_LEAD)))
            swing.lead = math.sin(angle)
            swing.settle()
            seen.append(swing.look(swings))
    return _at_half_a_turn(seen, swing)


class _Swing:
    """The relay at work; ``lead`` is the part of the swing ahead of its zero at which it switches."""

    def __init__(self, axis: AxisUnderTest, bounds: Bounds, size: float, hysteresis: float, most_ticks: int) -> None:
        self._axis, self._bounds, self._size, self._hysteresis = axis, bounds, size, hysteresis
        self._here = np.array([[axis.position, 0.0, 0.0]])
        self._left = most_ticks
        self._sign, self._armed, self._extreme = 1.0, True, 0.0
        self._rows: list[tuple[float, float]] = []  # command and measured, a tick each
        self._switched: list[int] = []  # ticks at which the relay turned upwards again
        self._halves: list[int] = []
        self._extremes: list[float] = []
        self.lead, self.bias = 0.0, 0.0

    @property
    def amplitude(self) -> float:
        """Of the last swings."""
        return float(np.mean(self._extremes[-6:]))

    def run(self, swings: int) -> None:
        """Let it swing so many times more."""
        end = len(self._switched) + swings
        while len(self._switched) < end:
            if self._left == 0:
                raise RecordingError(f"only {len(self._switched)} swings were seen",
                                     hint="Give a stronger relay, a smaller hysteresis, or more time.")  # fmt: skip
            self._tick()

    def settle(self) -> None:
        """Let it swing until it is even, or long enough: on an axis with little friction that takes its time."""
        self.run(_SKIPPED)
        for _ in range(_PATIENCE):
            self.run(2)
            sizes, ends = np.array(self._extremes[-8:]), np.array(self._switched[-5:])
            change = abs(sizes[4:].mean() / sizes[:4].mean() - 1.0)
            longer = abs((ends[4] - ends[2]) - (ends[2] - ends[0])) - 1.0  # a tick is no change
            if change < _EVEN and longer < _EVEN * (ends[4] - ends[2]):
                return

    def _tick(self) -> None:
        most = self._bounds.command
        command = max(-most, min(most, self._sign * self._size + self.bias))
        samples = self._axis.advance(self._here, np.array([command]))
        self._bounds.watch(samples)
        self._left -= 1
        self._rows.append((command, float(samples.measured[0])))
        error = self._sign * (float(self._here[0, 0]) - self._axis.position)
        self._armed |= error > 0.0
        self._extreme = max(self._extreme, error)
        # a relay that waits (lead below 0) waits for the zero's other side
        level = self.lead * (self._extreme + self._hysteresis) - self._hysteresis
        if self._armed and error < level:
            self._turn()

    def _turn(self) -> None:
        now = len(self._rows)
        self._extremes.append(self._extreme)
        self._halves.append(now)
        self._sign, self._armed, self._extreme = -self._sign, False, 0.0
        if self._sign > 0.0:
            self._switched.append(now)
            if len(self._halves) > 3:
                down, up = self._halves[-2] - self._halves[-3], self._halves[-1] - self._halves[-2]
                # the half that ends here was pushed down: were it the longer, the push has to be less
                self.bias -= 0.2 * self._size * (up - down) / (up + down)

    def look(self, swings: int) -> Seen:
        """Let it swing so many times more, and return what they tell.

        Raises
        ------
        RecordingError
            When they are not even.
        """
        begin = len(self._switched) - 1
        self.run(max(swings, _FEWEST))
        edges = self._switched[begin:]
        times = np.diff(edges) * self._axis.period
        if np.std(times[-_FEWEST:]) > max(_ALIKE * float(np.mean(times)), self._axis.period):
            raise RecordingError("the axis does not swing evenly",
                                 hint="Give a stronger relay, or a wider hysteresis.")  # fmt: skip
        each = np.array([_ratio(np.array(self._rows[a:b]), 1) for a, b in pairwise(edges)])
        whole, many = _ratio(np.array(self._rows[edges[0] : edges[-1]]), len(each)), math.sqrt(len(each))
        return Seen(
            float(np.angle(-whole)), -math.log(abs(whole)), math.log(float(times.mean())),
            float(np.std(np.angle(each / whole), ddof=1)) / many,
            float(np.std(np.abs(each), ddof=1)) / abs(whole) / many,
            float(np.std(times, ddof=1)) / float(times.mean()) / many,
        )  # fmt: skip


def _ratio(rows: np.ndarray, swings: int) -> complex:
    """Return measured by command at the fundamental of so many swings (ticks, 2), a drift taken off."""
    n = np.arange(len(rows))
    turn = np.exp(-2j * np.pi * swings * n / len(rows))
    drift = np.polyfit(n, rows[:, 1], 1) if swings > 1 else np.array([0.0, rows[:, 1].mean()])
    return complex(turn @ (rows[:, 1] - np.polyval(drift, n))) / complex(turn @ (rows[:, 0] - rows[:, 0].mean()))


def _at_half_a_turn(seen: list[Seen], swing: _Swing) -> Relayed:
    """Return gain and period where the phase is -180 degrees, on the line through the looks, nearer ones first."""
    nearest = min(seen, key=lambda look: abs(look.phase))
    if abs(nearest.phase) > _FAR:
        raise RecordingError(f"the phase of the axis comes to {math.degrees(nearest.phase):+.0f}° of -180° only",
                             hint="It may have no ultimate gain: take shaping, or a model.")  # fmt: skip
    phase, gain, time = (np.array([getattr(look, name) for look in seen]) for name in ("phase", "gain", "time"))
    weight = 1.0 / np.hypot(phase, _FAR)
    lines = [np.polyfit(phase, values, 1, w=weight) if np.ptp(phase) > _NEAR else np.array([0.0, values[-1]])
             for values in (gain, time)]  # fmt: skip
    numbers = [
        Number(math.exp(at), math.exp(at) * math.hypot(sigma, slope * nearest.phase_sigma), unit)
        for (slope, at), sigma, unit in zip(lines, (nearest.gain_sigma, nearest.time_sigma), ("", "s"), strict=True)
    ]
    return Relayed(numbers[0], numbers[1], swing.amplitude, swing.bias)
