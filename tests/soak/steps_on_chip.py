"""No step lost or doubled: random motions on a board's image, on the simulated chip, counted at its pins.

    python tests/soak/steps_on_chip.py --steps 100000000 --seed 1 --jobs 2

Case N is made from seed N alone: one to four motors, some seconds of spans, intervals and ways that change, now and
then at rest; spans come over the line at 1,000,000 baud all the while, and a status is asked for a hundred times a
second.  What must hold:

- the position told, the steps at the pins and those of the host core are the same, motor for motor;
- the stream of pulses is the same, in order, with every pulse's motors and directions: it has the same CRC;
- every pulse comes where it is planned, LATEST at most behind; no two of a motor are closer than CLOSEST.

Exit code 1: a case failed; each is told with its seed.  A campaign that is stopped (Ctrl-C) tells the seed to go on
with.
"""

from __future__ import annotations

import argparse
import itertools
import sys
import tempfile
import time
import zlib
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from faults import built, session, spans

sys.path.insert(0, str(Path(__file__).parents[1]))
import board_talk
from trochia.kernels.link import CAUSES

SPANS = 120  #: of a case
TOGETHER = 4  #: cases a worker is given at once, one where less than FEW steps are left
FEW = 2_000_000
PULSE = 24  #: ticks within which the pins of a pulse rise
LATEST = 480  #: of a pulse behind its tick, the median's left out [cycles]
CLOSEST = 60  #: pulses of a motor [cycles]
#: motors, the fastest of each [Hz], the least stride
KINDS = ((1, 150_000.0, 60), (1, 30_000.0, 1), (2, 36_000.0, 8), (3, 28_000.0, 8), (4, 18_000.0, 8), (3, 9_000.0, 1))


class Done(NamedTuple):
    """What came of a case: steps, seconds of the chip's time, the CRC of its pulses, the latest of them [cycles]."""

    seed: int
    steps: int
    seconds: float
    crc: int
    late: int
    wrong: str = ""


def motion(seed: int) -> list[bytes]:
    """Return the spans of a seed."""
    rng = np.random.default_rng(seed)
    motors, fastest, stride = KINDS[int(rng.integers(len(KINDS)))]
    kind = spans.Kind(motors=motors, fastest=fastest, slowest=fastest / 2, stride=stride, ticks=(1 << 18, 1 << 19))
    return spans.drawn(rng, kind, SPANS)


def case(seed: int, chip: tuple[Path, Path]) -> Done:
    """Run a case, and hold the pins against the host core."""
    sent = motion(seed)
    planned = spans.planned(sent)
    told = board_talk.Talk(*chip, "uno-stepdir")
    try:
        status, events, seconds = told.stream(sent), told.events(), told.now
    finally:
        told.line.close()
    made, cycles = spans.at_pins(events, session.STEPS, session.WAYS)
    count = len(session.STEPS)
    crc = zlib.crc32(spans.stream_of(made, cycles, PULSE).tobytes())
    wanted = zlib.crc32(spans.stream_of(planned.steps[:count], planned.ticks[:count], 0).tobytes())
    total = sum(len(steps) for steps in made)
    cause, late = CAUSES[int(status["cause"])], 0
    if cause != "no_cause":
        return Done(seed, total, seconds, crc, 0, f"an alarm: {cause}")
    for motor in range(count):
        at, steps, ticks = int(status["position"][motor]), made[motor], planned.ticks[motor]
        if not at == steps.sum() == planned.position[motor]:
            return Done(seed, total, seconds, crc, 0, f"motor {motor}: {at} told, {steps.sum()} at its pins, "
                        f"{planned.position[motor]} planned")  # fmt: skip
        if len(steps) != len(ticks):
            return Done(seed, total, seconds, crc, 0, f"motor {motor}: {len(steps)} steps, {len(ticks)} planned")
    if crc != wanted:
        return Done(seed, total, seconds, crc, 0, f"another stream of pulses: {crc:08x}, planned {wanted:08x}")
    behind = np.concatenate([c - t for c, t in zip(cycles, planned.ticks, strict=False)])
    behind = behind - int(np.median(behind))
    late = int(behind.max())
    close = min((int(np.diff(c).min()) for c in cycles if len(c) > 1), default=CLOSEST)
    wrong = (
        f"a pulse {late} cycles late" if late > LATEST else f"pulses {close} cycles apart" if close < CLOSEST else ""
    )
    return Done(seed, total, seconds, crc, late, wrong)


def several(seeds: list[int], chip: tuple[Path, Path]) -> list[Done]:
    """Run cases one after the other."""
    return [case(seed, chip) for seed in seeds]


class Campaign:
    """What has come of it so far."""

    def __init__(self, steps: int, seed: int) -> None:
        self.wanted, self.next = steps, seed
        self.steps, self.seconds, self.failed, self.late, self.cases = 0, 0.0, 0, 0, 0
        self.began = self.told = time.monotonic()

    def take(self, rows: list[Done]) -> None:
        """Add what came of some cases."""
        for done in rows:
            self.steps, self.seconds = self.steps + done.steps, self.seconds + done.seconds
            self.late, self.cases, self.next = max(self.late, done.late), self.cases + 1, done.seed + 1
            if done.wrong:
                self.failed += 1
                print(f"seed {done.seed}: {done.wrong}", flush=True)
        if time.monotonic() - self.told > 20.0:
            self.told = time.monotonic()
            self.tell()

    def tell(self) -> None:
        """Say how far it is, how fast it goes and how long it will take."""
        past = time.monotonic() - self.began
        rate = self.steps / past
        left = max(self.wanted - self.steps, 0) / max(rate, 1.0)
        print(f"{self.steps:,} steps in {self.cases} cases, {self.failed} failed, up to {self.late / 16:.1f} µs late;",
              f"{rate:,.0f} steps/s, {self.seconds / past:.1f} s of the chip a second; {left / 60:.0f} min left;",
              f"go on with --seed {self.next}", flush=True)  # fmt: skip


def main() -> int:
    """Run the campaign."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("--steps", type=int, default=100_000_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--show", type=int, metavar="SEED", help="run this one")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        chip = built(Path(folder), image=True)
        if given.show is not None:
            done = case(given.show, chip)
            print(done, f"CRC {done.crc:08x}")
            return 1 if done.wrong else 0
        made, seeds = Campaign(given.steps, given.seed), itertools.count(given.seed)
        try:
            run(made, seeds, chip, given.jobs)
        except KeyboardInterrupt:
            print("stopped")
        made.tell()
        return 1 if made.failed else 0


def run(made: Campaign, seeds: Any, chip: tuple[Path, Path], jobs: int) -> None:
    """Run cases until there were as many steps as are wanted."""
    with ProcessPoolExecutor(jobs) as pool:
        while made.steps < made.wanted:
            few = 1 if made.wanted - made.steps < FEW else TOGETHER
            lots = [list(itertools.islice(seeds, few)) for _ in range(2 * jobs)]
            for rows in pool.map(several, lots, itertools.repeat(chip)):
                made.take(rows)


if __name__ == "__main__":
    sys.exit(main())
