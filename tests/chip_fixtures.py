"""Builds the simulated chip and the boards' images on demand; skips where their tools are not installed."""

from __future__ import annotations

import fcntl
import shutil
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

ROOT = Path(__file__).resolve().parents[1]
FIRMWARE = ROOT / "firmware"


def make(folder: Path, *arguments: str) -> None:
    """Run make, one at a time: several workers may ask for the same file."""
    (ROOT / "build").mkdir(exist_ok=True)
    with (ROOT / "build" / ".firmware.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        done = subprocess.run(["make", "-s", "-C", folder, *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="session")
def chip_program() -> Path:
    """The simulated chip as a program."""
    if not Path("/usr/include/simavr/sim_avr.h").exists() or not Path("/usr/include/libelf.h").exists():
        pytest.skip("libsimavr-dev and libelf-dev are not installed (packages-test.txt)")
    make(FIRMWARE / "sim")
    return ROOT / "build" / "sim" / "chip"


@pytest.fixture(scope="session")
def board_image() -> Callable[[str], Path]:
    """Compiles the image of a board by its name."""
    if shutil.which("avr-gcc") is None or not Path("/usr/lib/avr/include/avr/io.h").exists():
        pytest.skip("gcc-avr and avr-libc are not installed (packages-test.txt)")

    def build(name: str) -> Path:
        make(FIRMWARE / "avr", f"../../build/avr/{name}.elf")
        return ROOT / "build" / "avr" / f"{name}.elf"

    return build
