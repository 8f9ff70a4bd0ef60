"""Writing a recording in blocks as they come.

In: a header and blocks of samples.  Out: a folder that carries its final name only when it is whole; until then it is
called ``NAME.partial`` and can be read up to the last whole record.
"""

from __future__ import annotations

import os
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from trochia.errors import RecordingError
from trochia.recorder.sidecar import PARTIAL, SAMPLES, SIDECAR, Description, encode, raw

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from types import TracebackType
    from typing import Self

    from numpy.typing import NDArray

    from trochia.recorder.channel import Header
    from trochia.recorder.recording import Recording


def pack(header: Header, block: Mapping[str, NDArray[Any]]) -> NDArray[Any]:
    """Return a block's records (samples,); every channel must be there, all equally long, and fit its dtype."""
    names = {channel.name for channel in header.channels}
    if set(block) != names:
        raise RecordingError(f"a block holds {sorted(block)}, the recording {sorted(names)}")
    lengths = {len(samples) for samples in block.values()}
    if len(lengths) > 1:
        raise RecordingError(f"a block's channels are equally long, not {sorted(lengths)} samples")
    records = np.zeros(lengths.pop() if lengths else 0, header.record)  # zeros: padding is part of the checksum
    for name, samples in block.items():
        if not np.can_cast(samples.dtype, records[name].dtype, "same_kind"):
            raise RecordingError(f"channel {name}: expected {records[name].dtype}, not {samples.dtype}")
        records[name] = samples
    return records


class RecordingWriter:
    """Context manager over one recording folder; leaving it without an error makes the folder whole.

    Parameters
    ----------
    path
        Folder to be made.  An older recording of that name is replaced at the end, anything else is refused.
    header
        What will be recorded.
    """

    def __init__(self, path: str | Path, header: Header) -> None:
        self.path = Path(path)
        self.header = header
        self.samples = 0
        self._crc = 0
        self._file: BinaryIO | None = None

    @property
    def partial(self) -> Path:
        """Folder in which the recording stands until it is whole."""
        return self.path.with_name(self.path.name + PARTIAL)

    def __enter__(self) -> Self:
        if self.path.exists() and not (self.path / SIDECAR).is_file():
            raise RecordingError(f"{self.path} exists and is no recording", hint="Give another name or move it away.")
        discard(self.partial)
        self.partial.mkdir(parents=True)
        self._file = (self.partial / SAMPLES).open("wb")  # before the sidecar: whoever is described can be read
        self._describe(Description(header=self.header, record=self.header.record))
        return self

    def write(self, block: Mapping[str, NDArray[Any]]) -> None:
        """Append a block: for every channel an array (samples,)."""
        assert self._file is not None, "write() belongs inside the with statement"
        records = pack(self.header, block)
        self._crc = zlib.crc32(raw(records), self._crc)
        self._file.write(raw(records))
        self._file.flush()  # the block is with the operating system when this returns: our own crash loses none
        self.samples += len(records)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        assert self._file is not None
        if kind is None:
            os.fsync(self._file.fileno())
        self._file.close()
        if kind is None:
            self._describe(
                Description(header=self.header, record=self.header.record, samples=self.samples, crc32=self._crc)
            )
            _replace(self.partial, self.path)

    def _describe(self, description: Description) -> None:
        """Put the sidecar down whole: a crash leaves the old one or the new one."""
        fresh = self.partial / (SIDECAR + ".new")
        fresh.write_bytes(encode(description))
        fresh.replace(self.partial / SIDECAR)


def write(path: str | Path, header: Header, blocks: Iterable[Mapping[str, NDArray[Any]]]) -> None:
    """Write a recording from blocks as they come; nothing but the present block is held in memory."""
    with RecordingWriter(path, header) as writer:
        for block in blocks:
            writer.write(block)


def save(path: str | Path, recording: Recording) -> None:
    """Write a recording that is in memory."""
    write(path, recording.header, [recording.channels])


def _replace(source: Path, target: Path) -> None:
    """Give a folder its final name; an older one of that name goes after the new one has come."""
    old = target.with_name(target.name + ".old")
    if target.exists():
        discard(old)
        target.rename(old)
    source.rename(target)
    discard(old)


def discard(folder: Path) -> None:
    """Remove a recording's folder, and nothing that is not a recording's; the sidecar first: half gone is gone."""
    if folder.is_dir():
        for name in (SIDECAR, SIDECAR + ".new", SAMPLES):
            (folder / name).unlink(missing_ok=True)
        folder.rmdir()
