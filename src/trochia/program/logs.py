"""Log files of a program: ``(LOGOPEN, name)``, ``(LOG, text)``, ``(LOGCLOSE)``.

In: the actions of a program that was run, and its folder.  Out: files in that folder, each whole or not written at all.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from trochia.errors import ProgramError, Source
from trochia.files import write_whole
from trochia.program.actions import Log

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from trochia.program.actions import Action


#: suffixes of files beside a program that are no logs
_OTHERS = frozenset({".ngc", ".nc", ".gcode", ".tap", ".pmc", ".toml", ".tbl", ".var", ".ini", ".json", ".py", ".sh"})


def logs_of(actions: Iterable[Action], program: Path, place: str = "the program's folder") -> dict[Path, bytes]:
    """Return the files that a program writes into its own folder, and what they will hold.

    Parameters
    ----------
    program
        Where it lies; a name without a file, if it came from elsewhere.
    place
        What its folder is called in errors.

    Raises
    ------
    ProgramError
        For a file that would lie elsewhere, be the program itself, or cannot be written.
    """
    files: dict[Path, bytearray] = {}
    for action in actions:
        if not isinstance(action, Log):
            continue
        path = _path_of(action, program, place)
        if not action.opens:
            files[path] += action.text.encode("latin-1", "replace") + b"\n"
        elif not action.append:
            files[path] = bytearray()
        elif path not in files:
            files[path] = bytearray(path.read_bytes() if path.exists() else b"")
    return {path: bytes(content) for path, content in files.items()}


def write_logs(actions: Iterable[Action], program: Path, place: str = "the program's folder") -> list[Path]:
    """Write the log files of a program; return them.

    Raises
    ------
    ProgramError
        As :func:`logs_of`, before anything is written; and where the system does not let it.
    """
    files = logs_of(actions, program, place)
    for path, content in files.items():
        try:
            write_whole(path, content)
        except OSError as error:
            raise ProgramError(f"the log file {path} cannot be written: {error.strerror}",
                               hint=f"May you write into {place}?") from None  # fmt: skip
    return list(files)


def _is_log(path: Path) -> bool:
    """Return whether what is there may be written over: no program, no settings, nothing that can be executed."""
    return path.is_file() and path.suffix.lower() not in _OTHERS and not os.access(path, os.X_OK)


def _path_of(action: Log, program: Path, place: str) -> Path:
    """Return where a log lies."""
    home = program.parent.resolve()
    path = (home / action.file).resolve()
    wrong = ""
    if not path.is_relative_to(home):
        wrong = f"leads out of {place}"
    elif path == program.resolve():
        wrong = "is the program itself"
    elif path.name.startswith(".") or (path.exists() and not _is_log(path)):
        wrong = "would be written over what is no log"
    elif not path.parent.is_dir():
        wrong = "lies in a folder that is not there"
    if wrong:
        raise ProgramError(f"the log file {action.file!r} {wrong}", source=Source(program.name, action.line),
                           hint="Name it without a folder, like log.txt.")  # fmt: skip
    return path
