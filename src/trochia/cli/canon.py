"""``trochia canon``: a program's canonical commands, one per line."""

from __future__ import annotations

import io
import os
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from trochia.cli import options
from trochia.files import whole_file

if TYPE_CHECKING:
    from trochia.languages.gcode.reading import Reading


@click.command()
@click.argument("program", metavar="PROGRAM", type=options.type_program)
@click.option("-o", "--output", type=click.Path(dir_okay=False, writable=True), metavar="FILE",
              help="Write to a file, whole or not at all, instead of standard output.")  # fmt: skip
@click.option("--block-delete", is_flag=True, help="Leave out lines that begin with /.")
@options.reading
@options.as_json
def command(*, program: str, output: str | None, block_delete: bool, as_json: bool, reading: Reading) -> None:
    """Print the canonical commands of PROGRAM (- reads standard input).

    They are spelt as LinuxCNC's stand-alone interpreter does (`rs274 -g`, without its first two columns), in program
    units and coordinates.

    Example: trochia canon programs/contour.ngc
    """
    from trochia.languages.gcode.canon import print_text  # noqa: PLC0415 - `trochia --help` must stay light

    name = "<stdin>" if program == "-" else program

    def remark(line: int, message: str) -> None:
        click.echo(f"warning: {name}:{line}: {message}", err=True)

    reading = replace(reading, on_remark=remark)
    text = sys.stdin.buffer.read() if program == "-" else Path(program).read_bytes()
    if as_json:
        _print_json(text, name, block_delete=block_delete, reading=reading)
    elif output is not None:
        with whole_file(Path(output)) as out:
            print_text(text, out, name=name, block_delete=block_delete, reading=reading)
    else:
        try:
            print_text(text, sys.stdout.buffer, name=name, block_delete=block_delete, reading=reading)
            sys.stdout.flush()
        except BrokenPipeError:  # the reader has seen enough
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _print_json(text: bytes, name: str, *, block_delete: bool, reading: Reading) -> None:
    """Print ``{ok, commands, problems}``; a rejected program has the commands before its first wrong line."""
    from dataclasses import asdict  # noqa: PLC0415 - as above

    from trochia.analysis.problems import from_error  # noqa: PLC0415 - as above
    from trochia.errors import ProgramError  # noqa: PLC0415 - as above
    from trochia.languages.gcode.canon import print_text  # noqa: PLC0415 - as above

    out, problems = io.BytesIO(), []
    try:
        print_text(text, out, name=name, block_delete=block_delete, reading=reading)
    except ProgramError as error:
        problems = [asdict(from_error(error, name))]
    commands = out.getvalue().decode("latin-1").split("\n")[:-1]
    options.print_json({"ok": not problems, "commands": commands, "problems": problems})
    if problems:
        sys.exit(1)
