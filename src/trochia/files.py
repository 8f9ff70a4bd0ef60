"""Files that are whole or not there: written under another name beside it, and renamed when all went well."""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING, BinaryIO

if TYPE_CHECKING:
    from collections.abc import Generator
    from pathlib import Path


@contextmanager
def whole_file(path: Path, mode: int = 0o666) -> Generator[BinaryIO]:
    """Give a binary file that takes the name ``path`` only when the block ends without an error.

    A device or a pipe is written as it is.  ``mode`` is who may read and write a file made anew, less the umask.

    Raises
    ------
    OSError
        When the folder or the file cannot be written.
    """
    path = path.resolve()
    if path.exists() and not path.is_file():
        with path.open("wb") as out:
            yield out
        return
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with os.fdopen(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, mode), "wb") as out:
            yield out
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def write_whole(path: Path, content: bytes, mode: int = 0o666) -> None:
    """Write ``content`` to ``path`` whole or not at all; errors are those of :func:`whole_file`."""
    with whole_file(path, mode) as out:
        out.write(content)
