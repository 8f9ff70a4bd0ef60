"""Streaming a program against planning it whole, first motion after Start, memory, and the work of a hold.

Programs are held in memory as moves.  The processor's time is measured: other work on the machine does not count.
"""

from __future__ import annotations

import time
import tracemalloc

import numpy as np

from bench_planner import chain
from harness import machine as processor
from trochia.machine.load import load
from trochia.planner import PROFILES, plan
from trochia.planner.live import LivePlan, StreamPlanner
from trochia.toolpath import build

TYPES = ("trapezoid", "s-curve")
MOVES = 1_000_000
HOLDS = 100
MORE = 1.2  #: times what the whole takes, streaming may take
SOON = 0.05  #: s from Start to the first portion


def programs() -> dict[str, np.ndarray]:
    u, k = np.arange(1, MOVES + 1) * 0.2, np.arange(MOVES)
    walk = np.cumsum(np.random.default_rng(1).normal(size=(MOVES, 3)) * 0.2, axis=0) % 300
    return {
        "curve": np.stack([100 * np.sin(u / 50), 80 * np.sin(u / 37), 10 * np.sin(u / 91)], axis=1),
        "random walk": walk,
        "hatch, 50 mm lines": np.stack([50.0 * ((k + 1) // 2 % 2), 0.1 * (k // 2), 0 * u], axis=1)[: MOVES // 10],
    }


def streamed(name: str, points: np.ndarray, profile: str) -> None:
    machine, program = load("reference-mill"), chain(points)
    begun = time.process_time()
    path = build(program, machine, continuity=PROFILES[profile].continuity)
    for _ in plan(path, machine, program=program, profile=profile).blocks():
        pass
    whole, first = time.process_time() - begun, 0.0
    del path
    begun = time.process_time()
    for portion in StreamPlanner([program], machine, profile=profile):
        first = first or time.process_time() - begun
        del portion
    stream = time.process_time() - begun
    met = "met" if stream <= MORE * whole and first <= SOON else "MISSED"
    row = f"{whole:.3f} | {stream:.3f} | {stream / whole:.2f} | {first:.4f} | {met}"
    print(f"| {profile} | {name} | {len(points):,} | {row} |")


def memory() -> None:
    machine = load("reference-mill")
    for count in (50_000, 200_000):
        program = chain(programs()["curve"][:count])
        tracemalloc.start()
        for portion in StreamPlanner([program], machine):
            del portion
        print(f"Greatest memory while streaming {count:,} moves: {tracemalloc.get_traced_memory()[1] / 1e6:.0f} MB")
        tracemalloc.stop()


def holds(profile: str) -> None:
    machine = load("reference-mill")
    for name, points in programs().items():
        program, taken, stops = chain(points[:4000]), [], []
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
        for name, points in programs().items():
            streamed(name, points, profile)
    print()
    memory()
    print("\nHolds\n\n| profile | program | mean stop s | longest s | mean work ms | most ms |")
    print("|---|---|---|---|---|---|")
    for profile in TYPES:
        holds(profile)


if __name__ == "__main__":
    main()
