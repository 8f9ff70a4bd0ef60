"""Hold, resume and abort at random instants of a program, in virtual time, on the twin.

    python tests/soak/holds.py --count 10000 --seed 1

Case N is made from seed N alone: a program, a machine, an instant, whether the job is held and resumed or aborted,
sometimes held again or gone back along the path on the way.  The job is not run from its start but entered shortly
before the instant: plan, stream time, joints and outputs as they would be then.  What must hold:

- every tick's commanded place is on the commanded path (1 µm), which itself keeps the blending tolerance;
- no axis exceeds velocity, acceleration or jerk, by the plan's own arithmetic at 9 instants of each phase;
- the beam is off from the first servo tick after the order on, until it relights where it went out: within the way of
  two ticks; motion then is as fast as it was;
- no beam on a way back;
- motion rests in the hold; after a resume it ends where the program ends, to the last bit but rounding (1e-9).

Exit code 1: a case failed; each is told with its seed.
"""

from __future__ import annotations

import argparse
import copy
import dataclasses
import sys
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from trochia.backends.live_twin import LiveTwin
from trochia.backends.switches import switches_of
from trochia.controller.feeder import DONE
from trochia.controller.job import Job, Options
from trochia.controller.readying import Readier
from trochia.controller.runtime import PERIOD, Runtime
from trochia.controller.states import State
from trochia.machine.load import load
from trochia.messages import command as c
from trochia.planner.live import LivePlan
from trochia.program import WorkState

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.controller.readying import Ready

PROGRAMS = Path(__file__).parents[2] / "programs"
CASES = (("hatch", "xy-table"), ("contour", "xy-table"), ("hatch", "laser"), ("contour", "laser"))
PLACES = {"xy-table": {"X": -40.0, "Y": -40.0}}
LEAD = 0.05  #: how long before the instant the job is entered [s]
NEAR = 1e-3  #: greatest distance from the commanded path [mm]
OVER = 1e-6  #: of a limit
LATEST = 60.0  #: longest time a case may take [s of the machine]
WHOLE = 20  #: one case in so many is planned to its end, and its end compared
BACK = 0.3  #: part of the cases to be resumed that go back along the path first
PHYSICS = 10  #: one case in so many has servos that are physics; the others' are ideal: what is commanded is the same


class Ground(NamedTuple):
    """What all cases of one program share."""

    made: Ready
    live: LivePlan
    path: NDArray[np.float64]
    times: NDArray[np.float64]
    end: NDArray[np.float64]


def ground(program: str, machine: str) -> Ground:
    """Return a program planned for a machine, with its path as points 0.25 ms apart."""
    made_for = load(machine)
    work = WorkState().placed(**PLACES.get(machine, {}))
    text = (PROGRAMS / f"{program}.ngc").read_text()
    made = Readier(made_for).ready(text, program, work=work, at={a.name: 0.0 for a in made_for.axes})
    motion = made.plan.trajectory
    times = np.arange(0.0, motion.duration, 2.5e-4)
    return Ground(made, LivePlan.of(motion, made_for), motion.position(times), times,
                  motion.position(np.array([motion.duration]))[0])  # fmt: skip


def cloned(live: LivePlan) -> LivePlan:
    """Return a copy of a live plan that can be told something else."""
    twin = copy.copy(live)
    twin._legs = [dataclasses.replace(leg, ahead=copy.copy(leg.ahead)) for leg in live._legs]
    return twin


class Ideal:
    """A plant whose loads are where they are told to be, for what looks at commands only."""

    restless = False

    def __init__(self, position: NDArray[np.float64]) -> None:
        self.motor = self.load = position.copy()
        self.lag = np.zeros(len(position))

    def follow(self, commanded: NDArray[np.float64]) -> NDArray[np.float64]:
        """Be there."""
        self.motor = self.load = commanded[-1].copy()
        return commanded

    def rejoin(self, commanded: NDArray[np.float64]) -> NDArray[np.float64]:
        """Be where it is."""
        return commanded

    def encoder(self) -> NDArray[np.float64]:
        """Return the truth."""
        return self.load

    def real(self, loads: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the same: nothing errs."""
        return loads


class Bench:
    """A job entered in its middle.

    ``ticks`` has time, place and beam of every tick in the turn after an order and where the beam is to relight, of the
    last tick of a turn elsewhere.
    """

    def __init__(self, base: Ground, begin: float, *, ideal: bool = False) -> None:
        machine = base.made.plan.machine
        self.base, self.machine = base, machine
        for _ in base.live.portions(max(begin - 1.0, 0.0), begin + 1.0):
            pass  # the shared plan reaches as far as a job's would
        job = Job(base.made.plan, machine, Options(), origin=0.0, ahead=0.2)
        job.feeder.live, job.feeder.sent = cloned(base.live), begin
        moves = base.made.plan.path.segments["move"][job.feeder.live._leg(begin).ahead.state(begin)["segment"]]
        job._next = sum(action.at <= moves for action in base.made.plan.program.actions)
        at = machine.kinematics.matrix @ base.live.state(begin).position
        self.twin = LiveTwin(machine, position=at, switches=switches_of(machine))
        if ideal:
            self.twin.plant = Ideal(at)  # type: ignore[assignment]
        self.twin._offset = np.zeros(len(machine.joints))
        self.twin._executor.queue.rest = at.copy()
        self.twin._executor.executed = begin
        self.twin._executor.queue.start = self.twin._executor.queue.end = begin
        self.runtime = Runtime(self.twin, now=begin, work=base.made.work)
        self.now, self.it = begin, self.runtime.controller
        self.twin._enabled = self.twin._lit = self.it.armed = True
        self.it.trusted = {axis.name: True for axis in machine.axes}
        self.it.state, self.it.running = State.RUNNING, base.made
        self.it.begin(job)
        self.job = job
        self.ticks: list[tuple[float, NDArray[np.float64], float]] = []
        self.fine = False
        run = self.twin._run

        def spy(count: int) -> int:
            done = run(1 if self.fine else count)
            self.ticks.append((self.twin._now, self.twin._executor.commanded, self.twin._beam))
            return done

        self.twin._run = spy  # type: ignore[method-assign]

    def turn(self, *, fine: bool = False) -> None:
        """Let a turn's time pass."""
        back = self.job.feeder.plan_time(self.it.report.executed) - self.it.back
        self.fine = fine or (self.it.state is State.RESUMING and back > -2.0 * PERIOD)
        self.now += PERIOD
        self.runtime.turn(self.now)

    def until(self, *states: State) -> None:
        """Let time pass until a state."""
        begin = self.now
        while self.it.state not in states:
            self.turn()
            assert self.now - begin < LATEST, f"{self.it.state} for {LATEST} s"
            assert not self.it.alarms, self.it.alarms.latched[0].message


def case(seed: int, grounds: dict[tuple[str, str], Ground]) -> str:
    """Run a case, and return what it did; what must hold is asserted."""
    draw = Random(seed)  # noqa: S311 - for tests
    name = draw.choice(CASES)
    if name not in grounds:
        grounds[name] = ground(*name)
    base = grounds[name]
    instant = draw.uniform(0.0, base.made.plan.time_s)
    begin = max(instant - LEAD, 0.0)
    b = Bench(base, begin, ideal=seed % PHYSICS != 0)
    b.turn()
    while b.now < instant and b.it.state is State.RUNNING:
        b.turn()
    what = draw.choice(("resume", "resume", "resume", "abort", "again"))
    if b.it.state is not State.RUNNING:
        return "over"
    live = b.job.feeder.live
    told: list[float] = []
    out = stop(b, c.Abort() if what == "abort" else c.Hold(), told)
    if what == "abort":
        b.until(State.IDLE)
        assert b.twin._executor.queue.end <= b.twin._executor.executed + DONE, "still moves"
    else:
        b.until(State.HELD, State.IDLE)
        if b.it.state is State.IDLE:
            return "over"
        again = what == "again"
        if what == "resume" and went_back(b, Random(f"back {seed}")):  # noqa: S311 - as above
            what = "reverse"
        go_on(b, draw, told, again=again)
        if what == "resume":
            relit(b, out)
        if seed % WHOLE == 0:
            live._legs[-1].ahead.reach(np.inf)
            end = live.state(live.end or 0.0).position
            assert np.abs(end - base.end).max() < 1e-9, f"ends at {end}, not {base.end}"
    keeps_path(b)
    keeps_limits(b, live, begin)
    return what


def go_on(b: Bench, draw: Random, told: list[float], *, again: bool) -> None:
    """Resume, holding once more on the way where asked to, until motion is at speed again."""
    for _ in range(draw.randrange(4)):
        b.turn()
    resume(b)
    for _ in range(draw.randrange(60) if again else 0):
        b.turn()
    if again and b.it.state in {State.RESUMING, State.RUNNING}:
        stop(b, c.Hold(), told)
        b.until(State.HELD, State.IDLE)
        if b.it.state is State.HELD:
            resume(b)
    b.until(State.RUNNING, State.IDLE)
    for _ in range(20):
        b.turn()


def went_back(b: Bench, draw: Random) -> bool:
    """Go back along the path now and then, at times held on the way; return whether it did."""
    if draw.random() > BACK or not b.runtime.command(c.Reverse(way=draw.uniform(0.01, 20.0)), b.now).ok:
        return False
    count, held = len(b.ticks), draw.random() < 0.3
    for _ in range(draw.randrange(60) if held else 0):
        b.turn()
    if b.it.state is State.REVERSING and held:
        assert b.runtime.command(c.Hold(), b.now).ok
    b.until(State.HELD)
    assert not any(beam for _, _, beam in b.ticks[count:]), "the beam is on on a way back"
    return True


def stop(b: Bench, command: c.AnyCommand, told: list[float]) -> tuple[float, NDArray[np.float64], float]:
    """Stop, check that the beam is off a tick after the order; return time, place and beam at the order."""
    ack = b.runtime.command(command, b.now)
    assert ack.ok or b.it.state is State.IDLE, ack.reason  # the program may end in the order's very turn
    told.append(b.now)
    out = b.ticks[-1] if b.ticks else (b.now, b.twin._executor.commanded, b.twin._beam)
    count = len(b.ticks)
    b.turn(fine=True)
    period = b.machine.servo_period
    late = [beam for at, _, beam in b.ticks[count:] if at > out[0] + 2.5 * period]
    assert not any(late), "the beam stays on after a stop"
    return out


def resume(b: Bench) -> None:
    """Resume; a hold at a pause of the program, or at its end, may have nothing to go on with."""
    report = b.it.report
    assert report.still or b.twin._executor.queue.end - report.executed <= DONE
    assert np.abs(report.velocity).max() <= DONE * max(axis.acceleration for axis in b.machine.axes)  # of what is left
    assert b.runtime.command(c.Resume(), b.now).ok


def relit(b: Bench, out: tuple[float, NDArray[np.float64], float]) -> None:
    """Check that the beam relights where it went out."""
    at, place, beam = out
    if not beam:
        return
    period = b.machine.servo_period
    speed = np.linalg.norm([axis.velocity for axis in b.machine.axes[:2]])
    later = [(t, p) for t, p, power in b.ticks if t > at + 5 * period and power]
    if not later:
        over = b.it.state is State.IDLE or _ends_lit(b.base.live, at, place, 3.0 * period)
        assert over, "the beam did not relight"
        return
    gap = float(np.linalg.norm(later[0][1] - place))
    assert gap <= 3.0 * speed * period + 1e-6, f"relit {gap:.4f} mm from where it went out"


def _ends_lit(live: LivePlan, near: float, place: NDArray[np.float64], within: float) -> bool:
    """Return whether the program itself turns the beam off so soon after a place passed near a time."""
    times = np.arange(near - 0.02, near + 0.02, 0.25 * within)
    states = [live.state(t) for t in times.tolist()]
    passed = int(np.argmin([np.linalg.norm(state.position - place) for state in states]))
    return not all(state.power for state in states[passed : passed + 6])


def keeps_path(b: Bench) -> None:
    """Check that every place told is on the path."""
    where = b.machine.kinematics
    points = np.array([p for _, p, _ in b.ticks]) @ np.linalg.pinv(where.matrix).T
    points = points[:: max(1, len(points) // 400)]
    at = b.ticks[0][0]
    low, high = np.searchsorted(b.base.times, [at - 8.0, b.now + 2.0])
    path = b.base.path[max(low - 1, 0) : high + 1]
    path = path[np.append([True], np.linalg.norm(np.diff(path, axis=0), axis=1) > 1e-9)]
    for chunk in np.array_split(points, max(1, len(points) // 50)):
        worst = _distance(chunk, path)
        assert worst < NEAR, f"{worst:.6f} mm from the path"


def _distance(points: NDArray[np.float64], path: NDArray[np.float64]) -> float:
    """Return the greatest distance of points from a polyline (its 3 nearest corners' chords)."""
    if len(path) < 2:
        return float(np.linalg.norm(points - path[0], axis=1).max())
    from scipy.spatial import cKDTree  # noqa: PLC0415 - late

    _, near = cKDTree(path).query(points, k=min(3, len(path)))
    best = np.full(len(points), np.inf)
    for first in np.hstack([near - 1, near]).clip(0, len(path) - 2).T:
        a, d = path[first], path[first + 1] - path[first]
        u = np.clip(((points - a) * d).sum(1) / np.maximum((d * d).sum(1), 1e-30), 0.0, 1.0)
        best = np.minimum(best, np.linalg.norm(a + u[:, None] * d - points, axis=1))
    return float(best.max())


def keeps_limits(b: Bench, live: LivePlan, begin: float) -> None:
    """Check velocity, acceleration and jerk along the plan from the entry to now."""
    limits = live.rules.limits
    bounds: list[tuple[int, Any]] = [(1, limits.velocity), (2, limits.acceleration)]
    if live.rules.jerk_limited:
        bounds.append((3, limits.jerk))
    for part in live.portions(begin, b.job.feeder.plan_time(b.it.report.executed)):
        inner = np.linspace(1e-6, 1.0 - 1e-6, 9)
        times = (part.phases["t"][:, None] + inner * part.phases["duration"][:, None]).ravel()
        for order, bound in bounds:
            used = np.abs(part.derivative(times, order) @ limits.matrix.T) / bound
            assert used.max() <= 1.0 + OVER, f"order {order}: {used.max():.6f} of the limit"


def main() -> int:
    """Run the campaign."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    grounds: dict[tuple[str, str], Ground] = {}
    done: dict[str, int] = {}
    failed = 0
    for seed in range(given.seed, given.seed + given.count):
        try:
            what = case(seed, grounds)
        except AssertionError as error:
            failed += 1
            what = "failed"
            print(f"seed {seed}: {error}", flush=True)
        done[what] = done.get(what, 0) + 1
        if (seed + 1 - given.seed) % 500 == 0:
            print(f"{seed + 1 - given.seed} cases: {done}; go on with --seed {seed + 1}", file=sys.stderr, flush=True)
    print(f"{given.count} cases from seed {given.seed}: {done}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
