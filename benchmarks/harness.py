"""Time a reference and ours alternately in the same call, and print best, median and ratio.

In: named calls or commands.  Out: one table.  Alternating spreads the machine's other work over both; the best of the
runs is what the code can do, the median what it did.
"""

from __future__ import annotations

import os
import platform
import resource
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

_TRIES = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """Something to time.

    Attributes
    ----------
    name
        What the table calls it.
    call
        Runs it once.
    count
        How many units (lines, segments, steps) one run does.
    reference
        Whether ratios are taken against this one.
    target
        Units a second it must reach, where one is set.

    """

    name: str
    call: Callable[[], object]
    count: int
    reference: bool = False
    target: float | None = None


def command(argv: Sequence[str | Path], cwd: Path | None = None) -> Callable[[], object]:
    """Return a call that runs a whole command, its output thrown away; a command that fails is an error."""
    null = subprocess.DEVNULL
    return lambda: subprocess.run([str(a) for a in argv], cwd=cwd, stdout=null, stderr=null, check=True)


def processor_seconds(*, children: bool = False) -> float:
    """Return the processor time [s] used so far by this process, or by those it waited for."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN if children else resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def machine() -> str:
    """Return the processor's name, the number of its cores, and the Python."""
    name = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.exists():
        models = [line.partition(":")[2].strip() for line in info.read_text().splitlines() if "model name" in line]
        name = models[0] if models else name
    return f"{name}, {os.cpu_count()} cores, Python {platform.python_version()}"


def measure(cases: Sequence[Case], runs: int = 7) -> dict[str, list[float]]:
    """Return the wall times [s] of every case by name; the cases take turns, after one unmeasured round."""
    times: dict[str, list[float]] = {case.name: [] for case in cases}
    for turn in range(runs + 1):
        for case in cases:
            seconds = _timed(case)
            if turn:
                times[case.name].append(seconds)
    return times


def _timed(case: Case) -> float:
    """Return the wall time [s] of one run; a command that a signal ended (rs274 does so at times) runs again."""
    for _ in range(_TRIES):
        start = time.perf_counter()
        try:
            case.call()
        except subprocess.CalledProcessError as error:
            if error.returncode > 0:
                raise
        else:
            return time.perf_counter() - start
    raise RuntimeError(f"{case.name} was ended by a signal {_TRIES} times")


def report(title: str, unit: str, cases: Sequence[Case], runs: int = 7) -> None:
    """Measure and print one table: seconds, units a second, ratio of the bests to the reference, and the target."""
    times = measure(cases, runs)
    base = next((min(times[c.name]) / c.count for c in cases if c.reference), None)
    print(f"\n{title}  ({runs} runs each, taking turns; {machine()})\n")
    print(f"| what | best s | median s | best {unit}/s | median {unit}/s | ratio | target |")
    print("|---|---|---|---|---|---|---|")
    for case in cases:
        best, middle = min(times[case.name]), median(times[case.name])
        ratio = "" if base is None else f"{base / (best / case.count):.2f}"
        target = (
            ""
            if case.target is None
            else f"{case.target:,.0f} {'met' if case.count / best >= case.target else 'MISSED'}"
        )
        print(
            f"| {case.name} | {best:.4f} | {middle:.4f} | {case.count / best:,.0f} | {case.count / middle:,.0f}"
            f" | {ratio} | {target} |"
        )
