"""Builds images and the simulated chip on demand; skips where their tools are not installed."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

from trochia.backends.avr.live_avr import LiveAvr
from trochia.backends.avr.transports import ChipTransport
from trochia.backends.avr.wiring import BOARDS
from trochia.backends.simulated_chip import SimulatedChip
from trochia.backends.switches import switches_of
from trochia.controller.runtime import Runtime
from trochia.messages.command import Enable

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.machine.machine import Machine
    from trochia.messages import AnyCommand

ROOT = Path(__file__).resolve().parents[2]
FIRMWARE = ROOT / "firmware"
PARTS = {"stepping": "step_isr.S"}  # what an image takes from the firmware beside the shared headers


@pytest.fixture(scope="session")
def image() -> Callable[[str], Path]:
    """Compiles an image of this folder by its name."""
    if shutil.which("avr-gcc") is None or not Path("/usr/lib/avr/include/avr/io.h").exists():
        pytest.skip("gcc-avr and avr-libc are not installed (packages-test.txt)")

    def build(name: str) -> Path:
        images = Path(__file__).with_name("images")
        make = sys.modules["chip_fixtures"].make
        make(FIRMWARE / "avr", f"FROM={images}", f"WITH={PARTS.get(name, '')}", f"../../build/avr/{name}.elf")
        return ROOT / "build" / "avr" / f"{name}.elf"

    return build


@pytest.fixture
def start(chip_program: Path, image: Callable[[str], Path], request: pytest.FixtureRequest):
    """Starts a chip with an image of this folder."""

    def begin(name: str) -> SimulatedChip:
        chip = SimulatedChip(chip_program, image(name))
        request.addfinalizer(chip.close)
        return chip

    return begin


class ChipBench:
    """A machine on a board's image, under the controller, turn by turn in virtual time."""

    def __init__(self, machine: Machine, line: ChipTransport) -> None:
        self.backend = LiveAvr(machine, line, board="uno-stepdir")
        self.backend.inputs.follow(switches_of(machine))
        self.runtime, self.now = Runtime(self.backend), 0.0
        self.velocities: list[np.ndarray] = []
        self.ok(Enable())
        self.until("idle")

    def ok(self, command: AnyCommand) -> str:
        answer = self.runtime.command(command, self.now)
        assert answer.ok, answer.reason
        return answer.told

    def refused(self, command: AnyCommand) -> str:
        answer = self.runtime.command(command, self.now)
        assert not answer.ok
        return answer.reason

    def until(self, state: str, most: float = 60.0) -> None:
        end = self.now + most
        while True:
            self.now = round(self.now + 0.005, 9)
            self.runtime.turn(self.now)
            it = self.runtime.controller
            self.velocities.append(np.abs(it.report.velocity))
            assert it.state.value != "alarm", it.alarms.latched
            assert self.now < end, it.state
            if it.state.value == state:
                return

    def steps(self) -> np.ndarray:
        """What the chip has made since power-up (motors,) [steps]."""
        return np.array(self.backend.status["position"][: len(self.backend.machine.joints)], float)


@pytest.fixture
def chip_bench(
    chip_program: Path, board_image: Callable[[str], Path], request: pytest.FixtureRequest
) -> Callable[[Machine], ChipBench]:
    """Puts a machine on a simulated Uno."""

    def begin(machine: Machine) -> ChipBench:
        line = ChipTransport(chip_program, board_image("uno-stepdir-1000000"), mcu=BOARDS["uno-stepdir"].mcu)
        made = ChipBench(machine, line)
        request.addfinalizer(made.runtime.close)
        return made

    return begin


@pytest.fixture(scope="session")
def symbols() -> Callable[[Path], dict[str, int]]:
    """Addresses of an image's variables in data memory."""

    def read(path: Path) -> dict[str, int]:
        text = subprocess.run(["avr-nm", path], capture_output=True, text=True, check=True).stdout
        rows = (line.split() for line in text.splitlines())
        return {row[2]: int(row[0], 16) & 0xFFFF for row in rows if len(row) == 3 and int(row[0], 16) >= 0x800000}

    return read
