"""What a program finds set up, from the files that say so: tools, variables, folders of subroutines, startup code.

In: paths of a tool table (``.tbl``), a parameter file (``.var``) and a LinuxCNC ini.  Out: :class:`SetupFiles`, and a
:class:`~trochia.languages.gcode.reading.Reading` with what they say.

Of an ini these keys are read, paths relative to its folder: ``[RS274NGC] PARAMETER_FILE``, ``SUBROUTINE_PATH``,
``RS274NGC_STARTUP_CODE``; ``[EMCIO] TOOL_TABLE``; ``[TRAJ] LINEAR_UNITS``.  All of it is kept for ``#<_ini[...]>``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from trochia.errors import ConfigError
from trochia.files import write_whole
from trochia.languages.gcode.reading import USUAL, Reading
from trochia.machine.importers.ini import settings
from trochia.program.parameter_file import read_variables, variables_of, work_from, write_variables
from trochia.program.tool_file import read_tools, write_tools

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from trochia.program.work import WorkState

INCH = 25.4  # mm
_UNITS = {"mm": 1.0, "metric": 1.0, "in": INCH, "inch": INCH, "imperial": INCH}


@dataclass(frozen=True, slots=True, kw_only=True)
class SetupFiles:
    """Which files say what a program finds; None: none.

    Attributes
    ----------
    tools, parameters
        Tool table and parameter file.
    home
        Folder outside which the parameter file is not written, because another file there names it.
    """

    tools: Path | None = None
    parameters: Path | None = None
    home: Path | None = None


def read_setup(
    files: SetupFiles, reading: Reading = USUAL, *, ini: Path | None = None, new_parameters: bool = False
) -> tuple[SetupFiles, Reading]:
    """Return the files after the ini had its say, and the reading with what they say.

    Parameters
    ----------
    files
        Those that are given; they come before the ini's.
    reading
        What is set up besides; the ``unit`` of its work is that of the files unless the ini says LINEAR_UNITS.
    new_parameters
        A parameter file that is not there counts as empty, because it will be written.

    Raises
    ------
    ConfigError
        For a file that cannot be read, or is wrong.
    """
    if ini is not None:
        files, reading = _with_ini(files, reading, ini)
    work = reading.work
    if files.tools is not None:
        tools = read_tools(_text(files.tools, "the tool table"), str(files.tools), unit=work.unit)
        work = replace(work, tools=tools)
    if files.parameters is not None and not (new_parameters and not files.parameters.exists()):
        variables = read_variables(_text(files.parameters, "the parameter file"), str(files.parameters))
        work = work_from(variables, work, unit=work.unit)
    return files, replace(reading, work=work)


def _with_ini(files: SetupFiles, reading: Reading, ini: Path) -> tuple[SetupFiles, Reading]:
    """Return files and reading with what an ini adds to them."""
    values = _ini_values(ini)
    folder = ini.resolve().parent
    named, table = values.get(("RS274NGC", "PARAMETER_FILE")), values.get(("EMCIO", "TOOL_TABLE"))
    if files.parameters is None and named:
        files = replace(files, parameters=folder / named, home=folder)
    if files.tools is None and table:
        files = replace(files, tools=folder / table)
    paths = values.get(("RS274NGC", "SUBROUTINE_PATH"), "")
    return files, replace(
        reading,
        ini=values,
        startup=values.get(("RS274NGC", "RS274NGC_STARTUP_CODE"), ""),
        subroutines=(*reading.subroutines, *(folder / path for path in paths.split(":") if path)),
        work=replace(reading.work, unit=_unit(values, ini, reading.work.unit)),
    )


def check_place(files: SetupFiles) -> Path:
    """Return the parameter file, which may be written.

    Raises
    ------
    ConfigError
        Without one, or where a file named by another file lies outside that one's folder.
    """
    path, home = files.parameters, files.home
    if path is None:
        raise ConfigError("there is no parameter file to save to", hint="Name one: --parameters FILE.")
    if home is not None and not path.resolve().is_relative_to(home.resolve()):
        raise ConfigError(f"the parameter file {path} lies outside {home}, where its name stands",
                          hint="It is read, not written; to write it, name it by --parameters.")  # fmt: skip
    return path


def save(files: SetupFiles, work: WorkState, before: WorkState) -> None:
    """Write the parameter file, and the tool table where it has changed, each whole or not at all.

    Raises
    ------
    ConfigError
        Where a file cannot or must not be written; see :func:`check_place`.
    """
    path = check_place(files)
    _write(path, write_variables(variables_of(work, unit=work.unit)))
    if files.tools is not None and work.tools is not None and work.tools != before.tools:
        _write(files.tools, write_tools(work.tools, unit=work.unit))


def _write(path: Path, text: str) -> None:
    try:
        write_whole(path, text.encode("latin-1", errors="replace"))
    except OSError as error:
        raise ConfigError(f"{path}: cannot be written: {error.strerror or error}",
                          hint="Is there room, and may you write there?") from None  # fmt: skip


def _ini_values(path: Path) -> dict[tuple[str, str], str]:
    """Return the values of an ini by section and name; where one stands twice, the first counts."""
    values: dict[tuple[str, str], str] = {}
    for setting in settings(_text(path, "the ini file"), separators="=", inline_comments="#;", continued="backslash"):
        values.setdefault((setting.section.upper(), setting.name.upper()), setting.value)
    return values


def _unit(values: Mapping[tuple[str, str], str], path: Path | None, otherwise: float) -> float:
    """Return the length that the files' lengths count in [mm]."""
    said = values.get(("TRAJ", "LINEAR_UNITS"))
    if not said:
        return otherwise
    if said.lower() not in _UNITS:
        raise ConfigError(f"{path}: LINEAR_UNITS is {said!r}", hint="It is mm or inch.")
    return _UNITS[said.lower()]


def _text(path: Path, what: str) -> str:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise ConfigError(f"{path}: cannot read {what}: {error.strerror or error}",
                          hint="Is its name right, and may you read it?") from None  # fmt: skip
    if b"\0" in data:
        raise ConfigError(f"{path}: expected {what} as text, found binary data", hint="Is it the right file?")
    return data.decode("latin-1")
