"""Images that come with the package: which file is for which board.

``make images``, or an installation where avr-gcc is at hand, puts them into ``data/images``; a file's name is
BOARD-BAUD-SCHEMA.hex, the schema being the hash of the protocol it was compiled with.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from trochia.backends.avr.wiring import BOARDS
from trochia.errors import ConfigError, VersionMismatch
from trochia.kernels.link import SCHEMA

FOLDER = Path(__file__).parents[2] / "data" / "images"
BAUDS = (115_200, 1_000_000)


@dataclass(frozen=True, slots=True, kw_only=True)
class Image:
    """An image for a board, and what is known of it: its baud rate and the schema it was compiled with."""

    path: Path
    baud: int | None = None
    schema: int | None = None

    @property
    def size(self) -> int:
        """Bytes of flash it takes.

        Raises
        ------
        ConfigError
            When it is no Intel HEX file.
        """
        try:
            return sum(_data(line) for line in self.path.read_text("ascii").split())
        except (ValueError, IndexError) as error:
            raise ConfigError(f"{self.path} is no Intel HEX file: {error}") from None


def _data(line: str) -> int:
    """Return how many bytes of the image a record holds."""
    record = bytes.fromhex(line.removeprefix(":"))
    if not line.startswith(":") or len(record) != record[0] + 5 or sum(record) & 255:
        raise ValueError(f"the record {line[:20]!r} is damaged")
    return record[0] if record[3] == 0 else 0


def shipped(board: str, baud: int = BAUDS[0], *, folder: Path = FOLDER) -> Image:
    """Return the image of a board that came with the package.

    Raises
    ------
    ConfigError
        When there is none.
    VersionMismatch
        When it was compiled with another schema than this program.
    """
    found = sorted(folder.glob(f"{board}-{baud}-*.hex"), key=lambda path: path.stat().st_mtime)
    if not found:
        raise ConfigError(
            f"this installation has no image for {board} at {baud} baud: it was made where there was no avr-gcc",
            hint="Install gcc-avr and avr-libc, then `make images` (or install Trochia again); or name one: --image.",
        )
    schema = int(found[-1].stem.rsplit("-", 1)[1], 16)
    if schema != SCHEMA:
        raise VersionMismatch(
            f"{found[-1].name} was compiled with schema {schema:08x}, this program with {SCHEMA:08x}",
            hint="`make images` compiles it anew.",
        )
    return Image(path=found[-1], baud=baud, schema=schema)


def boards() -> str:
    """Return the names of all boards, for a person."""
    return ", ".join(sorted(BOARDS))
