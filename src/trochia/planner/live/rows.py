"""Rows of structured arrays joined and copied as what they are, bytes.

In: arrays of one dtype, each in one piece of memory.  Out: copies.  (numpy copies such rows one by one, and compares
their fields at each call: for some ten thousand rows at a time that costs more than planning them.)
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray


_OWN = 3  #: references to an array that nobody else looks at: the list's, the loop's, the count's


class Reused:
    """Memory for rows of one dtype, taken again as soon as nobody looks at it any more.

    (The system clears each page it hands out: for arrays that live for a window that costs as much as a copy.)
    """

    __slots__ = ("_dtype", "_held", "_most")

    def __init__(self, dtype: Any, most: int = 3) -> None:  # noqa: ANN401 - whatever numpy takes as one
        self._dtype, self._most = dtype, most
        self._held: list[NDArray[Any]] = []

    def take(self, size: int) -> NDArray[Any]:
        """Return room for so many rows, or more, that nobody else has."""
        for array in self._held:
            if len(array) >= size and sys.getrefcount(array) <= _OWN:
                return array[:]
        fresh: NDArray[Any] = np.empty(size + size // 2, dtype=self._dtype)
        self._held = [fresh, *self._held[: self._most - 1]]
        return fresh[:]


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
