"""The library of real motors.  In: TOML, one ``[motors.NAME]`` a motor.  Out: rows of a catalogue, by name."""

from __future__ import annotations

import tomllib
from decimal import Decimal
from importlib import resources

from trochia.errors import ConfigError, Source
from trochia.machine.motors.catalogue import CatalogueStepper
from trochia.machine.table import Book, Table, build
from trochia.units import did_you_mean


def library() -> dict[str, CatalogueStepper]:
    """Return all motors that come with Trochia, by name."""
    rows: dict[str, CatalogueStepper] = {}
    folder = resources.files("trochia") / "data" / "motors"
    for entry in sorted(folder.iterdir(), key=lambda entry: entry.name):
        if entry.name.endswith(".toml"):
            rows |= rows_of(entry.read_text(encoding="utf-8"), entry.name)
    return rows


def motor(name: str) -> CatalogueStepper:
    """Return a motor of the library.

    Raises
    ------
    ConfigError
        When it has none of that name.
    """
    rows = library()
    if name not in rows:
        near = did_you_mean(name, rows)
        listed = f"`trochia motors` lists its {len(rows)}"
        raise ConfigError(f"the library has no motor {name!r}", hint=f"{near} {listed}" if near else listed)
    return rows[name]


def rows_of(text: str, file: str = "<text>") -> dict[str, CatalogueStepper]:
    """Return the motors that a text describes.

    Raises
    ------
    ConfigError, UnitError
        For the first mistake in it, with its line.
    """
    try:
        document = tomllib.loads(text, parse_float=Decimal)
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(f"not TOML: {error}", source=Source(file, 1)) from None
    book = Book(file, text)
    top = Table(document, book)
    rows: dict[str, CatalogueStepper] = {}
    with book.catch():
        for name, table in top.tables("motors").items():
            with book.catch():
                rows[name] = build(table, CatalogueStepper)
    top.refuse_rest()
    if book.problems:
        raise book.problems[0]
    return rows
