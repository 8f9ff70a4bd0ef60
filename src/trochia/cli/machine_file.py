"""What the commands that write machine files share: options, changes by key, a file written whole or not at all."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from trochia.errors import ConfigError
from trochia.files import write_whole
from trochia.machine.draft import put

if TYPE_CHECKING:
    from trochia.errors import MachineError

output = click.option("-o", "--output", type=click.Path(dir_okay=False, path_type=Path), metavar="FILE",
                      help="Where to write the machine file; without it, it is printed.")  # fmt: skip
force = click.option("--force", is_flag=True, help="Write over a file that exists.")
settings = click.option("--set", "changes", multiple=True, metavar="KEY=VALUE",
                        help="Set any key, like axes.X.velocity='300 mm/s'; may be given often.")  # fmt: skip


def apply_changes(document: dict[str, Any], changes: tuple[str, ...]) -> None:
    """Apply ``--set KEY=VALUE`` to a document."""
    for change in changes:
        key, equals, value = change.partition("=")
        if not equals:
            raise click.BadParameter(f"expected KEY=VALUE, not {change!r}", param_hint="--set")
        put(document, key.strip(), value.strip())


def problem_data(error: MachineError, file: str) -> dict[str, object]:
    """Return a mistake as ``check --json`` gives it."""
    source = error.source
    return {
        "severity": "error",
        "code": error.code,
        "file": source.file if source else file,
        "line": source.line if source else None,
        "column": source.column or None if source else None,
        "key": error.key,
        "message": error.message,
        "hint": error.hint,
    }


def write_machine(path: Path, text: str, *, force: bool) -> None:
    """Write a file whole or not at all; one that exists is only replaced when asked.

    Raises
    ------
    ConfigError
        When it exists, or cannot be written.
    """
    if path.exists() and not force:
        raise ConfigError(f"{path} exists already", hint="Write over it with --force, or choose another name.")
    try:
        write_whole(path, text.encode())
    except OSError as error:
        raise ConfigError(f"{path}: cannot write the machine file: {error.strerror or error}") from None
