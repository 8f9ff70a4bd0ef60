"""What a machine file was before it was changed, beside it in ``NAME.undo``: whole or not at all.

In: a path, the text to be written.  Out: the file changed, or as it was before its last change.

The record is written before the file, and taken back behind it, so that a cut between the two loses nothing: then the
record holds a text that the file has already.
"""

from __future__ import annotations

import hashlib
import json
from typing import TYPE_CHECKING, Any

from trochia.errors import ConfigError
from trochia.files import write_whole

if TYPE_CHECKING:
    from pathlib import Path

FORMAT = 1
MOST = 20  #: changes that are kept


def record_of(path: Path) -> Path:
    """Return where the record of a file is."""
    return path.with_name(f"{path.name}.undo")


def change(path: Path, text: str, what: str) -> None:
    """Write a file, its present text kept for :func:`undo`; ``what`` is changed."""
    before = path.read_text(encoding="utf-8")
    changes = [*_changes(path), {"what": what, "before": before, "after": _sum(text)}]
    _write(path, changes[-MOST:])
    write_whole(path, text.encode())


def undo(path: Path) -> str:
    """Give a file the text that it had before its last change, and return what had been changed.

    Raises
    ------
    ConfigError
        When nothing was changed, or the file is another than the change left: nothing is written then.
    """
    changes = _changes(path)
    if not changes:
        raise ConfigError(f"{path.name} was not changed by trochia: there is nothing to undo", key="undo")
    last = changes[-1]
    now = path.read_text(encoding="utf-8")
    if now != last["before"]:
        if _sum(now) != last["after"]:
            raise ConfigError(f"{path.name} was edited since {last['what']} was changed: it stays so", key="undo",
                              hint=f"The text before stands in {record_of(path).name}.")  # fmt: skip
        write_whole(path, str(last["before"]).encode())
    _write(path, changes[:-1])
    return str(last["what"])


def _sum(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _changes(path: Path) -> list[dict[str, Any]]:
    record = record_of(path)
    if not record.exists():
        return []
    try:
        found = json.loads(record.read_text(encoding="utf-8"))
        if found["format"] != FORMAT:
            raise ConfigError(f"{record.name} is of format {found['format']}; this is for {FORMAT}", key="undo")
        return [{name: str(one[name]) for name in ("what", "before", "after")} for one in found["changes"]]
    except (ValueError, KeyError, TypeError):
        raise ConfigError(f"{record.name} is no record of changes", key="undo",
                          hint="Remove it; what stands in it cannot be had back.") from None  # fmt: skip


def _write(path: Path, changes: list[dict[str, Any]]) -> None:
    if changes:
        text = json.dumps({"format": FORMAT, "changes": changes}, ensure_ascii=False, indent=1)
        write_whole(record_of(path), text.encode())
    else:
        record_of(path).unlink(missing_ok=True)
