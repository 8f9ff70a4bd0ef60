"""Reading a recording: the samples are mapped, not loaded, so an hour's recording opens at once."""

from __future__ import annotations

import zlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.errors import RecordingError
from trochia.recorder.recording import Recording
from trochia.recorder.sidecar import PARTIAL, SAMPLES, SIDECAR, decode, raw

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.recorder.sidecar import Description


def read(path: str | Path, *, verify: bool = False) -> Recording:
    """Return the recording in a folder; one that was cut short ends at its last whole record.

    Parameters
    ----------
    path
        Folder, or the ``recording.json`` in it.
    verify
        Read every sample and hold it against the checksum.

    Raises
    ------
    RecordingError
        When there is no recording, or it is foreign, newer than this program, or damaged.
    """
    folder = _folder(Path(path))
    description = decode(folder / SIDECAR)
    records = _records(folder / SAMPLES, description)
    if verify and description.crc32 is not None and zlib.crc32(raw(records)) != description.crc32:
        raise RecordingError(
            f"{folder / SAMPLES}: damaged: the samples do not have the checksum they were written with"
        )
    return Recording(
        header=description.header,
        channels={channel.name: records[channel.name] for channel in description.header.channels},
        complete=description.samples is not None,
    )


def _folder(path: Path) -> Path:
    folder = path.parent if path.name == SIDECAR else path
    if (folder / SIDECAR).is_file():
        return folder
    unfinished = folder.with_name(folder.name + PARTIAL)
    raise RecordingError(
        f"{path}: no recording: it has no {SIDECAR}",
        hint=f"One that was cut short is at {unfinished}." if (unfinished / SIDECAR).is_file() else None,
    )


def _records(path: Path, description: Description) -> NDArray[Any]:
    """Return the records mapped from the file (samples,), after holding its size against what the sidecar promises."""
    if not path.is_file():
        raise RecordingError(f"{path}: damaged: the samples are missing")
    size, record = path.stat().st_size, description.record
    samples = size // record.itemsize if description.samples is None else description.samples
    if description.samples is not None and size != samples * record.itemsize:
        raise RecordingError(
            f"{path}: damaged: {samples} samples take {samples * record.itemsize} bytes, the file has {size}"
        )
    if samples == 0:
        return np.empty(0, record)  # an empty file cannot be mapped
    return np.asarray(np.memmap(path, record, "r", shape=(samples,)))
