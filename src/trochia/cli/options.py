"""Options that several commands share, and how they speak to a person and to a script."""

from __future__ import annotations

import functools
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from trochia import units
from trochia.cli import setup
from trochia.errors import UnitError

if TYPE_CHECKING:
    from collections.abc import Callable

_PLACE = re.compile(r"\s*([XYZABCUVW])\s*=?\s*([+-]?(?:\d+\.?\d*|\.\d+))\s*(mm|cm|m|in|deg|°)?\s*,?", re.IGNORECASE)

DIALECT_NAMES = ("linuxcnc", "grbl", "fanuc", "marlin")  # those of `languages.gcode.DIALECTS`
type_program = click.Path(exists=True, dir_okay=False, readable=True, allow_dash=True)

machine = click.option(
    "-m", "--machine", "machine_name", required=True, metavar="MACHINE",
    help="Machine file, or the name of one that comes with Trochia (`trochia machine show` lists them).",
)  # fmt: skip
as_json = click.option(
    "--json", "as_json", is_flag=True, help="One JSON object on standard output; progress on standard error."
)
profile = click.option(
    "--profile",
    metavar="NAME",
    help="Velocity profile; without it the machine's own, else s-curve where every axis has a jerk limit.",
)


def _place(_context: click.Context, _parameter: click.Parameter, value: str | None) -> dict[str, float]:
    """Return ``X10Y-5`` as {axis: offset} [mm, degree]."""
    place: dict[str, float] = {}
    rest = value or ""
    while rest:
        match = _PLACE.match(rest)
        if match is None:
            raise click.BadParameter(f"expected axis letters with numbers, like X10Y-5 or X10mm,A90deg, not {rest!r}")
        name, number, unit = match.groups()
        letter = name.upper()
        if letter in place:
            raise click.BadParameter(f"{letter} is given twice")
        rotary = letter in "ABC"
        try:
            place[letter] = units.parse(
                f"{number} {unit or ('deg' if rotary else 'mm')}", "angle" if rotary else "length"
            )
        except UnitError as error:
            raise click.BadParameter(f"{letter}: {error.message}") from error
        rest = rest[match.end() :]
    return place


at = click.option(
    "--at", "place", callback=_place, metavar="X..Y..",
    help="Where the part lies: offset of the program's zero, in mm (or with a unit), like X10Y-5.",
)  # fmt: skip


def reading(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options that say how a G-code program is read; the command gets them as ``reading``."""
    command = setup.files(command)

    @functools.wraps(command)
    def with_reading(
        *, subroutines: tuple[Path, ...], max_lines: int | None, dialect: str | None,
        **values: Any,  # noqa: ANN401 - click's
    ) -> Any:  # noqa: ANN401 - click's  # fmt: skip
        from trochia.languages.gcode.dialects import DIALECTS  # noqa: PLC0415 - `trochia --help` must stay light
        from trochia.languages.gcode.reading import MOST_LINES, Reading  # noqa: PLC0415 - `trochia --help` must stay light

        program = str(values.get("program", "-"))
        own = () if program == "-" else (Path(program).parent,)
        found = Reading(
            subroutines=subroutines or own, most_lines=max_lines or MOST_LINES,
            dialect=None if dialect is None else DIALECTS[dialect],
        )  # fmt: skip
        return command(reading=found, **values)

    decorated = click.option(
        "--max-lines", type=click.IntRange(min=1), metavar="N",
        help="Lines a program may execute before its loops count as endless; ten millions unless given.",
    )(with_reading)  # fmt: skip
    decorated = click.option(
        "--dialect", type=click.Choice(DIALECT_NAMES),
        help="Whose G-code it is; without it the machine's, else linuxcnc.",
    )(decorated)  # fmt: skip
    return click.option(
        "--subroutines", multiple=True, metavar="DIR", type=click.Path(exists=True, file_okay=False, path_type=Path),
        help="Folder of files with subroutines (again for more); without it the program's own.",
    )(decorated)  # fmt: skip


def common(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the argument PROGRAM and the options every planning command has."""
    for decorate in (
        reading,
        as_json,
        profile,
        at,
        machine,
        click.argument("program", metavar="PROGRAM", type=type_program),
    ):
        command = decorate(command)
    return command


def print_json(value: object) -> None:
    """Print one JSON object on standard output."""
    import msgspec  # noqa: PLC0415 - `trochia --help` must stay light

    sys.stdout.buffer.write(msgspec.json.format(msgspec.json.encode(value, enc_hook=_plain), indent=2) + b"\n")


def _plain(value: Any) -> object:  # noqa: ANN401 - whatever msgspec does not know
    """Return a numpy scalar or array as plain numbers."""
    return value.tolist()
