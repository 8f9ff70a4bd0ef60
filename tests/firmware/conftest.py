"""Builds images and the simulated chip on demand; skips where their tools are not installed."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from trochia.backends.simulated_chip import SimulatedChip

if TYPE_CHECKING:
    from collections.abc import Callable

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


@pytest.fixture(scope="session")
def symbols() -> Callable[[Path], dict[str, int]]:
    """Addresses of an image's variables in data memory."""

    def read(path: Path) -> dict[str, int]:
        text = subprocess.run(["avr-nm", path], capture_output=True, text=True, check=True).stdout
        rows = (line.split() for line in text.splitlines())
        return {row[2]: int(row[0], 16) & 0xFFFF for row in rows if len(row) == 3 and int(row[0], 16) >= 0x800000}

    return read
