"""A program and a machine from the command line to a verdict: what `check`, `plan` and `simulate` share."""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from trochia import api
from trochia.analysis.problems import Severity
from trochia.cli.progress import Progress
from trochia.program import Log, Message, UserCode

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from trochia.analysis.check import Verdict
    from trochia.languages.gcode import Reading
    from trochia.machine.machine import Machine
    from trochia.program import Action


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """What the command line names: the text of a program, its name, the machine, and the verdict on both."""

    name: str
    text: bytes
    machine: Machine
    verdict: Verdict


def judge(
    program: str,
    machine_name: str,
    place: Mapping[str, float],
    profile: str | None,
    *,
    reading: Reading,
    first_only: bool = True,
    tell: bool = True,
    board_of: Callable[[Machine], tuple[str, int] | None] | None = None,
) -> Job:
    """Read the program (``-`` is standard input) and the machine, and judge the one on the other.

    ``tell``: print what the program says; who runs it does that as it says it.
    ``board_of``: the board of the machine, and its baud rate: whether that can do it, too.
    """
    machine = api.load(machine_name)
    name = "<stdin>" if program == "-" else program
    with Progress() as progress:
        progress("reading", 0.0)
        text = sys.stdin.buffer.read() if program == "-" else Path(program).read_bytes()
        verdict = api.check(text, machine, at=place, name=name, profile=profile, first_only=first_only, reading=reading)
        board = None if board_of is None else board_of(machine)
        if board is not None and verdict.plan is not None and verdict.ok:
            from trochia.analysis.board import board_problems  # noqa: PLC0415 - only where there is one

            progress("the board", 0.0)
            found = (*verdict.problems, *board_problems(verdict.plan, *board))
            worst_first = sorted(found, key=lambda problem: problem.severity is not Severity.ERROR)
            verdict = replace(verdict, problems=tuple(worst_first))
    if tell and verdict.plan is not None:
        show_messages(verdict.plan.program.actions)
    return Job(name=name, text=text, machine=machine, verdict=verdict)


def show_messages(actions: Iterable[Action]) -> None:
    """Print what a program says to its operator and what it calls of the machine's own, on standard error."""
    for action in actions:
        if isinstance(action, Log) and action.opens:
            continue
        if isinstance(action, Message):
            click.echo(f"line {action.line}: {action.text}", err=True)
        elif isinstance(action, UserCode):
            click.echo(f"line {action.line}: calls {action}, a code of the machine's own", err=True)


def place_of(program: str) -> Path:
    """Return where a program of the command line lies; what comes from standard input lies in the present folder."""
    return Path("stdin" if program == "-" else program)
