"""The lines of a program's text, by number, without a Python string for each of a million."""

from __future__ import annotations

from collections.abc import Sequence
from typing import overload

import numpy as np


class SourceText(Sequence[str]):
    """Lines of a text (Latin-1), line 1 at index 0, without their ends; found by an index of line feeds."""

    __slots__ = ("_ends", "_text")

    def __init__(self, text: bytes) -> None:
        self._text = text
        ends = np.flatnonzero(np.frombuffer(text, np.uint8) == ord("\n"))
        if text and not text.endswith(b"\n"):
            ends = np.append(ends, len(text))
        self._ends = ends

    def __len__(self) -> int:
        """Return the number of lines."""
        return len(self._ends)

    @overload
    def __getitem__(self, index: int) -> str: ...
    @overload
    def __getitem__(self, index: slice) -> list[str]: ...
    def __getitem__(self, index: int | slice) -> str | list[str]:
        """Return a line, or some."""
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        if not -len(self) <= index < len(self):
            raise IndexError(index)
        at = index % len(self)
        begin = int(self._ends[at - 1]) + 1 if at else 0
        return self._text[begin : int(self._ends[at])].decode("latin-1").rstrip("\r")
