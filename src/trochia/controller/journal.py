"""What happened, kept so that a power cut cannot take it away.

In: entries, as the controller makes them.  Out: a folder of files of lines, each line one JSON object behind its
check sum.  A line is with the operating system as soon as it is written (so a killed process loses none), and on the
disk within :data:`FLUSH` seconds.  The oldest file is dropped when there are :data:`FILES` full ones.
"""

from __future__ import annotations

import os
import zlib
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import msgspec

from trochia.errors import RecordingError

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

FORMAT_VERSION = 1
FLUSH = 0.5  #: longest time an entry may wait for the disk [s]
BYTES = 8 << 20  #: of a file: some 50 minutes of a job's points
FILES = 8  #: kept, at most

_decode = msgspec.json.Decoder(dict[str, Any]).decode
_encode = msgspec.json.Encoder().encode


def line_of(entry: Mapping[str, Any]) -> bytes:
    """Return an entry as a line: check sum, blank, JSON."""
    text = _encode(entry)
    return b"%08x %s\n" % (zlib.crc32(text), text)


def entry_of(line: bytes) -> dict[str, Any] | None:
    """Return the entry of a line, or None when it is damaged or cut."""
    if len(line) < 10 or not line.endswith(b"\n"):
        return None
    try:
        good = int(line[:8], 16) == zlib.crc32(line[9:-1])
        return _decode(line[9:-1]) if good else None
    except (ValueError, msgspec.DecodeError):
        return None


@dataclass(slots=True)
class Journal:
    """The journal of one machine, open for writing at its end.

    Parameters
    ----------
    folder
        Made where it is missing.

    Raises
    ------
    RecordingError
        When the folder cannot be written.
    """

    folder: Path
    bytes_a_file: int = BYTES
    _file: int = field(init=False, default=-1)
    _size: int = field(init=False, default=0)
    _number: int = field(init=False, default=0)
    _flushed: float = field(init=False, default=0.0)
    _waiting: bool = field(init=False, default=False)

    def __post_init__(self) -> None:
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            numbers = [number for number, _ in files(self.folder)]
            self._number = max(numbers, default=0)  # a new file: the last one may end in half a line
            self._next()
        except OSError as error:
            raise RecordingError(f"the journal {self.folder} cannot be written: {error.strerror}") from error

    def write(self, kind: str, time: float, **data: Any) -> None:  # noqa: ANN401 - any JSON value
        """Add an entry: its kind, the controller's time [s], and what else there is to say."""
        line = line_of({"kind": kind, "time": time} | data)
        if self._size + len(line) > self.bytes_a_file:
            self._next()
        os.write(self._file, line)
        self._size += len(line)
        self._waiting = True

    def flush(self, now: float, *, force: bool = False) -> None:
        """Bring what waits to the disk, if it is time (``now`` [s], of any steady clock)."""
        if self._waiting and (force or now - self._flushed >= FLUSH):
            os.fdatasync(self._file)
            self._waiting = False
            self._flushed = now

    def close(self) -> None:
        """Bring everything to the disk and close."""
        if self._file >= 0:
            self.flush(0.0, force=True)
            os.close(self._file)
            self._file = -1

    def _next(self) -> None:
        """Begin a new file, and drop the oldest beyond those that are kept."""
        if self._file >= 0:
            os.fdatasync(self._file)
            os.close(self._file)
        self._number += 1
        path = self.folder / f"{self._number:08d}.log"
        self._file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_APPEND, 0o600)
        self._size = 0
        first = line_of({"kind": "journal", "format": FORMAT_VERSION})
        self._size = os.write(self._file, first)
        for _, old in files(self.folder)[:-FILES]:
            old.unlink()
        folder = os.open(self.folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            os.fsync(folder)  # else a power cut may take the new file's name
        finally:
            os.close(folder)


def files(folder: Path) -> list[tuple[int, Path]]:
    """Return the files of a journal with their numbers, oldest first."""
    return sorted((int(path.stem), path) for path in folder.glob("*.log") if path.stem.isdigit())


def entries(folder: Path) -> Iterator[dict[str, Any]]:
    """Yield the entries of a journal that are whole, oldest first.

    Raises
    ------
    RecordingError
        When a file was written by a newer version.
    """
    for _, path in files(folder):
        with path.open("rb") as file:
            for line in file:
                entry = entry_of(line)
                if entry is None:
                    continue
                if entry["kind"] == "journal":
                    if entry["format"] > FORMAT_VERSION:
                        raise RecordingError(f"{path}: format {entry['format']}, this version reads {FORMAT_VERSION}")
                    continue
                yield entry
