"""From a live plan to what a backend holds: segments ahead of it, and a stop in hand.

In: a LivePlan, what the backend has run through.  Out: the next segments.  Plan time stands still while motion rests in
a hold, so that stream time is plan time plus one constant for the whole motion.

Segments are sent until a time ahead is covered and the backend could stop by itself inside what it holds: with a row's
slew s, d(r²/2)/du = -s brings the rate r from 1 to 0 over rows whose ∫ s du is a half.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from trochia.backends.segments import Segments, joined

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from trochia.machine.machine import Machine
    from trochia.planner.live import LivePlan, Portion

ROW = 0.004  #: longest time of a row [s]
ASTRAY = 2.5e-7  #: greatest distance of a row from the plan [mm or degree]
DONE = 1e-6  #: a motion is at its end that near [s]
CHUNK = 0.05  #: motion sent at a time [s]
SOON = 0.2  #: motion that is sent at once, where the backend wants as much [s]
SPARE = 2  #: chunks beyond that in one call
STOP = 0.6  #: ∫ s du that is kept ahead; a half stops from rate 1
KEPT = 60.0  #: motion behind that stays in hand, for run-ups [s]
FORGET = 10.0  #: between looks at what may go [s]
STEEPEST = 1000.0  #: greatest slew [1/s]: at rest any would do
_INSIDE = np.array([0.02, 0.5, 0.98])  #: where in a row its slew is looked at


class Feeder:
    """Sends one live plan.

    Parameters
    ----------
    origin
        Stream time of plan time 0 [s].
    ahead
        Motion the backend wants to hold [s].
    power
        Factor (times,) of the beam's power at times of a portion; None: 1.

    Attributes
    ----------
    sent
        Plan time up to which segments were given out [s].
    """

    def __init__(
        self, live: LivePlan, machine: Machine, *, origin: float, ahead: float,
        power: Callable[[Portion, NDArray[np.float64]], NDArray[np.float32]] | None = None,
    ) -> None:  # fmt: skip
        self.live = live
        self.origin = origin
        self.sent = 0.0
        self.until = math.inf  # plan time beyond which nothing is sent: a pause
        self.lit_from = math.inf  # plan time at which the beam relights: a row begins there
        self.dark_until = 0.0  # plan time up to which the plan may keep the beam dark: holds and ways back
        self._matrix = machine.kinematics.matrix
        self._limits = live.rules.limits
        self._ahead = ahead
        self._power = power
        self._forgotten = 0.0  # plan time before which motion is not in hand any more
        self._stale = False  # whether the backend holds motion that is planned no more
        self._stops: list[tuple[float, float]] = []  # (plan time at a row's end, its ∫ s du)

    def plan_time(self, executed: float) -> float:
        """Return the plan time of a stream time [s]."""
        return executed - self.origin

    @property
    def end(self) -> float:
        """Plan time at which motion ends, rests in a hold, or pauses [s]; infinite while that is not planned yet."""
        end = self.live.end
        return min(self.until, math.inf if end is None else end)

    def done(self, executed: float) -> bool:
        """Whether all that there is to send has been run through."""
        return self.sent >= self.end - 1e-12 and self.plan_time(executed) >= self.end - DONE

    def more(
        self, executed: float, until: Callable[[list[Portion]], float | None]
    ) -> Iterator[tuple[Segments, float, list[Portion]]]:
        """Yield what is to be sent now: segments, the stream time they begin at, and the portions they were made of.

        ``until`` looks at portions first and may say at which plan time they must end.
        """
        now = self.plan_time(executed)
        self._stops = [stop for stop in self._stops if stop[0] > now]
        if now - KEPT > self._forgotten + FORGET:
            self._forgotten = now - KEPT
            self.live.forget(self._forgotten)
        spare = SPARE
        while self.sent < self.end - 1e-12 and not self._enough(now):
            if self.sent - now >= SOON and self._can_stop:
                spare -= 1
                if spare < 0:
                    return  # the rest of a deep queue is filled turn by turn
            begin, end = self.sent, min(self.sent + CHUNK, self.end)
            end = self.lit_from if begin < self.lit_from < end else end
            portions = self._portions(begin, end)
            stop = until(portions)
            if stop is not None:
                portions = self._portions(begin, stop) if stop > begin + 1e-12 else []
                end = stop
            parts = [self._rows(part) for part in portions]
            if not parts:
                self.sent = end
                continue
            segments = joined(parts)
            self.sent, self._stale = portions[-1].end, False
            ends = begin + np.cumsum(segments.duration)
            self._stops += zip(ends.tolist(), (segments.slew * segments.duration).tolist(), strict=True)
            yield segments, self.origin + begin, portions
        if self._stale and self.sent >= self.end - 1e-12:
            self._stale = False
            yield self._rest(self.sent), self.origin + self.sent, []

    def _portions(self, begin: float, end: float) -> list[Portion]:
        return [part for part in self.live.portions(begin, end) if len(part.phases)]

    def soonest(self, executed: float, latency: float) -> float:
        """Return the plan time from which an order given now can act [s]."""
        return min(self.plan_time(executed) + latency, self.sent)

    def brake(self, executed: float, latency: float) -> float:
        """Brake along the path as soon as an order can act; return the plan time at which that begins [s]."""
        at = self.soonest(executed, latency)
        self.live.hold(at)
        self.replan(at)
        return at

    def replan(self, at: float) -> None:
        """Note that the plan has changed from plan time ``at`` on: what was sent beyond is to be sent anew."""
        self._stale = self._stale or self.sent > at
        self.sent = min(self.sent, at)
        self._stops = [stop for stop in self._stops if stop[0] <= at]

    def _rest(self, at: float) -> Segments:
        """Return a row at rest: what was sent beyond a time must go also where nothing moves from there on."""
        here = self.live.state(at)
        joints = np.zeros((1, len(self._matrix), 4))
        joints[0, :, 0] = self._matrix @ here.position
        return Segments(duration=np.array([ROW]), joints=joints, line=np.array([here.line], np.uint32),
                        power=np.zeros(1, np.float32), slew=np.array([STEEPEST]))  # fmt: skip

    def _enough(self, now: float) -> bool:
        return self.sent - now >= self._ahead and self._can_stop

    @property
    def _can_stop(self) -> bool:
        """Whether the backend could stop by itself in what it holds."""
        return sum(stop for _, stop in self._stops) >= STOP

    def _cuts(self, part: Portion) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return beginnings and durations of rows [s]: cut where jerk changes, every ROW, and where they stray.

        A row is the cubic through its ends; in a bend the plan leaves it by its fourth derivative times h^4 / 384.
        """
        starts, durations = part.phases["t"], part.phases["duration"]
        counts = np.maximum(np.ceil(durations / ROW - 1e-9), 1).astype(np.intp)
        begin, h = _evenly(starts, durations, counts)
        ends = np.append(begin, part.end)
        place, speed = part.derivative(ends, 0), part.derivative(ends, 1)
        middle = 0.5 * (place[1:] + place[:-1]) - 0.125 * h[:, None] * (speed[1:] - speed[:-1])
        astray = np.abs((part.derivative(begin + 0.5 * h, 0) - middle) @ self._matrix.T).max(axis=1)
        if astray.max() <= ASTRAY:
            return begin, h
        worst = np.maximum.reduceat(astray, np.cumsum(counts) - counts)
        return _evenly(starts, durations, counts * np.ceil(np.maximum(worst / ASTRAY, 1.0) ** 0.25).astype(np.intp))

    def _rows(self, part: Portion) -> Segments:
        """Return a portion as segments."""
        begin, h = self._cuts(part)
        times = np.append(begin, part.end)
        place = part.derivative(times, 0) @ self._matrix.T
        speed = part.derivative(times, 1) @ self._matrix.T
        chord = (place[1:] - place[:-1]) / h[:, None]
        rise, lag = speed[1:] - speed[:-1], chord - speed[:-1]
        joints = np.stack(
            [place[:-1], speed[:-1], (3.0 * lag - rise) / h[:, None], (rise - 2.0 * lag) / h[:, None] ** 2], axis=-1
        )
        middle = begin + 0.5 * h
        power = part.power_at(middle).astype(np.float32)
        if self.dark_until > part.begin and power.any():
            power = np.array([self.live.state(t).power for t in middle.tolist()], np.float32)
        if self._power is not None and power.any():
            power = power * self._power(part, middle)
        return Segments(
            duration=h, joints=joints, line=part.line_at(middle).astype(np.uint32), power=power,
            slew=self._slew(part, begin, h),
        )  # fmt: skip

    def _slew(self, part: Portion, begin: NDArray[np.float64], h: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how fast the rate may fall in each row so that every acceleration stays within its limit.

        At rate r a quantity accelerates by a r² - v s: where it is being braked already, less is left for s.
        """
        times = (begin[:, None] + h[:, None] * _INSIDE).ravel()
        limits = self._limits
        v = part.derivative(times, 1) @ limits.matrix.T
        a = part.derivative(times, 2) @ limits.matrix.T
        most = limits.acceleration_at(np.abs(v))
        room = np.where(v * a < 0.0, most - np.abs(a), most)
        with np.errstate(divide="ignore", invalid="ignore"):
            slew = np.where(np.abs(v) > 1e-9, np.maximum(room, 0.0) / np.abs(v), STEEPEST)
        return np.minimum(slew.min(axis=1).reshape(len(h), -1).min(axis=1), STEEPEST)


def _evenly(
    starts: NDArray[np.float64], durations: NDArray[np.float64], counts: NDArray[np.intp]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return beginnings and durations of phases cut into so many rows each [s]."""
    phase = np.repeat(np.arange(len(counts)), counts)
    within = np.arange(len(phase)) - np.repeat(np.cumsum(counts) - counts, counts)
    h = durations[phase] / counts[phase]
    return starts[phase] + within * h, h
