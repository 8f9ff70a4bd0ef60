"""Cutter compensation along 100,000 zig-zag lines: LinuxCNC's ``rs274 -g`` against ours, command and in process."""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path

from bench_canon import in_process
from harness import Case, command, processor_seconds, report

LINES, RUNS = 100_000, 3


def zigzag() -> str:
    """Return a saw-tooth contour with the tool on its left: inside and outside corners in turn."""
    head = "g21 g90 g17 g64 p0.01\nf2400\ng0 x-10 y-10 z0\ng41.1 d1\ng1 x0 y0\n"
    return head + "".join(f"g1 x{(i + 1) * 2} y{5 if i % 2 == 0 else 0}\n" for i in range(LINES)) + "g40\ng0 y-50\nm2\n"


def _processor_time(case: Case) -> float:
    """Return the least processor time [s] of some runs of a case."""
    times: list[float] = []
    for _ in range(RUNS):
        start = processor_seconds() + processor_seconds(children=True)
        case.call()
        times.append(processor_seconds() + processor_seconds(children=True) - start)
    return min(times)


def main() -> None:
    ours, reference = Path(sys.executable).with_name("trochia"), shutil.which("rs274")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "zigzag.ngc")
        path.write_text(zigzag())
        cases = [
            Case(name="trochia canon", call=command([ours, "canon", path]), count=LINES, target=50_000),
            Case(name="in process", call=lambda: in_process(path), count=LINES, target=50_000),
        ]
        if reference:
            call = command([reference, "-g", path], Path(folder))
            cases.insert(0, Case(name="rs274 -g", call=call, count=LINES, reference=True))
        report(f"compensation: {LINES:,} lines", "lines", cases)
        used = {case.name: _processor_time(case) for case in cases}
        for name, seconds in used.items():
            print(
                f"{name}: {LINES / seconds:,.0f} lines/s of processor time, ratio {used[cases[0].name] / seconds:.2f}"
            )


if __name__ == "__main__":
    main()
