"""A board's image on a simulated chip, made on demand: for tests, for teachers, for whoever has no board at hand.

In: a board's name.  Out: a transport to it.  The simulator is a program of its own on libsimavr, compiled from
``firmware/sim``, and so is the image, from ``firmware/avr``: both need Trochia's sources and the tools of Debian.
"""

from __future__ import annotations

import fcntl
import subprocess
import time
from pathlib import Path

from trochia.backends.avr.images import BAUDS
from trochia.backends.avr.transports import ChipTransport
from trochia.backends.avr.wiring import BOARDS
from trochia.errors import ConfigError

ROOT = Path(__file__).resolve().parents[4]  #: of Trochia's sources, where it runs from them
BEAT = 0.004  #: most that an unhurried clock goes on from one look to the next [s]
_TOOLS = "sudo apt-get install gcc-avr avr-libc libsimavr-dev libelf-dev make gcc"


def simulated(board: str, *, baud: int = BAUDS[0], root: Path = ROOT) -> ChipTransport:
    """Return a transport to a board's image at its reset, compiled first where that is needed.

    Raises
    ------
    ConfigError
        Where sources or tools are not there, or there is no image for that baud rate.
    """
    if baud not in BAUDS:
        raise ConfigError(f"there are images for {BAUDS[0]} and {BAUDS[1]} baud, not {baud}", key="--baud")
    if not (root / "firmware" / "sim").is_dir():
        raise ConfigError("the simulated chip is compiled from Trochia's sources, and they are not here",
                          hint="Run it from a clone of the repository, installed with `make venv`.")  # fmt: skip
    name = board if baud == BAUDS[0] else f"{board}-{baud}"
    (root / "build").mkdir(exist_ok=True)
    with (root / "build" / ".firmware.lock").open("w") as lock:  # two that begin at once
        fcntl.flock(lock, fcntl.LOCK_EX)
        _make(root / "firmware" / "sim")
        _make(root / "firmware" / "avr", f"../../build/avr/{name}.elf")
    program, image = root / "build" / "sim" / "chip", root / "build" / "avr" / f"{name}.elf"
    return ChipTransport(program, image, baud=baud, mcu=BOARDS[board].mcu)


def _make(folder: Path, *targets: str) -> None:
    command = ["make", "-s", "-C", str(folder), *targets]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603 - our own make
    except OSError as error:
        raise ConfigError(f"make cannot be run: {error.strerror}", hint=_TOOLS) from None
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["make failed"])[0]
        raise ConfigError(f"the simulated chip cannot be compiled: {last}", hint=_TOOLS)


class UnhurriedClock:
    """A clock that keeps to the wall's as long as it is looked at often, and else falls behind it.

    A simulated chip may be slower than a real one; whoever ran it by the wall's clock would have ever more to catch
    up with.  By this one, time stands still where the computer has none for the chip, and nobody notices inside.
    """

    def __init__(self) -> None:
        self._now = self._wall = time.monotonic()

    def __call__(self) -> float:
        """Return the time [s]; at most ``BEAT`` later than at the last look."""
        wall = time.monotonic()
        self._now += min(wall - self._wall, BEAT)
        self._wall = wall
        return self._now
