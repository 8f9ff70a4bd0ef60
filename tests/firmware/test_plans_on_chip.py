"""Plans on a board's image: a raster's pixels and a finishing program's short moves, from G-code to pin edges."""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import trochia
from trochia.backends.avr.live_avr import LiveAvr
from trochia.backends.avr.transports import ChipTransport
from trochia.backends.live import Orders
from trochia.backends.segments import Segments, sampled
from trochia.kernels.link import executed

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from numpy.typing import NDArray

    from trochia.machine.machine import Machine
    from trochia.planner.trajectory import Trajectory

US = 16  # cycles
ROW = 0.004  # s
SLEW = 30.0  # 1/s: what is held must do to stop in, 17 ms of motion


@pytest.fixture
def machine() -> Machine:
    """A laser of 80 steps a millimetre, faster than the one that comes with the package."""
    made = trochia.load("laser")
    assert made.beam is not None
    return replace(
        made, io=(), beam=replace(made.beam, kind="power", full_power=1000.0, delay=0.0),
        axes=tuple(replace(axis, velocity=600.0, acceleration=8000.0) for axis in made.axes),
        joints=tuple(replace(joint, pulse_rate=None, backlash=0.0) for joint in made.joints),
    )  # fmt: skip


def rows(motion: Trajectory, machine: Machine) -> Segments:
    edges = np.unique(np.concatenate([block["t"] for block in motion.blocks()] + [[0.0, motion.duration]]))
    counts = np.maximum(np.ceil(np.diff(edges) / ROW), 1).astype(int)
    pieces = [np.linspace(a, b, n, endpoint=False) for a, b, n in zip(edges[:-1], edges[1:], counts, strict=True)]
    times = np.append(np.concatenate(pieces), motion.duration)
    times = times[np.append(True, np.diff(times) > 1e-9)]
    return sampled(motion, machine.kinematics.matrix, times, np.full(len(times) - 1, SLEW))


class Ran:
    """What became of a program: its rows, the spans it was sent as, the least rate, and the pins."""

    def __init__(self, text: str, machine: Machine, program: Path, image: Path) -> None:
        self.motion = trochia.plan(trochia.gcode(text, machine), machine).trajectory
        self.rows = rows(self.motion, machine)
        line: Any = ChipTransport(program, image)
        line.edges = []
        backend = LiveAvr(machine, line)
        backend.open(0.0)
        backend.order(Orders(enable=True, lit=True), 0.0)
        maker: Any = vars(backend)["_maker"]
        make, self.spans = maker.make, b""

        def kept(*arguments: Any) -> Any:
            span = make(*arguments)
            self.spans += b"" if span is None else span.payload
            return span

        maker.make = kept
        backend.order(Orders(segments=self.rows), 0.0)
        self.rate, report = 1.0, backend.poll(0.005)
        for now in np.arange(0.01, 2.0 * self.motion.duration + 0.3, 0.01):
            report = backend.poll(float(now))
            assert not report.troubles
            self.rate = min(self.rate, report.rate or 1.0)
        assert report.still
        backend.close()
        self.events: NDArray[np.void] = np.concatenate(line.edges)

    def steps_late(self, motor: int, pin: str) -> NDArray[np.int64]:
        done = executed(self.spans).pulses
        up = sys.modules["chip_motion"].edges(self.events, pin, 1)
        return up - done["tick"][done["pins"] >> motor & 1 == 1]


def raster(feed: float, pixels: int) -> str:
    """Pixels of 0.08 mm, each of another power."""
    powers = (np.arange(pixels) * 37 % 251 * 3 + 100).tolist()
    lines = [f"G1 X{10 + 0.08 * (i + 1):.2f} S{power}" for i, power in enumerate(powers)]
    return "\n".join(
        ["G21 G90 G94", "M4 S0", f"G1 F{feed} X10 S0", *lines, f"G1 X{20 + 0.08 * pixels:.2f} S0", "M5", "M2", ""]
    )


@pytest.mark.parametrize(("image", "hertz"), [("uno-stepdir-1000000", 5_000), ("uno-stepdir", 2_500)])
def test_a_rasters_pixels_are_where_they_were_planned(
    machine: Machine, chip_program: Path, board_image: Callable[[str], Path], image: str, hertz: float
):
    """One motor steps; the image's baud rate is 1,000,000 or 115,200.  Edges within 25 µs, at full rate all along."""
    ran = Ran(raster(hertz * 0.08 * 60, 600), machine, chip_program, board_image(image))
    late = ran.steps_late(0, "D2")
    assert ran.rate == 1.0
    assert late.max() - np.median(late) <= 10 * US
    starts = np.concatenate([[0.0], np.cumsum(ran.rows.duration)[:-1]])
    levels = np.round(255 * ran.rows.power / 1000.0).astype(int)
    changed = np.flatnonzero(np.diff(levels, prepend=0) != 0)
    planned = [(starts[i] * 16e6, int(levels[i])) for i in changed if levels[i]]
    assert len(planned) > 550
    seen = sys.modules["chip_motion"].duties(ran.events)
    assert [power for _, power in seen] == [power for _, power in planned]
    astray = np.array([cycle for cycle, _ in seen]) - np.median(late) - np.array([tick for tick, _ in planned])
    assert np.abs(astray).max() <= 25 * US


@pytest.mark.parametrize("image", ["uno-stepdir-1000000", "uno-stepdir"])
def test_two_thousand_moves_a_second_are_run_through_at_full_rate(
    machine: Machine, chip_program: Path, board_image: Callable[[str], Path], image: str
):
    """Chords of 0.1 mm along a wave, at 300 mm/s where it turns least; spans take many of them at once."""
    points = [f"G1 X{20 + 0.1 * i:.4f} Y{20 + 8 * math.sin(0.01 * i):.4f}" for i in range(1200)]
    text = "\n".join(["G21 G90 G94 G64", "G0 X20 Y20", "F18000", *points, "M2", ""])
    ran = Ran(text, machine, chip_program, board_image(image))
    assert len(points) / ran.motion.duration > 1_900
    assert ran.rate == 1.0
    for motor, pin in enumerate(("D2", "D3")):
        late = ran.steps_late(motor, pin)
        assert np.abs(late - np.median(late)).max() <= 12 * US
