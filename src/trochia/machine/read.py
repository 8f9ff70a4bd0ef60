"""A machine file's tables to a Machine.  In: a TOML document as dicts.  Out: a Machine, or every mistake."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from trochia.errors import MachineError
from trochia.machine.axes import LETTERS, Axis, AxisKind, check_letter
from trochia.machine.codecs import Text
from trochia.machine.io import Channel
from trochia.machine.joints import Joint
from trochia.machine.kinematics import KINEMATICS, Kinematics
from trochia.machine.machine import Machine
from trochia.machine.schema import keys_of
from trochia.machine.table import Book, Incomplete, Table, build, construct, fields
from trochia.units import did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Mapping

FORMAT = 1  #: the version of the machine file this release reads and writes


def read(document: Mapping[str, object], file: str, text: str = "") -> tuple[Machine | None, list[MachineError]]:
    """Return the machine, or None with every mistake in it, each in its place in ``text``."""
    book = Book(file, text)
    top = Table(document, book)
    machine = None
    with book.catch():
        _check_format(top)
        machine = _machine(top)
    return (None, book.problems) if book.problems else (machine, [])


def _check_format(top: Table) -> None:
    """Refuse another version, or none, by name."""
    version = top.take("format")
    if version is None:
        raise top.error("format", "missing", hint=f"A machine file begins with format = {FORMAT}.")
    if version != FORMAT or isinstance(version, bool):
        raise top.error("format", f"expected {FORMAT}, the version this release reads, not {shown(version)}")


def _machine(top: Table) -> Machine:
    """Return the machine; parts that are wrong are noted, and then there is none."""
    book = top.book
    before = len(book.problems)
    axes, rotary = _axes(top)
    joints, kinematics = _joints(top, rotary)
    io: list[Channel] = []
    for name, table in _section(top, "io").items():
        with book.catch():
            io.append(build(table, Channel, name=name))
    values = fields(top, Machine, rotary=False, given={})
    top.refuse_rest()
    if len(book.problems) > before:
        raise Incomplete("")
    return construct(
        top, Machine, {**values, "axes": axes, "joints": joints, "kinematics": kinematics, "io": tuple(io)}
    )


def _section(top: Table, name: str) -> dict[str, Table]:
    """Return the tables of a section, or none where it is no table, which is noted."""
    with top.book.catch():
        return top.tables(name)
    return {}


def _axes(top: Table) -> tuple[tuple[Axis, ...], dict[str, bool]]:
    """Return the axes in the letters' order, whatever their order in the file, and of every letter if it is rotary."""
    axes: list[Axis] = []
    rotary: dict[str, bool] = {}
    tables = _section(top, "axes")
    if "axes" not in top:
        with top.book.catch():
            raise top.error("axes", "missing; expected a table for each axis, like [axes.X]")
    for name, table in tables.items():
        with top.book.catch():
            check_letter(name)
            kind = cast("AxisKind | None", table.read("kind", cast("Text", keys_of(Axis)["kind"].codec)))
            kind = kind or (AxisKind.ROTARY if name in tuple("ABC") else AxisKind.LINEAR)
            rotary[name] = kind is AxisKind.ROTARY
            axes.append(build(table, Axis, rotary=rotary[name], name=name, kind=kind))
    ordered = sorted(rotary, key=LETTERS.index)
    return tuple(sorted(axes, key=lambda axis: ordered.index(axis.name))), {name: rotary[name] for name in ordered}


def _joints(top: Table, rotary: dict[str, bool]) -> tuple[tuple[Joint, ...], Kinematics | None]:
    """Return the joints in the file's order, and the kinematics that fits them."""
    tables = _section(top, "joints")
    kinematics: Kinematics | None = None
    with top.book.catch():
        kinematics = _kinematics(top, tuple(rotary), tables)
    if "joints" not in top:
        with top.book.catch():
            raise top.error("joints", "missing; expected a table for each motor, like [joints.X]")
    joints: list[Joint] = []
    rows = () if kinematics is None else kinematics.matrix  # without it their units are not known: one mistake, no echo
    for row, (name, table) in zip(rows, tables.items(), strict=False):
        turns = any(is_rotary for is_rotary, c in zip(rotary.values(), row, strict=True) if c)
        with top.book.catch():
            joints.append(build(table, Joint, rotary=turns, name=name))
    return tuple(joints), kinematics


def _kinematics(top: Table, letters: tuple[str, ...], tables: Mapping[str, Table]) -> Kinematics:
    """Return the kinematics the file names, fitted to axes and joints."""
    kind = top.read("kinematics", Text())
    if kind is None:
        raise top.error("kinematics", f"missing; expected one of {', '.join(KINEMATICS)}")
    assert isinstance(kind, str)
    if kind not in KINEMATICS:
        raise top.error("kinematics", f"expected one of {', '.join(KINEMATICS)}, not {kind!r}",
                        hint=did_you_mean(kind, KINEMATICS))  # fmt: skip
    declared = top.take("axes")
    if not isinstance(declared, dict) or len(letters) != len(cast("dict[str, object]", declared)):
        # noted already; a fit would only echo it
        raise Incomplete("axes")
    drives = {name: cast("str | None", table.read("axis", Text())) for name, table in tables.items()}
    try:
        return KINEMATICS[kind].fit(letters, drives)
    except MachineError as error:
        raise top.book.placed(error) from None
