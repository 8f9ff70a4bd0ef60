"""The few honest calls: load a machine, read a program, check it, plan it, simulate it.

``load → read or gcode → check → plan → simulate``; everything else is in the rooms below and public too.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from trochia.analysis.check import Verdict, judge
from trochia.analysis.plan import Plan, make
from trochia.analysis.problems import Problem, Severity, from_error
from trochia.analysis.travel import shift_that_fits, travel_error
from trochia.errors import OutOfTravelError, PlanningError, ProgramError
from trochia.languages import gcode as language
from trochia.machine.load import load
from trochia.program import AXES

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from trochia.machine.machine import Machine
    from trochia.program import Program
    from trochia.recorder import Recording

    Place = Mapping[str, float]
    Progress = Callable[[str, float], None]

__all__ = ["Plan", "Verdict", "check", "gcode", "load", "plan", "read", "simulate"]


def gcode(
    text: str | bytes,
    machine: Machine | None = None,
    *,
    at: Place | None = None,
    name: str = "<text>",
    reading: language.Reading | None = None,
) -> Program:
    """Return the program of a G-code text, in machine coordinates.

    Parameters
    ----------
    machine
        Where it will run; motion begins at its zero, or where its travel comes nearest to that.
    at
        Offset of the program's zero, {axis: mm or degree}.
    reading
        How programs are read: folders of subroutines, bounds.

    Raises
    ------
    ProgramError
        At the first wrong line, with what to do about it.
    """
    reading = _for_machine(reading, machine)
    work = reading.work.placed(**(at or {}))
    return language.read(text, name=name, work=work, start=_start(machine), reading=reading)


def read(path: str | Path, machine: Machine | None = None, *, at: Place | None = None) -> Program:
    """Return the program of a G-code file; see :func:`gcode`."""
    return gcode(Path(path).read_bytes(), machine, at=at, name=str(path))


def plan(program: Program, machine: Machine, *, profile: str | None = None) -> Plan:
    """Return the plan of a program: path, motion over time, and their figures.

    Raises
    ------
    OutOfTravelError
        When motion would leave the machine's travel, naming the first line.
    PlanningError
        When the machine cannot do it for another reason.
    """
    made = make(program, machine, profile=profile)
    error = travel_error(made)
    if error is not None:
        raise error
    return made


def check(
    text: str | bytes,
    machine: Machine,
    *,
    at: Place | None = None,
    name: str = "<text>",
    profile: str | None = None,
    first_only: bool = True,
    reading: language.Reading | None = None,
) -> Verdict:
    """Return whether a G-code text will run on a machine: errors, warnings, margins, time.

    Parameters
    ----------
    first_only
        Report the first bad line and how many more there are, not all of them.
    reading
        As in :func:`gcode`.
    """
    remarks: list[Problem] = []

    def remark(line: int, message: str) -> None:
        remarks.append(Problem(severity=Severity.WARNING, code="dialect", file=name, line=line, message=message))

    reading = replace(_for_machine(reading, machine), on_remark=remark)
    try:
        made = make(gcode(text, machine, at=at, name=name, reading=reading), machine, profile=profile)
    except ProgramError:
        reading = replace(reading, on_end=None, on_remark=None)
        work = reading.work.placed(**(at or {}))
        errors = language.problems(text, name=name, work=work, start=_start(machine), reading=reading)
        found = tuple(from_error(error, name) for error in errors)
        return Verdict(problems=found[:1], more=len(found) - 1) if first_only else Verdict(problems=found)
    except PlanningError as error:
        return Verdict(problems=(from_error(error, name),))
    verdict = judge(made)
    if verdict.problems and verdict.problems[0].code == OutOfTravelError.code:
        hint = _where_it_fits(text, made, at or {}, profile, replace(reading, on_remark=None))
        verdict = replace(verdict, problems=(replace(verdict.problems[0], hint=hint), *verdict.problems[1:]))
    return replace(verdict, problems=(*verdict.problems, *remarks))


def simulate(planned: Plan, folder: str | Path | None = None, *, period: float | None = None) -> Recording:
    """Run a plan on the digital twin and return the recording of every axis and joint.

    Parameters
    ----------
    folder
        Where the recording is kept (then it may be longer than memory); without it, it stays in memory.
    period
        Time between samples [s]; without it the machine's servo period.
    """
    from trochia import recorder  # noqa: PLC0415 - planning needs no recorder
    from trochia.backends import Twin  # noqa: PLC0415 - nor a twin

    twin = Twin(machine=planned.machine, period=period)
    header = twin.header(planned.trajectory, program=planned.program.name)
    blocks = twin.run(planned.trajectory)
    if folder is None:
        return recorder.gather(header, blocks)
    recorder.write(folder, header, blocks)
    return recorder.read(folder)


def _for_machine(reading: language.Reading | None, machine: Machine | None) -> language.Reading:
    """Return how a program is read, in the machine's dialect where nothing else is said."""
    reading = reading or language.Reading()
    if machine is None or reading.dialect is not None:
        return reading
    return replace(reading, dialect=language.DIALECTS[machine.dialect])


def _start(machine: Machine | None) -> tuple[float, ...]:
    """Return where motion begins (9) [mm, degree]: machine zero, or the nearest point to it inside the travel."""
    start = dict.fromkeys(AXES, 0.0)
    for axis in machine.axes if machine else ():
        start[axis.name] = min(max(0.0, axis.minimum), axis.maximum)
    return tuple(start.values())


def _where_it_fits(
    text: str | bytes, made: Plan, at: Place, profile: str | None, reading: language.Reading | None
) -> str:
    """Return the offset at which a program would fit, tried before it is said."""
    reading = replace(reading or language.Reading(), on_end=None)  # a trial leaves nothing behind
    shift = shift_that_fits(made)
    if shift is None:
        return "The part is larger than the travel: no offset makes it fit."
    place = dict(at)
    for axis, value in shift.items():
        place[axis] = place.get(axis, 0.0) + value
    moved = make(gcode(text, made.machine, at=place, reading=reading), made.machine, profile=profile)
    if travel_error(moved) is not None:
        return "An offset does not help: the program moves in machine or incremental coordinates."
    words = "".join(f"{axis}{value:g}" for axis, value in sorted(place.items(), key=lambda pair: AXES.index(pair[0])))
    return f"It fits with the part at another place: --at {words}"
