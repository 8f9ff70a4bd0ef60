"""Tools and variables on the command line: `--tools`, `--parameters`, `--ini`, `--save-parameters`.

In: the options, and what the machine file names.  Out: they are in the `reading` that the command gets; and, where it
is asked for and the command says yes, the files are written.
"""

from __future__ import annotations

import functools
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from trochia.cli.user_codes import codes_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.languages.gcode.reading import Reading
    from trochia.languages.gcode.setup import SetupFiles
    from trochia.program import WorkState

_FILE = click.Path(exists=True, dir_okay=False, readable=True, path_type=Path)
_OPTIONS = (
    click.option("--tools", type=_FILE, metavar="FILE", help="Tool table, in LinuxCNC's .tbl format."),
    click.option("--parameters", type=click.Path(dir_okay=False, path_type=Path), metavar="FILE",
                 help="Offsets and variables, in LinuxCNC's .var format; read, and written only by --save-parameters."),
    click.option("--ini", type=_FILE, metavar="FILE",
                 help="LinuxCNC's ini: tool table, parameter file, folders of subroutines, startup code, length unit."),
    click.option("--save-parameters", is_flag=True,
                 help="Write offsets, variables and changed tools back when the program is right and has ended."),
)  # fmt: skip


def files(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options to a command that gets a ``reading``, and perhaps a ``machine_name``."""

    @functools.wraps(command)
    def with_files(
        *, tools: Path | None, parameters: Path | None, ini: Path | None, save_parameters: bool, reading: Reading,
        **values: Any,  # noqa: ANN401 - click's
    ) -> None:  # fmt: skip
        if save_parameters and values.get("place"):
            raise click.UsageError("--save-parameters would keep what --at sets for this run: leave one of them out.")
        if not (tools or parameters or ini or save_parameters or "machine_name" in values):
            command(reading=_alone(reading), **values)
            return
        from trochia.languages.gcode.setup import SetupFiles, read_setup  # noqa: PLC0415 - only where files are read

        given = SetupFiles(tools=tools, parameters=parameters)
        name = values.get("machine_name")
        reading = _alone(reading) if name is None else reading
        if name is not None:
            given, reading = _of_machine(given, reading, name)
        given, reading = read_setup(given, reading, ini=ini, new_parameters=save_parameters)
        if save_parameters:
            _run_and_save(command, given, reading, values)
        else:
            command(reading=reading, **values)

    for option in reversed(_OPTIONS):
        with_files = option(with_files)
    return with_files


def _alone(reading: Reading) -> Reading:
    """Return the reading without a machine: the reference alone, whose files count in inches."""
    return replace(reading, work=replace(reading.work, unit=25.4))


def _of_machine(given: SetupFiles, reading: Reading, name: str) -> tuple[SetupFiles, Reading]:
    """Return files and reading with what the machine file says; paths in it are relative to its folder."""
    from trochia import api  # noqa: PLC0415 - `trochia --help` must stay light

    machine = api.load(name)
    home = Path(name).resolve().parent
    if given.tools is None and machine.tools is not None:
        given = replace(given, tools=home / machine.tools)
    if given.parameters is None and machine.parameters is not None:
        given = replace(given, parameters=home / machine.parameters, home=home)
    return given, replace(reading, work=replace(reading.work, user_codes=codes_of(machine, name)))


def of_machine(name: str) -> Reading:
    """Return how programs of a machine are read live: with the tools, variables and codes that its file names."""
    from trochia.languages.gcode.reading import Reading  # noqa: PLC0415 - only where files are read
    from trochia.languages.gcode.setup import SetupFiles, read_setup  # noqa: PLC0415

    given, reading = _of_machine(SetupFiles(), Reading(), name)
    return read_setup(given, reading)[1]


def _run_and_save(command: Callable[..., Any], given: SetupFiles, reading: Reading, values: dict[str, Any]) -> None:
    """Run the command; where it says yes, write what the program has left."""
    from trochia.languages.gcode.setup import check_place, save  # noqa: PLC0415 - only where files are written

    check_place(given)
    left: list[WorkState] = []
    try:
        command(reading=replace(reading, on_end=left.append), **values)
    except SystemExit as end:
        if not end.code and left:
            save(given, left[-1], reading.work)
        raise
    if left:
        save(given, left[-1], reading.work)
