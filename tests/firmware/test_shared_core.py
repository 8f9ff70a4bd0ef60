"""The shared core on the chip gives the numbers it gives on the host, bit for bit."""

from __future__ import annotations

import struct
from types import SimpleNamespace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from trochia.backends.simulated_chip import ChipRun, SimulatedChip
from trochia.kernels.interpolate import METHODS, Begun
from trochia.kernels.ticks import SEGMENT, Ramp, SegmentRun, speed_move

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

ROOM = 160  # intervals the image keeps
PATIENCE = 4_000_000  # cycles an answer may take


@pytest.fixture(scope="module")
def chip(chip_program: Path, image: Callable[[str], Path], symbols: Callable[[Path], dict[str, int]]):
    elf = image("shared")
    simulated, places = SimulatedChip(chip_program, elf), symbols(elf)

    def ask(number: int, **variables: bytes) -> ChipRun:
        for name, value in variables.items():
            simulated.write_memory(places[name], value)
        at = simulated.run_until(0).cycle
        simulated.write_memory(places["request"], bytes([number]))
        for _ in range(20):
            done = simulated.run_until(at + PATIENCE)
            if simulated.read_memory(places["request"], 1) == b"\0":
                return done
            at = done.cycle
        raise AssertionError("no answer")

    def answers(kind: str) -> list[int]:
        (count,) = struct.unpack("<H", simulated.read_memory(places["answered"], 2))
        size = struct.calcsize(kind)
        return list(struct.unpack(f"<{count}{kind}", simulated.read_memory(places["answers"], count * size)))

    simulated.run_until(20_000)  # past the start-up code, which clears the memory
    with simulated:
        yield SimpleNamespace(ask=ask, answers=answers)


@pytest.mark.parametrize("seed", range(24))
def test_ramp(chip: SimpleNamespace, seed: int):
    rng = np.random.default_rng(seed)
    per_step = int(2 ** rng.uniform(0, 60))
    square = int(rng.choice([0, int(2 ** rng.uniform(0, 61))]))
    up = int(min(rng.integers(1, ROOM // 2), (2**62 - 1 - square) // per_step))
    down = int(rng.integers(0, up + 1))
    chip.ask(1, squares=struct.pack("<QQ", per_step, square), counts=struct.pack("<4I", up, 0, down, 0))
    host = Ramp(per_step, square)
    assert chip.answers("I") == host.up(up).tolist() + host.down(down).tolist()


@pytest.mark.parametrize("seed", range(12))
def test_move(chip: SimpleNamespace, seed: int):
    rng = np.random.default_rng(100 + seed)
    up, down = (int(2 ** rng.uniform(10, 52)) for _ in range(2))
    counts = tuple(int(n) for n in rng.integers(0, ROOM // 3, 3))
    at = int(2 ** rng.uniform(8, 32))
    chip.ask(2, squares=struct.pack("<QQ", up, down), counts=struct.pack("<4I", *counts, at))
    assert chip.answers("I") == speed_move(up, down, counts, at)[0].tolist()


@pytest.mark.parametrize("seed", range(24))
def test_segments(chip: SimpleNamespace, seed: int):
    rng = np.random.default_rng(200 + seed)
    rows = np.zeros(int(rng.integers(1, 7)), SEGMENT)
    rows["interval"] = (2 ** rng.uniform(0, 32, rows.size)).astype(np.uint32)
    for name in ("add", "add2"):
        rows[name] = rng.integers(-(2**31), 2**31, rows.size) >> rng.integers(0, 31, rows.size)
    rows["count"], rows["stride"] = rng.integers(1, 26, rows.size), rng.integers(1, 20, rows.size)
    rows["flags"] = 4 * rng.integers(0, 3, rows.size) + rng.integers(0, 2, rows.size)
    chip.ask(3, rows=rows.tobytes(), row_count=bytes([rows.size]))
    assert chip.answers("I") == SegmentRun().intervals(rows).tolist()


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("end", [(90, 37), (-41, 200), (0, -60)])
def test_lines(chip: SimpleNamespace, method: str, end: tuple[int, int]):
    chip.ask(4, figure=struct.pack("<6i", METHODS[method], 0, *end, 0, 0))
    assert chip.answers("B") == Begun.line(METHODS[method], *end).pulses().tolist()


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("clockwise", [False, True])
@pytest.mark.parametrize("ends", [((100, 0), (0, 100)), ((30, -40), (-48, 14)), ((0, 65), (0, 65))])
def test_arcs(chip: SimpleNamespace, method: str, ends: tuple[tuple[int, int], tuple[int, int]], *, clockwise: bool):
    start, end = ends
    square = start[0] ** 2 + start[1] ** 2
    figure = struct.pack("<6i", METHODS[method], clockwise, *start, *end)
    chip.ask(5, squares=struct.pack("<QQ", square, 0), figure=figure)
    pulses = Begun.arc(METHODS[method], start, end, square, clockwise=clockwise).pulses()
    assert chip.answers("B") == pulses[: 4 * ROOM].tolist()
