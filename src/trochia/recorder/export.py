"""Recordings for other programs: CSV and NPZ, written whole or not at all."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.files import whole_file
from trochia.recorder.figures import spans
from trochia.recorder.sidecar import Description, encode

if TYPE_CHECKING:
    from trochia.recorder.recording import Recording


def to_csv(recording: Recording, path: str | Path) -> None:
    """Write one line a sample: time, then every channel, headed by names with units; numbers read back exactly."""
    titles = [f"{c.name} [{c.unit}]" if c.unit else c.name for c in recording.header.channels]
    with whole_file(Path(path)) as out, io.TextIOWrapper(out, newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["time [s]", *titles])
        for span in spans(len(recording)):
            times = recording.start + recording.period * np.arange(span.start, span.stop)
            columns: list[list[Any]] = [times.tolist(), *(c[span].tolist() for c in recording.channels.values())]
            table.writerows(zip(*columns, strict=True))


def to_npz(recording: Recording, path: str | Path) -> None:
    """Write numpy's own archive: an array a channel, ``time`` [s], and ``header``, the sidecar's JSON as text."""
    header = encode(Description(header=recording.header, record=recording.header.record, samples=len(recording)))
    with whole_file(Path(path)) as file:
        np.savez(file, allow_pickle=False, time=recording.time, header=header.decode(), **dict(recording.channels))
