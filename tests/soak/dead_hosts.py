"""A host that dies or freezes at any instant of a motion: the board stops under control, in the dark, and keeps count.

    python tests/soak/dead_hosts.py --count 200 --seed 1

Case N is made from seed N alone: an instant of a motion that the live backend runs on the Uno's image, on the simulated
chip, and what happens then: the host is killed, in the midst of a frame or not, or freezes for some time and goes on.
What must hold of one that is killed:

- motion ends by itself, its rate falling no faster than the slew its segments carry, or where the whole motion ends;
- the beam goes out 1 ms after the decision to stop at the latest, and before steps fall back behind their time;
- what the next host is told is what the pins made: the planned steps, in order, up to the stream time told.

One that freezes finds the motion going on, ended or stopped, and the same holds of its steps.

Exit code 1: a case failed; each is told with its seed, and ``--show SEED`` runs that one alone.
"""

from __future__ import annotations

import argparse
import collections
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from faults import built, session, spans

import trochia
from trochia.backends.avr.live_avr import LiveAvr
from trochia.backends.avr.session import Session, Told
from trochia.backends.avr.transports import ChipTransport
from trochia.backends.live import Orders
from trochia.backends.segments import sampled
from trochia.kernels.link import CAUSES, STATES
from trochia.messages import Cause

PROGRAM = "G21 G90 G64 P0.05\nM3 S1\nG1 X20 Y5 F9000\nG2 X30 Y15 R12\nG1 X0 Y0\nX25 Y20\nX0 Y10\nX20\nM5\nM2\n"
SLEW = 4.0  #: of the rate [1/s]
ROWS = 8  #: of 5 ms that are given at once
PERIOD = 0.01  #: of the host's polls [s]
LOOK = 4000  #: cycles between two looks at a chip whose host is dead: 0.25 ms
DARK = 0.001 + LOOK / 16e6  #: after the decision the beam is out [s]
LATE = 600  #: cycles that steps may fall back in a WINDOW while the beam is on: slots, and a slice's beginning
WINDOW = 1 << 17  #: cycles over which a rate is measured
SILENCE = 250  #: slices that a board waits for its host
BEAM = 0xB0  #: TCCR2A: 0 where the beam's pin is low
STILL = 0.06  #: without a step: it has come to rest [s]


class Host:
    """The live backend on a chip, whose bytes can be held up; so many seconds of motion lie ahead."""

    def __init__(self, chip: tuple[Path, Path], ahead: float) -> None:
        self.machine = replace(trochia.load("laser"), io=())
        self.transport = ChipTransport(*chip)
        self.transport.edges = []
        self.backend = LiveAvr(self.machine, self.transport)
        self.backend.session.order = self._order  # what is sent is noted
        self.sent: list[bytes] = []
        self.now, self.given, self.ahead = 0.0, 0.0, ahead
        self.report = self.backend.open(0.0)

    def _order(self, kind: str, payload: bytes = b"") -> int:
        if kind == "span":
            self.sent.append(payload)
        return Session.order(self.backend.session, kind, payload)

    def begin(self) -> float:
        """Give the motion; return how long it takes [s]."""
        plan = trochia.plan(trochia.gcode(PROGRAM, self.machine), self.machine).trajectory
        times = np.linspace(0.0, plan.duration, round(plan.duration / 0.005))
        self.rows = sampled(plan, self.machine.kinematics.matrix, times, np.full(len(times) - 1, SLEW))
        self.backend.order(Orders(enable=True, lit=True), 0.0)
        return plan.duration

    def poll(self, until: float) -> None:
        while self.now < until - 1e-9:
            self.feed()
            self.now = min(self.now + PERIOD, until)
            self.report = self.backend.poll(self.now)
            if any(trouble.cause is Cause.LINK for trouble in self.report.troubles):
                self.rows = self.rows.rows(slice(0, 0))  # the controller sends no more after an alarm

    def feed(self) -> None:
        """Give as much of the motion as is to lie ahead."""
        while len(self.rows) and self.report.queued < self.ahead:
            first = self.rows.rows(slice(0, ROWS))
            self.rows = self.rows.rows(slice(ROWS, None))
            self.backend.order(Orders(segments=first, at=self.given), self.now)
            self.given += first.span
            self.report = replace(self.report, queued=self.report.queued + first.span)

    def freeze(self, seconds: float) -> None:
        """Let the chip go on alone; what it sends waits."""
        kept = self.transport.exchange(b"", self.now + seconds)
        exchange = self.transport.exchange
        self.now += seconds

        def thawed(data: bytes, now: float) -> bytes:
            self.transport.exchange = exchange
            return kept + exchange(data, now)

        self.transport.exchange = thawed


def case(seed: int, chip: tuple[Path, Path]) -> str:
    """Run a case; return how it ended."""
    rng = np.random.default_rng(seed)
    host = Host(chip, float(rng.uniform(0.12, 0.5)))
    try:
        duration = host.begin()
        host.poll(float(rng.uniform(0.0, duration + 0.1)))
        if rng.random() < 0.5:
            return "killed, " + killed(host, rng, symbol(chip[1]))
        host.freeze(float(10 ** rng.uniform(-2.3, 0.2)))
        host.poll(host.now + duration + 1.0)
        return "frozen, " + stood(host, host.backend.status)
    finally:
        host.transport.close()


def symbol(image: Path) -> int:
    """Return where the chip counts slices without a frame."""
    text = subprocess.run(["avr-nm", image], capture_output=True, text=True, check=True).stdout
    return next(int(line.split()[0], 16) & 0xFFFF for line in text.splitlines() if line.endswith(" silent_slices"))


def killed(host: Host, rng: np.random.Generator, counter: int) -> str:
    """End the host, perhaps within a frame, and look at what the chip does."""
    chip, session_of_it = host.transport.chip, host.backend.session
    session_of_it.ask()
    left = session_of_it.outgoing(host.now)
    chip.feed(left[: int(rng.integers(len(left) + 1))])
    decided, dark = None, None
    moved = at = chip.run_until(0).cycle
    while at < moved + STILL * 16e6:
        run = chip.run_until(at + LOOK)
        at = run.cycle
        host.transport.edges.append(run.events)
        if len(run.edges("D2", 1)) or len(run.edges("D3", 1)):
            moved = at
        shines = bool(chip.read_memory(BEAM, 1)[0])
        silent = int.from_bytes(chip.read_memory(counter, 2), "little")
        if decided is None and silent > SILENCE:
            decided = at
        if shines:
            dark = at + LOOK
        assert decided is None or not shines or at <= decided + DARK * 16e6, "the beam is on after the stop's decision"
    late = slowed(host, dark - WINDOW, dark) if dark is not None else 0
    assert late < LATE, f"the beam was on while steps fell back by {late / 16:.0f} µs"
    cause = stood(host, next_host(host))
    controlled(host)
    return cause + (", the beam was on" if dark else "")


def run_through(host: Host) -> tuple[Any, Any]:
    """Return cycles of steps and their ticks of stream time, all motors' in order (steps,)."""
    planned = spans.planned(host.sent)
    _, cycles = spans.at_pins(np.concatenate(host.transport.edges), session.STEPS, session.WAYS)
    at = np.concatenate(cycles)
    stream = np.concatenate([ticks[: len(one)] for one, ticks in zip(cycles, planned.ticks, strict=False)])
    order = at.argsort(kind="stable")
    return at[order], stream[order]


def slowed(host: Host, since: int, until: int) -> int:
    """Return by how much steps have fallen back behind their ticks from one cycle to another."""
    at, stream = run_through(host)
    rows = np.flatnonzero((at > since) & (at <= until))
    return int((at[rows] - stream[rows]).max() - (at[rows] - stream[rows]).min()) if len(rows) else 0


def controlled(host: Host) -> None:
    """Hold the fall of the rate against the slew, where steps are close enough to measure it."""
    at, stream = run_through(host)
    if len(at) < 3:
        return
    grid = np.arange(at[0], at[-1], WINDOW)
    rates = np.diff(np.interp(grid, at, stream)) / WINDOW
    widest = np.maximum.reduceat(np.diff(at, append=at[-1]), at.searchsorted(grid)) if len(grid) else grid
    dense = widest[:-1] < WINDOW / 16
    fall = -np.diff(rates)[dense[1:] & dense[:-1]] / (WINDOW / 16e6)
    assert rates[dense].max(initial=0.0) < 1.03, f"a rate of {rates[dense].max():.3f}"
    assert fall.max(initial=0.0) < 1.3 * SLEW, f"the rate falls by {fall.max():.1f} /s, {SLEW} are allowed"


def next_host(host: Host) -> Any:
    """Return what another host is told."""
    line, now = Session(host.transport.baud, seed=77), host.now + 2.0
    host.transport.rebase(now)
    line.greet(now)
    status = None
    while status is None:
        assert now < host.now + 3.0, "it hangs: no status for the next host"
        if line.state == "open":
            line.ask()
        came = host.transport.exchange(line.outgoing(now), now + 0.005)
        now += 0.005
        told = [event for event in line.receive(came, now) if isinstance(event, Told)]
        status = told[-1].status if told else None
    return status


def stood(host: Host, status: Any) -> str:
    """Hold the steps at the pins against what was planned and what is told; return why it stands."""
    planned = spans.planned(host.sent) if host.sent else None
    made, _ = spans.at_pins(np.concatenate(host.transport.edges), session.STEPS, session.WAYS)
    state, cause = STATES[int(status["state"])], CAUSES[int(status["cause"])]
    assert state != "running", "it has not come to rest"
    for motor, steps in enumerate(made):
        told = int(status["position"][motor])
        assert told == steps.sum(), f"motor {motor}: {told} told, {steps.sum()} at its pins"
        wanted = planned.steps[motor] if planned else steps[:0]
        assert np.array_equal(steps, wanted[: len(steps)]), f"motor {motor}: other steps than planned"
        if planned is not None and int(status["epoch"]):
            least, most = planned.ticks[motor].searchsorted(
                int(status["executed"]) + np.array([-session.SLACK, session.SLACK])
            )
            assert least <= len(steps) <= most, f"motor {motor}: {len(steps)} steps, not {least} to {most}"
    assert not int(status["beam"]), "the beam is on at rest"
    return "its end" if state == "idle" else "nothing begun" if state == "loading" else cause


def main() -> int:
    """Run the campaign."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--show", type=int, metavar="SEED", help="run this one")
    given = parser.parse_args()
    ends, failed = collections.Counter[str](), 0
    with tempfile.TemporaryDirectory() as folder:
        chip = built(Path(folder), image=True)
        if given.show is not None:
            print(case(given.show, chip))
            return 0
        for seed in range(given.seed, given.seed + given.count):
            try:
                ends[case(seed, chip)] += 1
            except AssertionError as error:
                failed += 1
                print(f"seed {seed}: {error}", flush=True)
    told = ", ".join(f"{count} {end}" for end, count in ends.most_common())
    print(f"{given.count} cases from seed {given.seed}, {failed} failed: {told}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
