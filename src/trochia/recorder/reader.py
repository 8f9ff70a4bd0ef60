"""Reading a recording: the samples are mapped, not loaded, so an hour's recording opens at once.

Of a folder of numbered parts (:mod:`trochia.recorder.ring`) the last that follow each other without a gap are loaded.
"""

from __future__ import annotations

import zlib
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.errors import RecordingError
from trochia.recorder.recording import Recording
from trochia.recorder.ring import parts_of
from trochia.recorder.sidecar import PARTIAL, SAMPLES, SIDECAR, decode, raw

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.recorder.sidecar import Description


def read(path: str | Path, *, verify: bool = False) -> Recording:
    """Return the recording in a folder, or in its parts; one that was cut short ends at its last whole record.

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
    parts = parts_of(Path(path))
    if parts:
        return _joined([_read(part, verify=verify) for part in parts])
    return _read(_folder(Path(path)), verify=verify)


def _read(folder: Path, *, verify: bool) -> Recording:
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


def _joined(parts: list[Recording]) -> Recording:
    """Return the last parts that follow each other without a gap, as one."""
    row = parts[-1:]
    for part in reversed(parts[:-1]):
        if part.header.channels != row[0].header.channels or abs(_end(part) - row[0].start) > 0.5 * part.period:
            break
        row.insert(0, part)
    if len(row) == 1:
        return row[0]
    samples = sum(len(part) for part in row)
    header = replace(row[0].header, duration=max(samples - 1, 0) * row[0].period)
    channels = {name: np.concatenate([part[name] for part in row]) for name in row[0].channels}
    return Recording(header=header, channels=channels, complete=row[-1].complete)


def _end(part: Recording) -> float:
    """Return when the sample after a part's last would be [s]."""
    return part.start + len(part) * part.period


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
