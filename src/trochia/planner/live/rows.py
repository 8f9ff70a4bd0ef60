"""Rows of structured arrays joined and copied as what they are, bytes.

In: arrays of one dtype, each in one piece of memory.  Out: copies.  (numpy copies such rows one by one, and compares
their fields at each call: for some ten thousand rows at a time that costs more than planning them.)
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray


def put(rows: NDArray[Any], into: NDArray[Any]) -> None:
    """Copy rows into as many others."""
    into.view(np.uint8)[:] = np.ascontiguousarray(rows).view(np.uint8)


def copied(rows: NDArray[Any]) -> NDArray[Any]:
    """Return a copy of rows."""
    return joined([rows])


def joined(parts: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """Return a copy of the rows of some parts (at least one), one after another."""
    whole = np.empty(sum(len(part) for part in parts), dtype=parts[0].dtype)
    at = 0
    for part in parts:
        put(part, whole[at : at + len(part)])
        at += len(part)
    return whole
