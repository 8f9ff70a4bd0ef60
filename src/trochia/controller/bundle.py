"""A support bundle: what somebody who was not there needs to see what happened.

In: a machine file, a journal, recordings.  Out: one zip file, and a list of what is in it.  Only files that are known
by their kind are taken, each by its own reader: users files, keys and the log of who asked for what are never looked
at, and entries lose what is called like a secret.
"""

from __future__ import annotations

import platform
import re
import sys
import zipfile
from collections import deque
from dataclasses import dataclass, field
from importlib import metadata
from typing import TYPE_CHECKING, Any, cast

import msgspec

from trochia import __version__
from trochia.controller.interrupted import PROGRAMS
from trochia.controller.journal import entries
from trochia.errors import RecordingError
from trochia.files import whole_file
from trochia.machine.load import inspect_text
from trochia.recorder import parts_of
from trochia.recorder.sidecar import SAMPLES, SIDECAR

if TYPE_CHECKING:
    from pathlib import Path

ENTRIES = 5000  #: of the journal, the last ones: some 50 s of a job's points
ROOM = 64 << 20  #: bytes of a recording
PACKAGES = ("numpy", "scipy", "click", "msgspec", "cffi", "matplotlib", "starlette", "uvicorn", "websockets")
_SECRET = re.compile(r"passw|secret|token|cookie|session|salt|credential|(^|_)key$", re.IGNORECASE)
_LEFT = "left out"  #: what stands where a secret stood


@dataclass(slots=True)
class Bundle:
    """A bundle being made.

    Attributes
    ----------
    packed
        (name in the zip, bytes, what it is).
    left_out
        What there is but was not packed, and why.
    """

    packed: list[tuple[str, int, str]] = field(default_factory=list[tuple[str, int, str]])
    left_out: list[str] = field(default_factory=list[str])
    _texts: dict[str, bytes] = field(default_factory=dict[str, bytes])
    _files: dict[str, Path] = field(default_factory=dict[str, "Path"])

    def machine(self, text: str, file: str) -> None:
        """Pack the text of a machine file, and what is wrong with it.

        Raises
        ------
        MachineError
            When it is no machine file at all.
        """
        _, problems = inspect_text(text, file)
        if not re.search(r"(?m)^\s*format\s*=", text):
            raise problems[0]  # not even TOML of ours: it may be anything
        self._text("machine.toml", text.encode(), "the machine file")
        if problems:
            self._text("machine-mistakes.txt", "\n".join(map(str, problems)).encode(), "what is wrong with it")

    def journal(self, folder: Path, *, count: int = ENTRIES, program: bool = False) -> None:
        """Pack the last entries of a journal; with ``program`` also the text of its last job.

        Raises
        ------
        RecordingError
            When there is no journal, or it is newer than this program.
        """
        if not folder.is_dir():
            raise RecordingError(f"{folder}: no journal: there is no such folder")
        tail: deque[dict[str, Any]] = deque(maxlen=count)
        job = ""
        for entry in entries(folder):
            tail.append(entry)
            job = str(entry.get("program", "")) if entry["kind"] == "job" else job
        lines = b"".join(msgspec.json.encode(_without_secrets(entry)) + b"\n" for entry in tail)
        self._text("journal.jsonl", lines, f"the last {len(tail)} entries of the journal")
        text = folder / PROGRAMS / f"{job}.ngc"
        if re.fullmatch(r"[0-9a-f]+", job) and text.is_file():
            if program:
                self._text("program.ngc", text.read_bytes(), "the text of its last job")
            else:
                self.left_out.append("the text of the last job (--with-program packs it)")

    def recording(self, folder: Path, *, room: int = ROOM) -> None:
        """Pack a recording: of its parts the newest that fit in ``room`` bytes.

        Raises
        ------
        RecordingError
            When there is none.
        """
        parts = parts_of(folder) or ([folder] if (folder / SIDECAR).is_file() else [])
        if not parts:
            raise RecordingError(f"{folder}: no recording")
        taken = 0
        for part in reversed(parts):
            size = sum((part / name).stat().st_size for name in (SAMPLES, SIDECAR) if (part / name).is_file())
            if taken + size > room:
                self.left_out.append(f"older parts of the recording {folder.name}: they do not fit in {room:,} bytes")
                return
            taken += size
            below = f"recording/{part.name}" if part is not folder else "recording"
            for name in (SIDECAR, SAMPLES):
                if (part / name).is_file():
                    self._files[f"{below}/{name}"] = part / name
                    self.packed.append((f"{below}/{name}", (part / name).stat().st_size, f"recording {folder.name}"))

    def write(self, path: Path) -> None:
        """Write the zip, whole or not at all."""
        about = {
            "trochia": __version__, "python": sys.version.split()[0], "system": platform.system(),
            "release": platform.release(), "processor": platform.machine(), "packages": _versions(),
            "packed": [{"name": name, "bytes": size, "what": what} for name, size, what in self.packed],
            "left_out": [*self.left_out, "users, keys, passwords and the log of who asked for what: never packed"],
        }  # fmt: skip
        text = msgspec.json.format(msgspec.json.encode(about), indent=2) + b"\n"
        with whole_file(path, 0o600) as out, zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as file:
            file.writestr("about.json", text)
            for name, content in self._texts.items():
                file.writestr(name, content)
            for name, source in self._files.items():
                file.write(source, name)
        self.packed.insert(0, ("about.json", len(text), "versions, and this list"))

    def _text(self, name: str, content: bytes, what: str) -> None:
        self._texts[name] = content
        self.packed.append((name, len(content), what))


def newest(folder: Path) -> Path | None:
    """Return the newest recording in a folder, the folder itself if it is one; None where there is none."""
    if parts_of(folder) or (folder / SIDECAR).is_file():
        return folder
    found = [entry for entry in folder.iterdir() if entry.is_dir() and newest(entry)] if folder.is_dir() else []
    return max(found, key=lambda entry: entry.stat().st_mtime, default=None)


def _versions() -> dict[str, str]:
    """Return the versions of the packages that are there."""
    found: dict[str, str] = {}
    for name in PACKAGES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found


def _without_secrets(value: object) -> object:
    """Return JSON data with what is called like a secret left out, however deep."""
    if isinstance(value, dict):
        table = cast("dict[str, object]", value)
        return {key: _LEFT if _SECRET.search(key) else _without_secrets(inner) for key, inner in table.items()}
    if isinstance(value, list):
        return [_without_secrets(inner) for inner in cast("list[object]", value)]
    return value
