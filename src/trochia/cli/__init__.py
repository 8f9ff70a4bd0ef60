"""The command line: one file per command, loaded when it is called.

Exit codes: 0 yes; 1 the program is at fault; 2 the command line, machine or tool file is at fault or unreadable.
"""

from __future__ import annotations

import sys
from importlib import import_module

import click

from trochia.errors import MachineError, TrochiaError

#: command -> one line of help; the module of the same name holds the click command as ``command``
COMMANDS = {
    "check": "Will it run?  Language, travel, limits; names the first bad line.",
    "canon": "Print a program's canonical commands, one per line.",
    "plan": "Time, length, extents and per-line timing of a program.",
    "simulate": "Run a program on the digital twin: recording and report.",
    "run": "Run a program on a machine, under the live controller.",
    "replay": "Look at a recording, or hold a run against its plan or another run.",
    "bundle": "Pack versions, machine file, journal and last recording for who can help.",
    "serve": "Serve a machine over HTTP and WebSocket, with a page that shows it and stops it.",
    "users": "Who may log in to a served machine.",
    "boards": "What is on the serial ports: our boards, GRBL boards, nothing.",
    "flash": "Write Trochia's image to a board.",
    "gateway": "Let senders of another protocol drive a machine: GRBL 1.1.",
    "interpolate": "Compare the classic interpolators on a line or an arc.",
    "excitation": "What each step switches on: levels, field, latch bytes; as a table and a picture.",
    "motors": "The library of real steppers: list, search, show what follows from their numbers.",
    "profile": "A stepper's velocity profile, step by step, and whether it will do.",
    "sweep": "A stepper's torque-speed curve behind its driver, with a program's operating points.",
    "size": "Is a joint's motor strong, fast and cool enough for what it has to do?",
    "identify": "Find an axis' model: by experiment on its twin, or from measured motion.",
    "tune": "Gains for a servo joint or a model: margins, before and after.",
    "machine": "New, show, check, import: machine files.",
}


class _LazyGroup(click.Group):
    """A group whose commands are imported when they are called, so that ``--help`` stays light."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        del ctx
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        del ctx
        if cmd_name not in COMMANDS:
            return None
        return import_module(f"trochia.cli.{cmd_name}").command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        del ctx
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


@click.command(cls=_LazyGroup, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(package_name="trochia", message="trochia %(version)s")
def group() -> None:
    """Plan a job, prove it on a digital twin, run the same plan.

    Example: trochia simulate programs/contour.ngc -m xy-table -o out
    """


def exit_code(error: TrochiaError) -> int:
    """Return 2 where the machine or tool file is at fault, 1 where the program is."""
    return 2 if isinstance(error, MachineError) else 1


def main() -> None:
    """Run the command line; a user's mistake is one message and an exit code, never a traceback."""
    try:
        group(standalone_mode=False)
    except click.ClickException as error:
        error.show()
        sys.exit(2)
    except click.Abort:
        click.echo("stopped", err=True)
        sys.exit(130)
    except TrochiaError as error:
        click.echo(f"error: {error}", err=True)
        sys.exit(exit_code(error))
    except OSError as error:
        click.echo(f"error: {error.filename or 'file'}: {error.strerror or error}", err=True)
        sys.exit(2)
