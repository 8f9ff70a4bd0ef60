"""Whole jobs on a board's image, under the controller: each baud rate in turn, the chip simulated cycle for cycle.

    python benchmarks/bench_chip.py                      # hatch, contour, a finishing pass of 20,000 segments
    python benchmarks/bench_chip.py FILE MACHINE BAUD    # one program

Out: whether it came to its end, steps counted by the board against the plan's, time against the plan's, tick segments
and moves a second, how often and how far the board lowered its rate because its queue was low, in feeds and in rapids.
All by the chip's own time, so nothing depends on the computer.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np

from trochia import api
from trochia.backends.avr.ahead import spans_ahead
from trochia.backends.avr.live_avr import LiveAvr
from trochia.backends.avr.simulator import simulated
from trochia.backends.avr.wiring import BOARDS, steps_per_unit
from trochia.controller.runtime import PERIOD, Runtime
from trochia.messages import command as c
from trochia.program import MoveKind

ROOT = Path(__file__).parents[1]
BOARD = "uno-stepdir"
BAUDS = (115_200, 1_000_000)
FULL_RATE = 32768
RUNNING = 2  #: the image's state while it moves
ENDED = frozenset({"idle", "alarm", "estop", "off"})


class Job(NamedTuple):
    """A program, its machine, and the board's baud rate."""

    name: str
    text: str
    machine: str
    baud: int


def finishing(segments: int = 20_000) -> str:
    """Return a finishing pass: to and fro over a wavy surface, a tenth of a millimetre a segment."""
    each = 500
    lines = ["G21 G90 G64 P0.01 F1200", "G0 X5 Y5 Z0"]
    for row in range(segments // each):
        x = 5.0 + 0.1 * np.arange(1, each + 1)
        x = x if row % 2 == 0 else 60.0 - x
        y = np.full(each, 5.0 + 0.2 * row)
        z = -1.0 - 0.4 * np.sin(x / 4.0) * np.cos(y / 4.0)
        lines += [f"G1 X{a:.4f} Y{b:.4f} Z{d:.4f}" for a, b, d in zip(x, y, z, strict=True)]
    return "\n".join([*lines, "M2", ""])


def run(job: Job) -> str:
    """Return a row of the table: what became of a job."""
    machine = api.load(job.machine)
    program = api.gcode(job.text, machine)
    plan = api.plan(program, machine)
    spans = sum(1 for _ in spans_ahead(plan.trajectory, machine, BOARD))
    rapid = {int(line) for line in program.moves["line"][program.moves["kind"] == MoveKind.RAPID]}
    moves = LiveAvr(machine, simulated(BOARD, baud=job.baud))
    runtime, now = Runtime(moves, now=0.0), 0.0
    low: dict[bool, list[float]] = {True: [1.0], False: [1.0]}  # rates below 1, in rapids and in feeds

    def turn() -> None:
        nonlocal now
        now += PERIOD
        runtime.turn(now)
        if moves.status is not None and int(moves.status["state"]) == RUNNING:
            rate = int(moves.status["rate"]) / FULL_RATE
            if rate < 1.0:
                low[runtime.status.program is not None and runtime.status.program.line in rapid].append(rate)

    def do(command: c.AnyCommand, most: float) -> None:
        answer = runtime.command(command, now)
        if not answer.ok:
            raise SystemExit(answer.reason)
        begun = now
        turn()
        turn()
        while runtime.status.state not in ENDED and now - begun < most:
            turn()

    do(c.Enable(), 1.0)
    if not all(axis.trusted for axis in runtime.status.axes):
        do(c.Home(), 200.0)
    do(c.ArmBeam(on=True), 1.0)
    do(c.Load(name="job", text=job.text), 1.0)
    before, begun = moves.status["position"].astype(np.int64), now
    start = machine.kinematics.matrix @ np.array(list(runtime.controller.position().values()))
    do(c.Run(), 3.0 * plan.time_s + 30.0)
    taken, status = now - begun, runtime.status
    end = machine.kinematics.matrix @ plan.trajectory.position(np.array([plan.trajectory.duration]))[0]
    wanted = np.round((end - start) * steps_per_unit(machine, BOARDS[BOARD].motors)[: len(end)])
    off = np.abs((moves.status["position"].astype(np.int64) - before)[: len(end)] - wanted).max()
    runtime.close()
    feeds, rapids = (
        f"{100 * len(low[kind]) * PERIOD / taken:.1f} % of the time, to {min(low[kind]):.2f}" for kind in (False, True)
    )
    ended = ", ".join(alarm.message for alarm in status.alarms) or status.state
    return (
        f"| {job.name} | {job.baud:,} | {ended} | {plan.time_s:.1f} | {taken:.1f} | {len(program.moves) / taken:,.0f} "
        f"| {spans / taken:,.0f} | {feeds} | {rapids} | {off:.0f} |"
    )


def main() -> None:
    """Run what is asked for."""
    print(
        "| program | baud | ended | plan [s] | taken [s] | moves/s | tick segments/s "
        "| slower in feeds | slower in rapids | steps off |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|")
    if len(sys.argv) > 3:
        text = Path(sys.argv[1]).read_text()
        print(run(Job(Path(sys.argv[1]).stem, text, sys.argv[2], int(sys.argv[3]))))
        return
    jobs = [(name, (ROOT / f"programs/{name}.ngc").read_text(), "belt-stage") for name in ("hatch", "contour")]
    for name, text, machine in [*jobs, ("finishing, 20,000 segments", finishing(), "reference-mill")]:
        for baud in BAUDS:
            print(run(Job(name, text, machine, baud)), flush=True)


if __name__ == "__main__":
    main()
