"""`trochia check`: whether a program will run."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import click

from trochia.cli import options
from trochia.cli.job import judge
from trochia.cli.mover import board_of, for_board
from trochia.cli.tables import clock, show_verdict

if TYPE_CHECKING:
    from trochia.languages.gcode import Reading


@click.command()
@options.common
@for_board
@click.option("--all", "show_all", is_flag=True, help="Report every bad line, not only the first.")
def command(
    *, program: str, machine_name: str, place: dict[str, float], profile: str | None, as_json: bool, reading: Reading,
    show_all: bool, board: str | None, baud: int | None,
) -> None:  # fmt: skip
    """Will it run?  Language, travel, limits; names the first bad line.

    Nothing is simulated; exit code 0 says yes (warnings included), 1 no.

    Example: trochia check part.ngc -m router --at X10Y20
    """
    job = judge(program, machine_name, place, profile, reading=reading, first_only=not show_all,
                board_of=lambda machine: board_of(machine, board, baud))  # fmt: skip
    if as_json:
        options.print_json(job.verdict.figures())
    else:
        show_verdict(job.verdict)
        if job.verdict.time_s is not None:
            click.echo(f"time {clock(job.verdict.time_s)} on {job.machine.name}")
    sys.exit(0 if job.verdict.ok else 1)
