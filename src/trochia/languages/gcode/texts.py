"""The texts of a run: the program, and files that hold subroutines.

In: folders to look in, and names that a program calls.  Out: :class:`Text`; a name never leads out of its folder.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Sequence
    from mmap import mmap
    from pathlib import Path

    from trochia.languages.gcode.template import Template

_SAFE = re.compile(r"[a-z0-9_][a-z0-9_.+-]*(/[a-z0-9_][a-z0-9_.+-]*)*")
_LARGEST = 64 * 1024 * 1024  # bytes of a file with subroutines


@dataclass(slots=True)
class Text:
    """A text, and what has been read of it: offset of a line -> line, offset of the next one, and where it stands."""

    name: str
    data: bytes | mmap
    main: bool = True
    templates: dict[int, tuple[Template, int, Mark]] = field(default_factory=dict[int, tuple["Template", int, "Mark"]])


class Mark(NamedTuple):
    """A line of a text."""

    text: Text
    offset: int
    line: int


@dataclass(slots=True)
class Cursor:
    """The line that is read next."""

    text: Text
    offset: int = 0
    line: int = 1

    def mark(self) -> Mark:
        """Return where it stands."""
        return Mark(self.text, self.offset, self.line)

    def go(self, mark: Mark) -> None:
        """Move to a mark."""
        self.text, self.offset, self.line = mark


class Texts:
    """Finds subroutines in files: ``name.ngc`` in the first folder that has it."""

    def __init__(self, folders: Sequence[Path] = ()) -> None:
        self._folders = tuple(folders)
        self._known: dict[str, Text] = {}

    def find(self, name: str) -> Mark | None:
        """Return the beginning of the file for a name, or None where no folder has one."""
        if not _SAFE.fullmatch(name):
            return None
        text = self._known.get(name)
        if text is None:
            text = next((text for folder in self._folders if (text := _read(folder, name)) is not None), None)
            if text is None:
                return None
            self._known[name] = text
        return Mark(text, 0, 1)

    def where(self, name: str) -> str:
        """Return where a subroutine was looked for, as a hint."""
        if not self._folders:
            return f"It is neither in the program nor, as {name}.ngc, in a folder named by --subroutines."
        return f"There is no {name}.ngc in " + ", ".join(str(folder) for folder in self._folders) + " either."


def _read(folder: Path, name: str) -> Text | None:
    """Return the text of a file in the folder; a link that leads out of it does not count."""
    path = folder / f"{name}.ngc"
    try:
        real = path.resolve()
        if not real.is_file() or not real.is_relative_to(folder.resolve()) or real.stat().st_size > _LARGEST:
            return None
        return Text(str(path), real.read_bytes(), main=False)
    except OSError:
        return None


def next_line(data: bytes | mmap, offset: int) -> tuple[bytes, int]:
    """Return the line that begins at ``offset``, without its end, and where the next one begins."""
    end = data.find(b"\n", offset)
    end = len(data) if end < 0 else end
    return data[offset:end], end + 1
