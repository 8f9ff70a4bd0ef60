"""A live backend whose machine has errors that are corrected: the crossing from joints as asked to motors as told.

In: orders of joints as the kinematics give them.  Out: the same to the backend, in places of its motors; and its
reports back.  Whoever orders does not know of it, and every backend behind it is corrected alike.

Backlash that is still being made up where motion ends is made up at rest, behind it: stream time as asked stands still
then, and what is ordered meanwhile begins where the making up has come to.  Legend: outer stream time is that of the
orders, inner the backend's; inner = outer + shift.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, cast

import numpy as np

from trochia.backends.live import Orders, Tapped
from trochia.backends.queue import Queue
from trochia.backends.segments import Segments, joined
from trochia.errors import LocalProtocolError
from trochia.machine.crossing import crossing_of
from trochia.machine.reserve import limits_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from trochia.backends.live import Report, SegmentBackend, Ticks
    from trochia.machine.crossing import Crossing
    from trochia.machine.machine import Machine

ROW = 0.004  #: longest time of a row at rest while backlash is made up [s]
SAME = 1e-9  #: a velocity that is as good as none [mm/s or degree/s]
NOT_YET = 2e-6  #: how far from its end a motion is while its backlash is made up [s]
SAME_PATH = 1e-5  #: what cubics leave of a way [mm or degree]
SAME_SPEED = 1e-3  #: what they leave of a speed, in parts of it
STEEPEST = 1000.0  #: greatest slew [1/s]


def compensated(backend: SegmentBackend) -> SegmentBackend:
    """Return a backend that corrects its machine's errors; the same where there is nothing to correct."""
    crossing = crossing_of(backend.machine)
    if crossing is None:
        return backend
    made = CompensatedTicks(backend, crossing) if isinstance(backend, Tapped) else Compensated(backend, crossing)
    return cast("SegmentBackend", made)  # its kind is that of what moves, and not the class'


class Compensated:
    """A backend behind the corrections of its machine.

    Attributes
    ----------
    inner
        The backend itself.
    """

    def __init__(self, inner: SegmentBackend, crossing: Crossing) -> None:
        self.inner = inner
        self.kind = inner.kind
        self.title = inner.title
        self.machine: Machine = inner.machine
        self.latency, self.ahead = inner.latency, inner.ahead
        joints = self.machine.joints
        self._crossing = crossing
        self._loads = np.array([j.encoder is not None and j.encoder.on_load for j in joints])
        shares = [0.0 if j.compensation is None else j.compensation.share for j in joints]
        self._braking = np.array([0.5 * c * limits_of(self.machine, j).acceleration for j, c in enumerate(shares)])
        self._take_up = crossing.take_up()
        self._asked = Queue(np.zeros(len(joints)))  # by outer stream time
        self._told = Queue(np.zeros(len(joints)))  # what the backend holds, by inner stream time
        self._shift = 0.0
        self._executed = 0.0  # outer
        self._inner = 0.0  # stream time the backend has run through
        self._tail = 0.0  # inner stream time up to which backlash is made up at rest

    # -- what a backend does

    def open(self, now: float) -> Report:
        """Connect, and report."""
        report = self.inner.open(now)
        self._inner = report.executed
        self._executed = report.executed
        self._asked.clear(self._asked_of(report.commanded), self._executed)
        self._told.clear(report.commanded, self._inner)
        return self._outer(report)

    def close(self) -> None:
        """Stop, drives off, disconnect."""
        self.inner.close()

    def poll(self, now: float) -> Report:
        """Report how things stand."""
        return self._outer(self.inner.poll(now))

    def order(self, orders: Orders, now: float) -> None:
        """Take orders; see :class:`trochia.backends.live.SegmentBackend`."""
        if orders.stop or orders.enable is False:
            self._stand(self._here())
        changed = orders
        if orders.place:
            changed = replace(changed, place=self._placed(orders))
        if orders.segments is not None:
            self._asked.add(orders.segments, orders.at, self._executed)
            segments, at = self._crossed(orders.segments, orders.at)
            changed = replace(changed, segments=segments, at=at)
        if orders.timed:
            changed = replace(changed, timed=tuple((t + self._shift, name, value) for t, name, value in orders.timed))
        self.inner.order(changed, now)

    # -- from asked to told

    def _crossed(self, asked: Segments, at: float) -> tuple[Segments, float]:
        """Return segments of the motors and the inner stream time they begin at."""
        start = at + self._shift
        if self._tail > start:  # backlash is being made up at rest, or would be: motion goes on inside that
            begin = min(max(start, self._inner + self.latency), self._tail)
            self._shift += begin - start
            start = begin
        self._take_up.forget(self._inner - 1.0)
        self._take_up.cut(start)
        self._tail = 0.0
        ends = start + np.cumsum(asked.duration)
        times = np.concatenate([[start], ends])
        powers = asked.duration[:, None] ** np.arange(4)
        place = np.concatenate([asked.joints[:, :, 0], asked.end[None, :]])
        last = (asked.joints[-1, :, 1:] * (powers[-1, :3] * [1.0, 2.0, 3.0])).sum(axis=1)
        speed = np.concatenate([asked.joints[:, :, 1], last[None, :]])
        asked_rate = speed @ self._crossing.mix.T
        self._take_up.see(times, asked_rate)
        told = self._rows(asked, times, place, speed, self._state(start))
        if np.all(np.abs(asked.end_velocity) <= SAME) and (rest := self._take_up.left(float(times[-1]))) > 0.0:
            told = joined([told, self._at_rest(told, place[-1], float(times[-1]), rest)])
            self._tail = float(times[-1]) + rest
        self._told.add(told, start, self._inner)
        return told, start

    def _state(self, start: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return where the motors will be at an inner stream time, and how fast: cubics cut there are not exact."""
        sample = self._told.at(np.array([start]))
        return sample.position[0], sample.velocity[0]

    def _rows(
        self, like: Segments, times: NDArray[np.float64], place: NDArray[np.float64], speed: NDArray[np.float64],
        begin: tuple[NDArray[np.float64], NDArray[np.float64]],
    ) -> Segments:  # fmt: skip
        """Return the motors' cubics between times, from places and speeds as asked; ``begin`` is where they are."""
        told = self._crossing.motor(place) + self._take_up.offset(times)
        making_up = self._take_up.rate(times)
        rate = self._crossing.rate(place, speed) + making_up
        if np.all(np.abs(told[0] - begin[0]) <= SAME_PATH):
            told[0] = begin[0]
            rate[0] = np.where(np.abs(rate[0] - begin[1]) <= SAME_SPEED * (1.0 + np.abs(rate[0])), begin[1], rate[0])
        h = np.diff(times)[:, None]
        rise, lag = np.diff(rate, axis=0), np.diff(told, axis=0) / h - rate[:-1]
        joints = np.stack([told[:-1], rate[:-1], (3.0 * lag - rise) / h, (rise - 2.0 * lag) / h**2], axis=-1)
        return Segments(duration=like.duration, joints=joints, line=like.line, power=like.power,
                        slew=np.minimum(like.slew, self._slew(making_up)))  # fmt: skip

    def _slew(self, making_up: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how fast the rate may change in each row so that making up backlash keeps its share (rows,) [1/s]."""
        fastest = np.maximum(np.abs(making_up[:-1]), np.abs(making_up[1:]))
        with np.errstate(divide="ignore", invalid="ignore"):
            most = np.where(fastest > 0.0, self._braking / fastest, STEEPEST)
        return np.minimum(most.min(axis=1), STEEPEST)

    def _at_rest(self, before: Segments, place: NDArray[np.float64], start: float, duration: float) -> Segments:
        """Return rows that make up backlash while nothing else moves."""
        count = int(np.ceil(duration / ROW))
        times = start + duration * np.arange(count + 1) / count
        like = Segments(
            duration=np.diff(times), joints=np.zeros((count, len(place), 4)),
            line=np.full(count, before.line[-1], np.uint32), power=np.zeros(count, np.float32),
            slew=np.full(count, STEEPEST),
        )  # fmt: skip
        places = np.tile(place, (count + 1, 1))
        return self._rows(like, times, places, np.zeros_like(places), (before.end, before.end_velocity))

    def _placed(self, orders: Orders) -> dict[str, float]:
        """Return what motors' places are called when joints' are."""
        if self._asked.end > self._executed + SAME or self._inner < self._tail - SAME:
            raise LocalProtocolError("positions are named at rest only")
        names = [joint.name for joint in self.machine.joints]
        here = self._here()
        for name, value in orders.place.items():
            here[names.index(name)] = value
        told = self._stand(here)
        return dict(zip(names, told.tolist(), strict=True))

    def _stand(self, here: NDArray[np.float64]) -> NDArray[np.float64]:
        """Take joints to be asked to stand here (joints,); return where that is for their motors."""
        told = self._crossing.motor(here[None, :])[0] + self._take_up.offset(np.array([self._inner]))[0]
        self._asked.clear(here, self._executed)
        self._told.clear(told, self._inner)
        self._shift, self._tail = self._inner - self._executed, 0.0
        return told

    # -- from told to asked

    @property
    def _end(self) -> float:
        """Outer stream time that counts as run through, at most: the end, once the backlash is made up."""
        return self._asked.end - (NOT_YET if self._inner < self._tail - SAME else 0.0)

    def _here(self) -> NDArray[np.float64]:
        """Return where joints are asked to be (joints,)."""
        return self._asked.at(np.array([self._executed])).position[0].copy()

    def _asked_of(self, told: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return joints as asked of motors as told (joints,)."""
        return self._crossing.asked(told[None, :] - self._take_up.offset(np.array([self._inner])))[0]

    def _outer(self, report: Report) -> Report:
        """Return the backend's report as whoever orders knows it."""
        self._inner = report.executed
        outer = max(min(report.executed - self._shift, self._end), self._executed)
        self._executed = outer
        self._asked.forget(outer)
        self._told.forget(self._inner)
        sample = self._asked.at(np.array([outer]))
        commanded, velocity = sample.position[0], sample.velocity[0] * report.rate
        if report.still:
            told = self._crossing.motor(commanded[None, :])[0] + self._take_up.offset(np.array([self._inner]))[0]
            if not np.allclose(told, report.commanded, rtol=0.0, atol=SAME_PATH):  # its loops were closed anew
                commanded = self._asked_of(report.commanded)
            self._stand(commanded)
            self._told.clear(report.commanded, self._inner)
            velocity = np.zeros_like(velocity)
        encoder = None if report.encoder is None else self._measured(report.encoder[None, :], self._inner)[0]
        caught = report.caught
        if caught is not None:
            caught = (caught[0], self._asked_of(caught[1]))
        return replace(report, executed=outer, commanded=commanded, velocity=velocity, encoder=encoder, caught=caught)

    def _measured(self, encoder: NDArray[np.float64], *times: float) -> NDArray[np.float64]:
        """Return encoders (n, joints) as joints that were asked; NaN where there is none."""
        known = np.isfinite(encoder)
        offset = self._take_up.offset(np.array(times))
        motors = np.where(known & ~self._loads, encoder - offset, np.where(known, encoder, 0.0))
        return np.where(known, self._crossing.asked(motors, loads=self._loads), np.nan)


class CompensatedTicks(Compensated):
    """The same of a backend that tells of every servo tick.

    Attributes
    ----------
    tap
        Is told of every servo tick, as asked.
    """

    def __init__(self, inner: SegmentBackend, crossing: Crossing) -> None:
        super().__init__(inner, crossing)
        self.tap: Callable[[Ticks], None] | None = None
        assert isinstance(inner, Tapped)
        inner.tap = self._tapped

    def _tapped(self, ticks: Ticks) -> None:
        """Tell who listens of ticks as asked."""
        if self.tap is None:
            return
        outer = np.clip(ticks.executed - self._shift, self._executed, max(self._asked.end - NOT_YET, self._executed))
        sample = self._asked.at(outer)
        rate = np.diff(np.concatenate([[self._executed], outer])) / ticks.period
        self.tap(replace(ticks, executed=outer, commanded=sample.position, velocity=sample.velocity * rate[:, None],
                         encoder=self._measured(ticks.encoder, *ticks.executed.tolist())))  # fmt: skip
        self._executed = float(outer[-1])
