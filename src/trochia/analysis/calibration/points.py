"""Measured points of one axis.  In: a CSV file.  Out: where it was told to be, where it was, which way it had come.

Columns by their titles, in any order: ``commanded``, ``measured``, and ``direction`` (+ or -) where it is known; other
columns are passed over.  A unit may stand behind a title, ``measured [um]``; mm (degrees of a rotary axis) without one.
"""

from __future__ import annotations

import csv
import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia import units
from trochia.errors import RecordingError, Source, UnitError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

_TITLE = re.compile(r"\s*([A-Za-z]+)\s*(?:[\[(]\s*([^\])]+?)\s*[\])])?\s*$")
_WAYS = {"+": 1, "-": -1, "1": 1, "+1": 1, "-1": -1, "up": 1, "down": -1, "": 0, "0": 0}
_LEAST = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Points:
    """Points of one axis, in the order they were measured.

    Attributes
    ----------
    commanded, measured
        Where it was told to be and where it was (points,) [mm or degree].
    ways
        Which way it had come: 1 rising, -1 falling, 0 not known (points,).
    """

    commanded: NDArray[np.float64]
    measured: NDArray[np.float64]
    ways: NDArray[np.int8]


def read_points(path: Path, *, rotary: bool = False) -> Points:
    """Return the points in a CSV file.

    Without a column ``direction`` the way is that from the point before, where that was elsewhere.

    Raises
    ------
    RecordingError
        Naming the line and what was expected.
    """
    with path.open(newline="", encoding="utf-8-sig", errors="replace") as file:
        lines = [fields for fields in csv.reader(file) if any(field.strip() for field in fields)]
    if not lines:
        raise RecordingError(f"{path.name} is empty", hint="Its first line is: commanded,measured,direction")
    columns = _columns(lines[0], path.name, rotary=rotary)
    rows = [_row(fields, columns, Source(path.name, number)) for number, fields in enumerate(lines[1:], 2)]
    if len(rows) < _LEAST:
        raise RecordingError(f"{path.name} holds {len(rows)} points; at least {_LEAST} are needed")
    commanded, measured, ways = (np.array(column) for column in zip(*rows, strict=True))
    if "direction" not in columns:
        step = np.sign(np.diff(commanded, prepend=commanded[0]))
        ways = np.where(step == 0.0, 0, step)
        for k in range(1, len(ways)):
            ways[k] = ways[k] or ways[k - 1]  # measured again without moving
    return Points(commanded=commanded, measured=measured, ways=ways.astype(np.int8))


def _columns(titles: Sequence[str], name: str, *, rotary: bool) -> dict[str, tuple[int, float]]:
    """Return place and factor to the base unit of each column that is known."""
    found: dict[str, tuple[int, float]] = {}
    dimension = "angle" if rotary else "length"
    for place, title in enumerate(titles):
        match = _TITLE.match(title)
        word = match.group(1).lower() if match else ""
        if match and word in {"commanded", "measured", "direction"}:
            try:
                factor = units.parse(f"1 {match.group(2)}", dimension) if match.group(2) else 1.0
            except UnitError as error:
                raise RecordingError(f"{title.strip()}: {error.plain}", source=Source(name, 1)) from None
            found[word] = (place, factor)
    for word in ("commanded", "measured"):
        if word not in found:
            there = ", ".join(title.strip() for title in titles)
            raise RecordingError(f"there is no column {word!r}, but {there}", source=Source(name, 1),
                                 hint="Its first line is: commanded,measured,direction")  # fmt: skip
    return found


def _row(fields: Sequence[str], columns: dict[str, tuple[int, float]], source: Source) -> tuple[float, float, int]:
    values: list[float] = []
    for word in ("commanded", "measured"):
        place, factor = columns[word]
        text = fields[place].strip() if place < len(fields) else ""
        try:
            value = float(text) * factor
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise RecordingError(f"expected a number for {word}, not {text!r}", source=source)
        values.append(value)
    way = fields[columns["direction"][0]].strip().lower() if "direction" in columns else ""
    if way not in _WAYS:
        raise RecordingError(f"expected + or - for direction, not {way!r}", source=source)
    return values[0], values[1], _WAYS[way]
