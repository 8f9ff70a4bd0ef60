"""Start of a program of a million lines on the twin: first motion, what the turns take meanwhile, start after a jog.

The controller's thread runs by the real clock, as it does in service, with a journal.
"""

from __future__ import annotations

import tempfile
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness import machine as processor
from trochia.backends.live_twin import LiveTwin
from trochia.controller.runtime import Runtime
from trochia.machine.load import load
from trochia.messages.command import Abort, Enable, Hold, JogBy, Load, Run

if TYPE_CHECKING:
    from trochia.backends.live import Orders

LINES = 1_000_000
SOON = 0.05  #: s from Start to the first motion


def text(lines: int) -> str:
    """Return a curve in chords of 0.2 mm as G-code."""
    u = np.arange(1, lines) * 0.2
    points = np.stack([60 * np.sin(u / 50), 60 * np.sin(u / 37), 9 * np.sin(u / 91) - 9], axis=1).round(4)
    return "G21 G90 G64 P0.01\nF3000\n" + "".join(f"G1 X{x:g} Y{y:g} Z{z:g}\n" for x, y, z in points.tolist()) + "M2\n"


class Watched(LiveTwin):
    """A twin that notes when the first segments came."""

    first: float | None = None

    def order(self, orders: Orders, now: float) -> None:
        """Take orders."""
        if orders.segments is not None and self.first is None:
            self.first = time.monotonic()
        super().order(orders, now)


class Turns(Runtime):
    """A runtime that notes what its turns take: by the clock and of the processor [s]."""

    def __init__(self, twin: Watched, journal: Path) -> None:
        super().__init__(twin, journal=journal, now=time.monotonic())
        self.clock, self.processor = 0.0, 0.0

    def turn(self, now: float):  # noqa: ANN201 - as the base's
        """Take a turn."""
        began, used = time.monotonic(), time.thread_time()
        status = super().turn(now)
        self.clock = max(self.clock, time.monotonic() - began)
        self.processor = max(self.processor, time.thread_time() - used)
        return status


def done(runtime: Turns, twin: Watched, what: str, *commands: object) -> None:
    """Print what commands, one after the other, took, and the turns until then."""
    twin.first, runtime.clock, runtime.processor = None, 0.0, 0.0
    began = time.monotonic()
    for command in commands:
        answer = runtime.send(command).result(60.0)  # type: ignore[arg-type]
        assert answer.ok, answer.reason
    answered = time.monotonic() - began
    threading.Event().wait(0.1)
    first = "-" if twin.first is None else f"{1e3 * (twin.first - began):.1f}"
    row = f"{1e3 * answered:.1f} | {first} | {1e3 * runtime.clock:.1f} | {1e3 * runtime.processor:.1f}"
    print(f"| {what} | {row} |")


def until(runtime: Turns, *states: str) -> None:
    """Wait for a state."""
    while runtime.status.state not in states:
        threading.Event().wait(0.01)


def main() -> None:
    machine, program = load("reference-mill"), text(LINES)
    print(f"\nStart of {LINES:,} lines, limit {1e3 * SOON:.0f} ms ({processor()})\n")
    print("| what | answered ms | first segments ms | longest turn ms | … of the processor ms |")
    print("|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        twin = Watched(machine, position=np.zeros(len(machine.joints)))
        runtime = Turns(twin, Path(folder))
        for axis in runtime.controller.trusted:
            runtime.controller.trusted[axis] = True
        runtime.start()
        done(runtime, twin, "enable", Enable())
        done(runtime, twin, "load: read, planned, kept", Load(name="curve.ngc", text=program))
        done(runtime, twin, "start of the checked program", Run())
        runtime.send(Hold()).result()
        until(runtime, "held")
        done(runtime, twin, "abort", Abort())
        until(runtime, "idle")
        done(runtime, twin, "jog by 5 mm", JogBy(way={"X": 5.0}))
        until(runtime, "idle")
        done(runtime, twin, "start after the jog: planned anew", Run())
        runtime.send(Hold()).result()
        until(runtime, "held")
        runtime.close()


if __name__ == "__main__":
    main()
