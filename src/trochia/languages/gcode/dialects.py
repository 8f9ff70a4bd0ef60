"""Dialects: what files written for other controllers mean where they do not speak LinuxCNC's language.

In: nothing.  Out: :data:`DIALECTS`, one frozen description each, which :mod:`trochia.languages.gcode.adapt` follows and
the reference page lists.  A difference that is not here does not exist.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping


@dataclass(frozen=True, slots=True, kw_only=True)
class Dialect:
    """Where a controller's language differs.

    Attributes
    ----------
    about
        Whose files these are.
    needs_end
        A program without M2, M30 or a closing ``%`` is an error; else it is ended, with a warning.
    dwell
        Words of G4 and their unit [s]; ``p`` is always among them.
    unknown_m
        Unknown M codes are an error; else they are left out, with a warning.
    whole_line
        With an M code that is left out goes everything on its line, because one command stands on a line.
    replaced
        M codes by number, and the words they stand for.
    mirrors
        M codes by number: letter of the axis, and whether it is mirrored from here on.
    left_out
        Codes that have another meaning there, which nothing here has: left out, with that remark.
    remarks
        Codes that are taken, but with a remark.
    program_numbers
        A line may begin with the number of the program, O1234 or :1234.
    checksums
        ``*`` and what follows it is no part of the line.
    bare_axes
        An axis letter without a number stands for the axis (G28 X Y).
    dropped_words
        Letters of words that nothing here has: left out, with a warning.
    refused
        First characters of lines that are commands to the controller, and what to say to them.
    """

    name: str
    about: str
    needs_end: bool = False
    dwell: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({"p": 1.0}))
    unknown_m: bool = False
    whole_line: bool = False
    replaced: Mapping[int, str] = field(default_factory=lambda: MappingProxyType({}))
    mirrors: Mapping[int, tuple[str, bool]] = field(default_factory=lambda: MappingProxyType({}))
    left_out: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    remarks: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    program_numbers: bool = False
    checksums: bool = False
    bare_axes: bool = False
    dropped_words: frozenset[str] = frozenset()
    refused: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))


LINUXCNC = Dialect(
    name="linuxcnc",
    about="LinuxCNC 2.9, the language itself",
    needs_end=True,
    unknown_m=True,
)

GRBL = Dialect(
    name="grbl",
    about="GRBL 1.1 and what speaks like it",
    remarks={"m4": "GRBL lowers the beam's power with the speed (M4); here it is constant, as with M3"},
    refused={
        "$": "a GRBL command is no part of a program: set the machine up in its machine file",
        "?": "a GRBL status query is no part of a program",
    },
)

FANUC = Dialect(
    name="fanuc",
    about="Fanuc-like mills, as CAM posts write for them",
    dwell={"p": 0.001, "x": 1.0, "u": 1.0},
    mirrors={70: ("x", True), 71: ("y", True), 80: ("x", False), 81: ("y", False)},
    program_numbers=True,
    remarks={
        "m70": "M70 mirrors X (in LinuxCNC it saves the modes)",
        "m71": "M71 mirrors Y (in LinuxCNC it forgets saved modes)",
    },
)

MARLIN = Dialect(
    name="marlin",
    about="Marlin and other printers' firmware",
    dwell={"p": 0.001, "s": 1.0},
    whole_line=True,
    replaced={106: "M3", 107: "M5"},
    left_out={
        "g10": "Marlin retracts filament by G10",
        "g11": "Marlin feeds filament back by G11",
        "g29": "Marlin levels the bed by G29",
    },
    remarks={"g28": "Marlin searches its switches by G28; here the axes go to the stored point, machine zero"},
    checksums=True,
    bare_axes=True,
    dropped_words=frozenset("e"),
)

#: name -> dialect
DIALECTS: Mapping[str, Dialect] = MappingProxyType(
    {dialect.name: dialect for dialect in (LINUXCNC, GRBL, FANUC, MARLIN)}
)
