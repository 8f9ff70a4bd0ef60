"""Machine files.  In: a path, the bare name of a shipped machine, or TOML text.  Out: a Machine, or one clear error."""

from __future__ import annotations

import re
import tomllib
from decimal import Decimal
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING

from trochia.errors import ConfigError, MachineError, Source
from trochia.machine.read import read
from trochia.units import did_you_mean

if TYPE_CHECKING:
    from importlib.resources.abc import Traversable

    from trochia.machine.machine import Machine

_PLACE = re.compile(r"\s*\(at (?:line (\d+), column (\d+)|end of document)\)$")
_LARGEST = 4_000_000  #: bytes; a machine file has a few thousand, a part program given by mistake may have millions


def load(name_or_path: str | Path) -> Machine:
    """Return a machine from its file, or a shipped one by its bare name.

    Raises
    ------
    ConfigError, UnitError
        For the first mistake in the file; the hint says how many more there are.
    """
    machine, problems = inspect(name_or_path)
    return _first(machine, problems)


def loads(text: str, file: str = "<text>") -> Machine:
    """Return the machine that a text describes; errors as :func:`load`."""
    machine, problems = inspect_text(text, file)
    return _first(machine, problems)


def shipped() -> tuple[str, ...]:
    """Return the names of the machines that come with Trochia, sorted."""
    names = (entry.name for entry in _folder().iterdir())
    return tuple(sorted(name.removesuffix(".toml") for name in names if name.endswith(".toml")))


def inspect(name_or_path: str | Path) -> tuple[Machine | None, list[MachineError]]:
    """Return the machine, or None and every mistake in its file, in the file's order."""
    try:
        file, text = _find(str(name_or_path))
    except MachineError as error:
        return None, [error]
    return inspect_text(text, file)


def inspect_text(text: str, file: str) -> tuple[Machine | None, list[MachineError]]:
    """Return the machine of a text, or None and every mistake in it."""
    if not text.strip():
        return None, [ConfigError("the machine file is empty", source=Source(file, 1),
                                  hint="Make one with: trochia machine new")]  # fmt: skip
    try:
        # Decimal keeps what was typed: 2.5 stays 5/2 where gearing must be exact
        document = tomllib.loads(text, parse_float=Decimal)
    except tomllib.TOMLDecodeError as error:
        return None, [_syntax_error(error, file, text)]
    machine, problems = read(document, file, text)
    return machine, sorted(problems, key=lambda problem: problem.source.line if problem.source else 0)


def _first(machine: Machine | None, problems: list[MachineError]) -> Machine:
    """Return the machine or raise its first problem, telling of the others."""
    if machine is not None:
        return machine
    error, more = problems[0], len(problems) - 1
    if more:
        file = error.source.file if error.source else "FILE"
        tell = f"{more} more mistake{'s' if more > 1 else ''}: trochia machine check {file}"
        error.hint = f"{error.hint}\n  {tell}" if error.hint else tell
    raise error


def _folder() -> Traversable:
    """Return where the shipped machines lie."""
    return resources.files("trochia") / "data" / "machines"


def _find(name: str) -> tuple[str, str]:
    """Return file name and text of a path or a shipped name."""
    looks_like_path = name.endswith(".toml") or "/" in name or "\\" in name or Path(name).is_file()
    if looks_like_path:
        path = Path(name)
        return name, _decode(name, _read_bytes(path, "the machine file"))
    if name in shipped():
        entry = _folder() / f"{name}.toml"
        return f"{name}.toml", entry.read_text(encoding="utf-8")
    beside = f"There is a file of that name: {name}.toml" if Path(f"{name}.toml").is_file() else None
    raise ConfigError(f"no machine is called {name!r}; those that come with Trochia are {', '.join(shipped())}",
                      hint=beside or did_you_mean(name, shipped())
                      or "A machine of your own is given by its path: ./mill.toml")  # fmt: skip


def text_of(name_or_path: str | Path) -> tuple[str, str]:
    """Return file name and text of a machine file, a path or a shipped name; ConfigError where it cannot be read."""
    return _find(str(name_or_path))


def read_text(path: Path) -> str:
    """Return the text of another controller's settings; bytes that are not UTF-8 are taken as Latin-1.

    Raises
    ------
    ConfigError
        When the file cannot be read, or is binary.
    """
    data = _read_bytes(path, "the settings")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    if "\0" in text:
        raise ConfigError(f"{path}: expected settings as text, found binary data")
    return text


def _read_bytes(path: Path, what: str) -> bytes:
    """Return a file's content, or say why not."""
    try:
        if path.is_file() and path.stat().st_size > _LARGEST:
            raise ConfigError(f"{path}: expected {what}, this has {path.stat().st_size} bytes")
        return path.read_bytes()
    except OSError as error:
        hint = None
        if path.stem in shipped():
            hint = f"The one that comes with Trochia is given by its bare name: {path.stem}"
        raise ConfigError(f"{path}: cannot read {what}: {error.strerror or error}", hint=hint) from None


def _decode(file: str, data: bytes) -> str:
    """Return the text; a byte-order mark and CRLF are taken, other bytes are no machine file."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise ConfigError(f"expected a machine file in TOML (UTF-8 text), found the byte 0x{data[error.start]:02x}",
                          source=Source(file, line)) from None  # fmt: skip
    if "\0" in text:
        raise ConfigError("expected a machine file in TOML, found binary data",
                          source=Source(file, text.count("\n", 0, text.index("\0")) + 1))  # fmt: skip
    return text


def _syntax_error(error: tomllib.TOMLDecodeError, file: str, text: str) -> ConfigError:
    """Return TOML's complaint with its place and line."""
    message = str(error)
    place = _PLACE.search(message)
    lines = text.splitlines()
    line = int(place.group(1)) if place and place.group(1) else len(lines)
    column = int(place.group(2)) if place and place.group(2) else 0
    what = _PLACE.sub("", message)
    shown = lines[min(line, len(lines)) - 1][:200]
    return ConfigError(f"not TOML: {what[:1].lower()}{what[1:]}", source=Source(file, line, column), text=shown,
                       hint='A line is `key = "value with unit"`, a [table] or a # comment.')  # fmt: skip
