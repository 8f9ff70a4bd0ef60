"""Mutated G-code programs: each must be read, or refused by one error that names its place; nothing else may happen.

    python tests/soak/fuzz_gcode.py --count 1000000 --seed 1 --jobs 2

Case N is made from seed N alone: an interrupted run goes on with the ``--seed`` it tells at its end, and
``--count 1 --seed N`` repeats one case.  Each case is read to a program and printed as canonical functions, with the C
core's fast path or without; both must accept it, or refuse it at the same line for the same reason.  Worker processes
have bounds on executed lines, memory and seconds, so that crashes and hangs are found, too.  Exit code 1: there were
failures; each is told with its seed, and the first of a kind with a program cut down to what it takes.
"""

from __future__ import annotations

import argparse
import math
import os
import resource
import runpy
import sys
import time
import traceback
import warnings
from dataclasses import dataclass, field, replace
from multiprocessing import connection, get_context
from pathlib import Path
from typing import TYPE_CHECKING, Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one thread, or a fork could catch another one half-way
ROOT = Path(__file__).resolve().parents[2]

from mutations import Case, Origin, case  # noqa: E402 - numpy behind it counts its threads when it is loaded

from trochia.errors import ProgramError  # noqa: E402
from trochia.languages.gcode import DIALECTS, Reading, problems, read  # noqa: E402
from trochia.languages.gcode.canon import Canon  # noqa: E402
from trochia.languages.gcode.interpreter import AXES, interpret  # noqa: E402
from trochia.program import WorkState  # noqa: E402

if TYPE_CHECKING:
    from collections.abc import Callable
    from multiprocessing.connection import Connection

    Check = Callable[[Case], bool]

MOST_LINES = 500  #: executed by a case before it is refused as endless
MOST_SECONDS = 10.0  #: a case may take, on a machine that does other things too
MOST_MEMORY = 2 << 30  #: bytes of address space beyond those of the start
CHUNK = 1000  #: cases of a worker process
MOST_TRIES = 400  #: programs tried to cut a failure down
#: where reader and printer may differ: the printer places no moves or logs; the fast path does not count plain lines
MAY_DIFFER = (
    "in a turned coordinate system an arc must lie in the XY plane",
    "this move would end at a point that is not finite",
    "the log file",
    f"more than {MOST_LINES} lines",
)
_FORK = get_context("fork")


class BrokenError(AssertionError):
    """A case that keeps no promise."""


@dataclass(frozen=True, slots=True)
class Failure:
    """What went wrong with a case: a name that is the same for the same fault, and the details."""

    seed: int
    kind: str
    details: str


def origins() -> list[Origin]:
    """Return the programs to begin with: golden cases with their tools and offsets, and the samples.

    Those that are accepted stand here three times, for an edit often spoils a program anyway.
    """
    golden = runpy.run_path(str(ROOT / "tests" / "golden" / "rewrite.py"))
    found: list[Origin] = []
    for path in golden["cases"]():
        one = Origin(path.name, (path / "program.ngc").read_bytes(), golden["work_of"](path))
        found += [one] * (1 if (path / "expected.error").exists() else 3)
    samples = sorted((ROOT / "programs").glob("*.ngc"))
    return found + 3 * [Origin(path.name, path.read_bytes(), WorkState(user_codes=True)) for path in samples]


# --- what a case must keep to


def check(one: Case) -> bool:
    """Return whether a case is accepted.

    Raises
    ------
    BrokenError
        Where reader and printer do not agree, an error has no place, or a program is not finite.
    """
    reading = Reading(work=one.work, most_lines=MOST_LINES, dialect=DIALECTS[one.dialect])
    refused = _refusal(lambda: _read(one, reading))
    out: list[bytes] = []
    printed = _refusal(lambda: interpret(one.text, Canon(out.append), name="case.ngc", block_delete=one.block_delete,
                                         reading=reading, fast=one.seed % 2 == 0))  # fmt: skip
    if refused != printed and not any(end and end[2].startswith(MAY_DIFFER) for end in (refused, printed)):
        raise BrokenError(f"read: {refused}, canon: {printed}")
    if refused is not None and one.seed % 4 == 0:
        found = problems(one.text, name="case.ngc", axes=AXES, block_delete=one.block_delete, reading=reading)
        if not found:
            raise BrokenError("refused, but without problems")
        for error in found:
            _place_of(error)
    return refused is None


def _read(one: Case, reading: Reading) -> None:
    program = read(one.text, name="case.ngc", axes=AXES, block_delete=one.block_delete, reading=reading)
    targets = program.moves["target"]
    if len(targets) and not (math.isfinite(targets.min()) and math.isfinite(targets.max())):
        raise BrokenError("the program moves to a point that is not finite")


def _refusal(run: Callable[[], object]) -> tuple[str, int, str] | None:
    """Return what a program is refused for: kind, line and message; None where it is accepted."""
    try:
        run()
    except ProgramError as error:
        return _place_of(error)
    return None


def _place_of(error: ProgramError) -> tuple[str, int, str]:
    source = error.source
    if source is None or not source.file or source.line < 1 or source.column < 0 or not str(error).strip():
        raise BrokenError(f"an error without a place: {error!r}")
    return error.code, source.line, error.message


def failure(one: Case, checked: Check) -> tuple[Failure | None, bool]:
    """Return what is wrong with a case, and whether it is accepted."""
    try:
        return None, checked(one)
    except Exception as error:  # noqa: BLE001 - whatever comes is a finding
        last = traceback.extract_tb(error.__traceback__)[-1]
        kind = f"{type(error).__name__} at {Path(last.filename).name}:{last.lineno}"
        return Failure(one.seed, kind, "".join(traceback.format_exception(error))), False


# --- workers


def _work(seeds: range, now: Any, send: Connection, checked: Check, bases: list[Origin]) -> None:
    """Try the cases of some seeds; ``now`` tells which one, for the case that this process dies."""
    _limit()
    accepted = 0
    for seed in seeds:
        now.value = seed
        found, ok = failure(case(seed, bases, tuple(DIALECTS)), checked)
        accepted += ok
        if found is not None:
            send.send(found)
    send.send(accepted)


def _limit() -> None:
    """Bound the memory of this process, and take warnings as errors."""
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + MOST_MEMORY, resource.RLIM_INFINITY))
    warnings.simplefilter("error")


class Worker:
    """A process that tries seeds ``first`` to ``end - 1``."""

    def __init__(self, first: int, end: int, checked: Check, bases: list[Origin]) -> None:
        self.first, self.end = first, end
        self.found: list[Failure] = []
        self.accepted = 0
        self._now = _FORK.RawValue("q", first)
        self._seen, self._since = first, time.monotonic()
        self.pipe, send = _FORK.Pipe(duplex=False)
        self._process = _FORK.Process(
            target=_work, args=(range(first, end), self._now, send, checked, bases), daemon=True
        )
        self._process.start()
        send.close()

    def over(self, seconds: float) -> int | None:
        """Return the first seed not tried, once the process has ended or has been ended; None while it goes on."""
        try:
            while self.pipe.poll():
                got = self.pipe.recv()
                if isinstance(got, Failure):
                    self.found.append(got)
                else:
                    self.accepted = got
                    self._process.join()
                    return self.end
        except EOFError:
            self._process.join()
            return self._lost(f"the process died with code {self._process.exitcode}")
        if self._now.value != self._seen:
            self._seen, self._since = self._now.value, time.monotonic()
        elif time.monotonic() - self._since > seconds:
            self.stop()
            return self._lost("hang")
        return None

    def _lost(self, kind: str) -> int:
        self.found.append(Failure(self._now.value, kind, f"after at most {MOST_SECONDS:g} s"))
        return self._now.value + 1

    def stop(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.join()


@dataclass(slots=True)
class Campaign:
    """How far a campaign has come."""

    first: int
    count: int
    done: int = 0
    accepted: int = 0
    failures: int = 0
    reached: int = 0  # all seeds below it have been tried
    kinds: dict[str, int] = field(default_factory=dict)

    def tell(self, begun: float) -> None:
        """Print the progress."""
        rate = self.done / max(time.monotonic() - begun, 1e-9)
        print(f"{self.done:,} of {self.count:,} cases, {self.accepted:,} accepted, {self.failures} failures, "
              f"{rate:,.0f} /s", flush=True)  # fmt: skip


def campaign(
    first: int, count: int, jobs: int, *, checked: Check = check, seconds: float = MOST_SECONDS, every: float = 20.0
) -> Campaign:
    """Try ``count`` seeds from ``first`` on; print progress and failures, and return how it went."""
    bases = origins()
    run = Campaign(first, count, reached=first)
    waiting = [(at, min(at + CHUNK, first + count)) for at in range(first, first + count, CHUNK)][::-1]
    working: list[Worker] = []
    begun = told = time.monotonic()
    try:
        while waiting or working:
            while waiting and len(working) < jobs:
                working.append(Worker(*waiting.pop(), checked, bases))
            connection.wait([worker.pipe for worker in working], timeout=0.5)
            for worker in working[:]:
                after = worker.over(seconds)
                if after is None:
                    continue
                working.remove(worker)
                if after < worker.end:
                    waiting.append((after, worker.end))
                run.done += after - worker.first
                _count(run, worker, bases, checked, seconds)
            open_seeds = [worker.first for worker in working] + [at for at, _ in waiting]
            run.reached = min(open_seeds, default=first + count)
            if time.monotonic() - told > every:
                told = time.monotonic()
                run.tell(begun)
    except KeyboardInterrupt:
        for worker in working:
            worker.stop()
    run.tell(begun)
    return run


def _count(run: Campaign, worker: Worker, bases: list[Origin], checked: Check, seconds: float) -> None:
    """Add what a worker found, and tell it; of each kind the first is cut down."""
    run.accepted += worker.accepted
    for found in worker.found:
        run.failures += 1
        print(f"seed {found.seed}: {found.kind}", flush=True)
        if found.kind not in run.kinds:
            print(found.details, flush=True)
            one = case(found.seed, bases, tuple(DIALECTS))
            small = shrunk(one, lambda other, kind=found.kind: _kind_apart(other, checked, seconds) == kind)
            print(f"cut down ({small.dialect}, of {len(one.text)} bytes): {small.text!r}", flush=True)
        run.kinds[found.kind] = run.kinds.get(found.kind, 0) + 1


# --- cutting a failure down


def _kind_apart(one: Case, checked: Check, seconds: float) -> str | None:
    """Return the kind of a case's failure, found in a process of its own; None where it has none."""
    receive, send = _FORK.Pipe(duplex=False)

    def work() -> None:
        _limit()
        send.send(failure(one, checked)[0])

    process = _FORK.Process(target=work, daemon=True)
    process.start()
    send.close()
    try:
        if not receive.poll(seconds):
            process.kill()
            return "hang"
        found = receive.recv()
    except EOFError:
        process.join()
        return f"the process died with code {process.exitcode}"
    finally:
        process.join()
    return None if found is None else found.kind


def shrunk(one: Case, fails: Callable[[Case], bool], tries: int = MOST_TRIES) -> Case:
    """Return a case that still fails, without the lines and bytes it does not take; at most ``tries`` are tried."""
    for split in (_of_lines, _of_bytes):
        parts = split(one.text)
        size = max(len(parts) // 2, 1)
        while size:
            at = 0
            while at < len(parts) and tries > 0:
                tries -= 1
                fewer = parts[:at] + parts[at + size :]
                if fails(replace(one, text=b"".join(fewer))):
                    parts = fewer
                else:
                    at += size
            size //= 2
        one = replace(one, text=b"".join(parts))
    return one


def _of_lines(text: bytes) -> list[bytes]:
    return text.splitlines(keepends=True)


def _of_bytes(text: bytes) -> list[bytes]:
    return [text[at : at + 1] for at in range(len(text))]


def main() -> int:
    """Run a campaign as the command line has it, and return the exit code."""
    parser = argparse.ArgumentParser(description="mutated G-code programs: read, or refused by one error; nothing else")
    parser.add_argument("--count", type=int, default=10_000, help="how many cases")
    parser.add_argument("--seed", type=int, default=1, help="the first one")
    parser.add_argument("--jobs", type=int, default=1, help="worker processes")
    given = parser.parse_args()
    if given.count < 1 or given.jobs < 1:
        parser.error("--count and --jobs must be at least 1")
    run = campaign(given.seed, given.count, given.jobs)
    if run.reached < given.seed + given.count:
        left = given.seed + given.count - run.reached
        print(f"stopped; go on with --seed {run.reached} --count {left}")
    for kind, times in run.kinds.items():
        print(f"{times} times {kind}")
    return 1 if run.failures or run.reached < given.seed + given.count else 0


if __name__ == "__main__":
    sys.exit(main())
