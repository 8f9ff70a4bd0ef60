"""The JSON beside the samples: a header as it stands in a file, and back.

A recording is a folder of two files: ``samples.bin``, an array of records in the order of time, and ``recording.json``,
this sidecar.  Keys carry their units; ``docs/reference/recording.md`` is the description for other readers.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from trochia.errors import RecordingError
from trochia.recorder.channel import FORMAT_VERSION, Channel, Header, Scalar

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

FORMAT = "trochia-recording"
SIDECAR = "recording.json"
SAMPLES = "samples.bin"
PARTIAL = ".partial"  #: what the folder's name ends in until it is whole


class _Mark(msgspec.Struct):
    """What says that a file is ours, and of which age; read before anything else is believed."""

    format: str
    format_version: int


class _Column(msgspec.Struct, omit_defaults=True):
    """A channel and where it stands in a record [byte]."""

    name: str
    unit: str
    dtype: Scalar
    offset: int
    values: tuple[str, ...] = ()


class _Sidecar(msgspec.Struct):
    format: str
    format_version: int
    created_by: str
    machine: str
    program: str
    origin: str
    period_s: float
    start_s: float
    duration_s: float
    record_bytes: int
    channels: list[_Column]
    complete: bool = False
    samples: int | None = None
    crc32: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Description:
    """A sidecar as the reader uses it: header, layout of a record, and what was promised at the end, if it came."""

    header: Header
    record: np.dtype[Any]
    samples: int | None = None
    crc32: int | None = None


def encode(description: Description) -> bytes:
    """Return the JSON text of a description."""
    header, record = description.header, description.record
    fields: Any = record.fields
    sidecar = _Sidecar(
        format=FORMAT,
        format_version=header.format_version,
        created_by=header.created_by,
        machine=header.machine,
        program=header.program,
        origin=header.origin,
        period_s=header.period,
        start_s=header.start,
        duration_s=header.duration,
        record_bytes=record.itemsize,
        channels=[_Column(c.name, c.unit, c.dtype, fields[c.name][1], c.values) for c in header.channels],
        complete=description.samples is not None,
        samples=description.samples,
        crc32=None if description.crc32 is None else f"{description.crc32:08x}",
    )
    return msgspec.json.format(msgspec.json.encode(sidecar), indent=2) + b"\n"


def decode(path: Path) -> Description:
    """Return the description in a sidecar file.

    Raises
    ------
    RecordingError
        When the file is not of this format, of a newer version of it, or damaged.
    """
    text = path.read_bytes()
    try:
        mark = msgspec.json.decode(text, type=_Mark)
    except msgspec.DecodeError as error:
        raise RecordingError(f"{path}: no recording of this program ({error})") from None
    if mark.format != FORMAT:
        raise RecordingError(f"{path}: expected format {FORMAT!r}, not {mark.format!r}")
    if mark.format_version > FORMAT_VERSION:
        raise RecordingError(
            f"{path}: written in format version {mark.format_version}; this program reads up to {FORMAT_VERSION}",
            hint="Read it with the newer version that wrote it, or export it there.",
        )
    try:
        return _described(msgspec.json.decode(text, type=_Sidecar))
    except (msgspec.DecodeError, ValueError, OverflowError, RecordingError) as error:
        raise RecordingError(f"{path}: damaged sidecar: {error}") from None


def raw(records: NDArray[Any]) -> memoryview:
    """Return the bytes of records as they stand in the file; not their own buffer, whose field names have no colons."""
    return records.view(np.uint8).data if len(records) else memoryview(b"")


def _described(sidecar: _Sidecar) -> Description:
    columns = sidecar.channels
    header = Header(
        period=sidecar.period_s,
        start=sidecar.start_s,
        duration=sidecar.duration_s,
        machine=sidecar.machine,
        program=sidecar.program,
        origin=sidecar.origin,
        created_by=sidecar.created_by,
        format_version=sidecar.format_version,
        channels=tuple(Channel(name=c.name, unit=c.unit, dtype=c.dtype, values=c.values) for c in columns),
    )
    layout: Any = {
        "names": [c.name for c in columns],
        "formats": [c.dtype for c in columns],
        "offsets": [c.offset for c in columns],
        "itemsize": sidecar.record_bytes,
    }
    return Description(
        header=header,
        record=np.dtype(layout),
        samples=sidecar.samples if sidecar.complete else None,
        crc32=None if sidecar.crc32 is None else int(sidecar.crc32, 16),
    )
