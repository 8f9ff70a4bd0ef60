"""A recording that may go on for ever in bounded space: a folder of recordings, numbered, the oldest dropped.

In: blocks as they come.  Out: ``0001``, ``0002``, … in a folder, each a recording of its own.  Parts that follow each
other without a gap are read as one; a gap (between two triggers) begins another.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from trochia.errors import RecordingError
from trochia.recorder.sidecar import PARTIAL, SAMPLES, SIDECAR
from trochia.recorder.writer import RecordingWriter, discard

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from trochia.recorder.channel import Header

_FILES = {SAMPLES, SIDECAR, SIDECAR + ".new"}
PARTS = 8  #: that share the space


class RingWriter:
    """Parts of one recording in a folder.

    Parameters
    ----------
    path
        The folder.  Recordings in it are dropped at the first block; a folder that holds anything else is refused.
    limit
        Bytes all parts may take together; None: no bound.

    Raises
    ------
    RecordingError
        When the folder cannot be taken.
    """

    def __init__(self, path: str | Path, header: Header, *, limit: int | None) -> None:
        self.path = Path(path)
        self.header = header
        self.parts: list[tuple[Path, int]] = []  # those that are whole, with their bytes
        self.dropped = 0
        self._record = header.record.itemsize
        self._limit = limit
        self._most = math.inf if limit is None else max(limit // (PARTS * self._record), 1)  # samples a part
        self._number = 0
        self._part: RecordingWriter | None = None
        self._clear()

    @property
    def samples(self) -> int:
        """Number of samples in the part under way."""
        return 0 if self._part is None else self._part.samples

    def write(self, block: Mapping[str, NDArray[Any]], first: int) -> None:
        """Append a block whose first sample is number ``first``; one that does not follow on begins another part."""
        size = len(next(iter(block.values())))
        done = 0
        while done < size:
            part = self._part_for(first + done)
            room = int(min(self._most - part.samples, size - done))
            part.write({name: samples[done : done + room] for name, samples in block.items()})
            done += room

    def finish(self) -> None:
        """End the part under way; the next block begins another."""
        if self._part is None:
            return
        part, self._part = self._part, None
        part.header = replace(part.header, duration=max(part.samples - 1, 0) * part.header.period)
        part.__exit__(None, None, None)
        self.parts.append((part.path, part.samples * self._record))
        while self._limit is not None and len(self.parts) > 1 and self._taken() > self._limit - self._room():
            old, _ = self.parts.pop(0)
            discard(old)
            self.dropped += 1

    def _part_for(self, sample: int) -> RecordingWriter:
        """Return the part that a sample belongs into."""
        part = self._part
        if part is not None and (part.samples >= self._most or sample != self._next):
            self.finish()
            part = None
        if part is None:
            self._number += 1
            start = sample * self.header.period
            part = RecordingWriter(self.path / f"{self._number:04d}", replace(self.header, start=start))
            part.__enter__()  # it is left in finish
            self._part, self._first = part, sample
        return part

    @property
    def _next(self) -> int:
        """Number of the sample that would follow on."""
        assert self._part is not None
        return self._first + self._part.samples

    def _taken(self) -> int:
        return sum(size for _, size in self.parts)

    def _room(self) -> float:
        """Bytes to keep free for the part under way."""
        return self._most * self._record

    def _clear(self) -> None:
        """Drop the recordings in the folder; refuse one that holds anything else."""
        if self.path.exists() and not self.path.is_dir():
            raise RecordingError(f"{self.path} exists and is no folder", hint="Give another name.")
        there = list(self.path.iterdir()) if self.path.is_dir() else []
        for entry in there:
            if not (_number(entry) and entry.is_dir() and {file.name for file in entry.iterdir()} <= _FILES):
                raise RecordingError(f"{self.path} holds something else than recordings: {entry.name}",
                                     hint="Give another name or move it away.")  # fmt: skip
        for entry in there:
            discard(entry)
        self.path.mkdir(parents=True, exist_ok=True)


def parts_of(folder: Path) -> list[Path]:
    """Return the parts of a folder in their order, one that was cut short last."""
    if not folder.is_dir():
        return []
    found = [entry for entry in folder.iterdir() if _number(entry) and (entry / SIDECAR).is_file()]
    return sorted(found, key=_number)


def _number(entry: Path) -> int:
    """Return the number of a part; 0 where it is none."""
    name = entry.name.removesuffix(PARTIAL)
    return int(name) if name.isdigit() else 0
