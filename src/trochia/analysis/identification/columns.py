"""Columns of numbers from a CSV file.

In: a file, how many columns.  Out: arrays.  A first line of names is passed over; anything else that is no number is
told with its line and column.
"""

from __future__ import annotations

import csv
import math
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import RecordingError, Source

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray


def read_columns(path: Path, count: int) -> list[NDArray[np.float64]]:
    """Return the first ``count`` columns.

    Raises
    ------
    RecordingError
        At the first line that has too few columns, or a field that is no finite number.
    """
    rows: list[list[float]] = []
    with path.open(newline="", encoding="utf-8-sig", errors="replace") as file:
        for number, fields in enumerate(csv.reader(file), 1):
            if not fields or (number == 1 and not _is_number(fields[0])):
                continue
            if len(fields) < count:
                raise RecordingError(f"expected {count} columns, not {len(fields)}", source=Source(path.name, number))
            for column, text in enumerate(fields[:count], 1):
                if not _is_number(text):
                    raise RecordingError(f"column {column} holds {text.strip()!r}, which is no finite number",
                                         source=Source(path.name, number),
                                         hint="A gap in a recording: record again, or cut it there.")  # fmt: skip
            rows.append([float(text) for text in fields[:count]])
    if not rows:
        raise RecordingError(f"{path.name} holds no rows of numbers")
    return list(np.array(rows, np.float64).T)


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False
