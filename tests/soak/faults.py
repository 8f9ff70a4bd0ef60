"""Faults on the line between host and chip: the same motion, or an alarm with the true position; nothing else.

    python tests/soak/faults.py --count 10000 --seed 1 --jobs 2
    python tests/soak/faults.py --count 200 --image

First every kind of fault at every byte of a short session, both ways, one at a time (``--no-sweep`` leaves that out);
then random sessions from a seed on, until there were COUNT faults.  Case N is made from seed N alone: two motions of
one to three motors; one fault or two, many at a rate, bursts; in the hello, at a hold, while a host connects again.
``tests/faulty_session.py`` says what must hold.  The chip is the firmware's C compiled for this computer
(firmware/host); with ``--image`` it is the image itself on the simulated chip, and there is no sweep.

Exit code 1: a case failed; each is told with its seed, and ``--show SEED`` runs that one alone.
"""

from __future__ import annotations

import argparse
import collections
import importlib
import itertools
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests"))
for _name in ("steady_spans", "random_spans", "spoilt_line"):
    importlib.import_module(_name)
import faulty_session as session  # noqa: E402 - it lies beside these
import random_spans as spans  # noqa: E402
import spoilt_line as lines  # noqa: E402

IMAGE = "uno-stepdir-1000000"
TOGETHER = 50  #: cases a worker is given at once
SIZES = {"drop": 0.0, "flip": 5.0, "double": 0.0, "burst": 9.0, "delay": 0.3, "cut": lines.ALWAYS}


def built(folder: Path, *, image: bool) -> tuple[Path, Path]:
    """Build what is run, and return copies of the chip's program and its image: a campaign may outlast a change."""
    folders = [("sim", ()), ("avr", (f"../../build/avr/{IMAGE}.elf",))] if image else [("host", ())]
    for part, goals in folders:
        subprocess.run(["make", "-s", "-C", ROOT / "firmware" / part, *goals], check=True)
    chip, file = ROOT / "build" / ("sim" if image else "host") / "chip", ROOT / "build" / "avr" / f"{IMAGE}.elf"
    return Path(shutil.copy(chip, folder)), Path(shutil.copy(file, folder)) if image else Path()


def short(*faults: Any) -> Any:
    """Return the short session of the sweep, with faults."""
    kind = spans.Kind(motors=2, fastest=12_000.0, ticks=(1 << 16, 1 << 17))
    return session.Case(seed=1, kind=kind, counts=(7, 2), start=faults)


def sweep(chip: tuple[Path, Path]) -> list[Any]:
    """Return a case for every kind of fault at every byte of the short session, both ways."""
    there, back = session.run(short(), *chip).bytes
    return [
        short(lines.Fault(kind=kind, way=way, at=at, size=size))
        for kind, size in SIZES.items() for way, count in enumerate((there, back)) for at in range(count)
    ]  # fmt: skip


def one(case: Any, chip: tuple[Path, Path]) -> tuple[int, list[str], str]:
    """Run a case; return its faults, how its motions ended, and what was wrong."""
    try:
        told = session.run(case, *chip)
    except AssertionError as error:
        return 1, ["FAILED"], f"seed {case.seed}{f', {case.start}' if case.seed == 1 else ''}: {error}"
    return told.faults, told.ends, ""


def several(cases: list[Any], chip: tuple[Path, Path]) -> tuple[int, list[str], list[str]]:
    """Run cases one after the other."""
    rows = [one(case, chip) for case in cases]
    wrong = [row[2] for row in rows if row[2]]
    return sum(row[0] for row in rows), [end for row in rows for end in row[1]], wrong


class Campaign:
    """What has come of it so far."""

    def __init__(self, chip: tuple[Path, Path], jobs: int) -> None:
        self.chip, self.jobs = chip, jobs
        self.faults, self.failed, self.cases = 0, 0, 0
        self.ends = collections.Counter[str]()

    def run(self, cases: Iterator[Any], until: float) -> None:
        """Run cases until there are none, or as many faults."""
        with ProcessPoolExecutor(self.jobs) as pool:
            while self.faults < until:
                lots = [list(itertools.islice(cases, TOGETHER)) for _ in range(2 * self.jobs)]
                if not lots[0]:
                    return
                for lot, (faults, ends, wrong) in zip(
                    lots, pool.map(several, lots, itertools.repeat(self.chip)), strict=True
                ):
                    self.faults, self.failed, self.cases = (
                        self.faults + faults, self.failed + len(wrong), self.cases + len(lot))  # fmt: skip
                    self.ends.update(ends)
                    print(*wrong, sep="\n", end="\n" if wrong else "", flush=True)

    def tell(self, what: str) -> None:
        ends = ", ".join(f"{count} {end}" for end, count in self.ends.most_common())
        print(f"{what}: {self.cases} sessions, {self.faults} faults, {self.failed} failed; motions: {ends}", flush=True)


def main() -> int:
    """Run the campaign."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("--count", type=int, default=10_000, help="random faults")
    parser.add_argument("--seed", type=int, default=2)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--show", type=int, metavar="SEED", help="run this one")
    parser.add_argument("--image", action="store_true", help="on the image, on the simulated chip")
    parser.add_argument("--no-sweep", action="store_true", help="random sessions only")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        return campaign(given, built(Path(folder), image=given.image))


def campaign(given: argparse.Namespace, chip: tuple[Path, Path]) -> int:
    """Run what is asked for; return 1 after a failure."""
    failed, began = 0, time.monotonic()
    if given.show is not None:
        print(session.case_of(given.show), *one(session.case_of(given.show), chip), sep="\n")
        return 0
    if not given.image and not given.no_sweep:
        swept = Campaign(chip, given.jobs)
        swept.run(iter(sweep(chip)), float("inf"))
        swept.tell(f"every byte, {time.monotonic() - began:.0f} s")
        failed += swept.failed
    if given.count:
        seeds = itertools.count(given.seed)
        made = Campaign(chip, given.jobs)
        made.run(map(session.case_of, seeds), given.count)
        made.tell(f"seeds {given.seed} to {given.seed + made.cases - 1}, {time.monotonic() - began:.0f} s")
        failed += made.failed
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
