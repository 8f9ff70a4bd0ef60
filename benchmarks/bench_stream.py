"""Streaming a program against planning it whole, first motion after Start, memory, and the work of a hold.

Whole and streamed take turns in the same call; the best of each counts.  Programs are held in memory as moves.  The
processor's time is measured: other work on the machine does not count.
"""

from __future__ import annotations

import time
import tracemalloc
from typing import TYPE_CHECKING

import numpy as np

import shapes
from bench_planner import chain
from harness import machine as processor
from trochia.machine.load import load
from trochia.planner import PROFILES, path_of, plan
from trochia.planner.live import LivePlan, StreamPlanner
from trochia.toolpath import build

if TYPE_CHECKING:
    from trochia.machine.machine import Machine
    from trochia.program import Program

TYPES = ("trapezoid", "s-curve")
MOVES = 1_000_000
RUNS = 4  #: of each, taking turns; the first pays for memory that the system hands out for the first time
HOLDS = 50
MORE = 1.2  #: times what the whole takes, streaming may take
SOON = 0.05  #: s from Start to the first portion


def programs(most: int = MOVES) -> dict[str, Program]:
    u, k = np.arange(1, most + 1) * 0.2, np.arange(most)
    walk = np.cumsum(np.random.default_rng(1).normal(size=(most, 3)) * 0.2, axis=0) % 300
    short = most // 10
    return {
        "curve": chain(np.stack([100 * np.sin(u / 50), 80 * np.sin(u / 37), 10 * np.sin(u / 91)], axis=1)),
        "random walk": chain(walk),
        "lines and bends": shapes.chain(shapes.mixed(short)),
        "zig-zag, 1 mm": shapes.chain(shapes.zigzag(short)),
        "hatch, 15 mm": shapes.chain(shapes.hatch(short)),
        "hatch, 50 mm": chain(np.stack([50.0 * ((k + 1) // 2 % 2), 0.1 * (k // 2), 0 * u], axis=1)[:short]),
    }


def whole(machine: Machine, program: Program, profile: str) -> float:
    """Return the processor time [s] of planning a program as a whole, to its phases."""
    begun = time.process_time()
    path = path_of(program, machine, PROFILES[profile])
    for _ in plan(path, machine, program=program, profile=profile).blocks():
        pass
    return time.process_time() - begun


def streamed(machine: Machine, program: Program, profile: str) -> tuple[float, float]:
    """Return the processor time [s] of streaming a program, and that to its first portion."""
    begun, first = time.process_time(), 0.0
    for portion in StreamPlanner([program], machine, profile=profile):
        first = first or time.process_time() - begun
        del portion
    return time.process_time() - begun, first


def compared(name: str, program: Program, profile: str) -> None:
    machine = load("reference-mill")
    runs = RUNS if profile == "trapezoid" else RUNS - 1
    rows = [(whole(machine, program, profile), *streamed(machine, program, profile)) for _ in range(runs)]
    least, stream, first = np.array(rows).min(axis=0)
    met = "met" if stream <= MORE * least and first <= SOON else "MISSED"
    row = f"{least:.3f} | {stream:.3f} | {stream / least:.2f} | {first:.4f} | {met}"
    print(f"| {profile} | {name} | {len(program.moves):,} | {row} |")


def starts() -> None:
    """Print what passes between Start of a checked program of a million lines and its first segments."""
    machine, program = load("reference-mill"), programs()["curve"]
    print(
        "\n| profile | moves | LivePlan s | first 0.2 s of motion s | together s | target |\n|---|---|---|---|---|---|"
    )
    for profile in TYPES:
        path = build(program, machine, continuity=PROFILES[profile].continuity)
        checked = plan(path, machine, program=program, profile=profile)
        times = []
        for _ in range(RUNS):
            begun = time.process_time()
            live = LivePlan.of(checked, machine)
            ready = time.process_time()
            out = list(live.portions(0.0, 0.2))
            times.append((ready - begun, time.process_time() - ready))
            assert out
        made, out_s = np.array(times).min(axis=0)
        row = f"{made:.4f} | {out_s:.4f} | {made + out_s:.4f} | {'met' if made + out_s <= SOON else 'MISSED'}"
        print(f"| {profile} | {len(program.moves):,} | {row} |")


def memory() -> None:
    machine = load("reference-mill")
    for count in (50_000, 200_000):
        program = programs(count)["curve"]
        tracemalloc.start()
        for portion in StreamPlanner([program], machine):
            del portion
        print(f"Greatest memory while streaming {count:,} moves: {tracemalloc.get_traced_memory()[1] / 1e6:.0f} MB")
        tracemalloc.stop()


def holds(profile: str) -> None:
    machine = load("reference-mill")
    for name, program in programs(4000).items():
        taken, stops = [], []
        path = build(program, machine, continuity=PROFILES[profile].continuity)
        whole = plan(path, machine, program=program, profile=profile)
        for t in np.random.default_rng(2).uniform(0.0, min(whole.duration, 20.0), HOLDS):
            live = LivePlan.of(whole, machine)
            live.state(float(t))
            begun = time.process_time()
            stops.append(live.hold(float(t)) - t)
            taken.append(time.process_time() - begun)
        print(
            f"| {profile} | {name} | {np.mean(stops):.3f} | {np.max(stops):.3f} "
            f"| {1e3 * np.mean(taken):.1f} | {1e3 * np.max(taken):.1f} |"
        )


def main() -> None:
    print(f"\nStreaming ({processor()})\n")
    print("| profile | program | moves | whole s | stream s | ratio | first motion s | target |")
    print("|---|---|---|---|---|---|---|---|")
    for profile in TYPES:
        most = MOVES if profile == "trapezoid" else MOVES // 5
        for name, program in programs(most).items():
            compared(name, program, profile)
    starts()
    print()
    memory()
    print("\nHolds\n\n| profile | program | mean stop s | longest s | mean work ms | most ms |")
    print("|---|---|---|---|---|---|")
    for profile in TYPES:
        holds(profile)


if __name__ == "__main__":
    main()
