"""A program and a machine from the command line to a verdict: what `check`, `plan` and `simulate` share."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from trochia import api
from trochia.cli.progress import Progress
from trochia.program import Message, UserCode

if TYPE_CHECKING:
    from collections.abc import Mapping

    from trochia.analysis.check import Verdict
    from trochia.languages.gcode import Reading
    from trochia.machine.machine import Machine


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
) -> Job:
    """Read the program (``-`` is standard input) and the machine, and judge the one on the other."""
    machine = api.load(machine_name)
    name = "<stdin>" if program == "-" else program
    with Progress() as progress:
        progress("reading", 0.0)
        text = sys.stdin.buffer.read() if program == "-" else Path(program).read_bytes()
        verdict = api.check(text, machine, at=place, name=name, profile=profile, first_only=first_only, reading=reading)
    show_messages(verdict)
    return Job(name=name, text=text, machine=machine, verdict=verdict)


def show_messages(verdict: Verdict) -> None:
    """Print what the program says to its operator and what it calls of the machine's own, on standard error."""
    if verdict.plan is None:
        return
    for action in verdict.plan.program.actions:
        if isinstance(action, Message):
            click.echo(f"line {action.line}: {action.text}", err=True)
        elif isinstance(action, UserCode):
            click.echo(f"line {action.line}: calls {action}, a code of the machine's own", err=True)
