"""Planning with limited jerk: how many segments a second, on files like those that other controllers are timed with.

The processor's time of the plan alone is taken, best of five: the path with its blends is there already, and other work
on the machine does not count.
"""

from __future__ import annotations

import time

import shapes
from harness import machine as processor
from trochia.machine.load import load
from trochia.planner import plan
from trochia.toolpath import build

COUNT = 100_000  #: moves of a file
FEED = 100.0  #: mm/s
WANTED = 400_000  #: segments a second
RUNS = 5


def main() -> None:
    machine = load("reference-mill")
    files = {
        "mixed lines and bends": shapes.mixed(COUNT),
        "curve, chords of 0.2 mm": shapes.curve(COUNT),
        "zig-zag, chords of 1 mm": shapes.zigzag(COUNT),
        "hatch, lines of 15 mm": shapes.hatch(COUNT),
    }
    print(f"\n### Planning with limited jerk  (best of {RUNS}; {processor()})\n")
    print("| file | moves | segments | best s | moves/s | segments/s | target |")
    print("|---|---|---|---|---|---|---|")
    for name, points in files.items():
        program = shapes.chain(points, FEED)
        path = build(program, machine, continuity=2)
        times = []
        for _ in range(RUNS):
            begun = time.process_time()
            plan(path, machine, program=program, profile="s-curve")
            times.append(time.process_time() - begun)
        best = min(times)
        moves, segments = len(program.moves) / best, len(path) / best
        verdict = "met" if segments >= WANTED else "MISSED"
        print(
            f"| {name} | {len(program.moves):,} | {len(path):,} | {best:.3f} | {moves:,.0f} | {segments:,.0f} "
            f"| {WANTED:,} {verdict} |"
        )


if __name__ == "__main__":
    main()
