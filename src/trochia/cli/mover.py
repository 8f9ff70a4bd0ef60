"""Who moves the machine: its twin, or a board with Trochia's image, real or simulated.

In: what the command line says.  Out: a live backend, not yet opened, and the clock it goes by.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.backends.live import SegmentBackend
    from trochia.machine.machine import Machine

PORTED = ("avr", "grbl")  #: backends that are on a serial port
FIRST, SLOW = "uno-stepdir", 115_200  #: board and baud rate where nothing is said
OURS = ("avr", "simavr")  #: boards with Trochia's image


def mover_options(*kinds: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Return what adds the options that say who moves: the command gets ``backend``, ``port``, ``baud``, ``board``."""
    boards = " or ".join(kind for kind in kinds if kind in PORTED)
    told = {"twin": "the twin", "avr": "a board with Trochia's image", "grbl": "one with GRBL",
            "simavr": "that image on a simulated chip"}  # fmt: skip
    options = (
        click.option("--board", metavar="BOARD", callback=_or_none,
                     help="Which board it is (--backend avr or simavr); the machine file's, else uno-stepdir."),
        click.option("--baud", type=click.IntRange(min=1200),
                     help="Its baud rate; the machine file's, else 115200."),
        click.option("--port", metavar="DEVICE", help=f"Serial port of a board (--backend {boards})."),
        click.option("--backend", type=click.Choice(kinds), default="twin", show_default=True,
                     help=f"Who moves: {', '.join(told[kind] for kind in kinds)}."),
    )  # fmt: skip

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        for option in options:
            command = option(command)
        return command

    return decorate


def board_named(board: str) -> str:
    """Return the name of a board, if there is such a one."""
    from trochia.backends.avr.wiring import BOARDS  # noqa: PLC0415 - only where there is one

    if board not in BOARDS:
        raise click.UsageError(f"no board is called {board!r}; there are {', '.join(BOARDS)}")
    return board


def _or_none(_context: click.Context, _parameter: click.Parameter, value: str | None) -> str | None:
    return None if value is None else board_named(value)


def board_of(machine: Machine, board: str | None, baud: int | None) -> tuple[str, int] | None:
    """Return the board and its baud rate: what the command line says, else the machine file; None: neither does."""
    file = machine.board
    if board is None and file is None:
        return None
    own = file is not None and board in {None, file.kind}
    return board or (file.kind if file else FIRST), baud or (file.baud if file is not None and own else SLOW)


def for_board(command: Callable[..., None]) -> Callable[..., None]:
    """Add the options that say for which board to judge; the command gets them as ``board`` and ``baud``."""
    for decorate in (
        click.option("--baud", type=click.IntRange(min=1200),
                     help="The board's baud rate; the machine file's, else 115200."),
        click.option("--board", metavar="BOARD", callback=_or_none,
                     help="Judge whether this board with Trochia's image can run it, too; the machine file's if it "
                          "names one."),
    ):  # fmt: skip
        command = decorate(command)
    return command


def check(backend: str, port: str | None, *, virtual: bool = False, kept: bool = False) -> None:
    """Refuse options that do not go together; ``kept``: a journal or a recording is asked for."""
    if (backend in PORTED) != (port is not None):
        raise click.UsageError("--backend avr or grbl and --port DEVICE go together")
    if backend == "grbl" and kept:
        raise click.UsageError("a GRBL board has no journal: leave --journal and --record out")
    if virtual and backend in PORTED:
        raise click.UsageError("a board has its own clock: leave --virtual out")


def mover(
    machine: Machine, backend: str, *, port: str | None, baud: int | None, board: str | None, virtual: bool = False
) -> SegmentBackend:
    """Return the twin, or the board on a port or a simulated chip.

    Raises
    ------
    LinkError
        When the port cannot be opened.
    ConfigError
        When the machine is not one for this board, or a chip cannot be simulated here.
    """
    from trochia.backends.switches import switches_of  # noqa: PLC0415 - `trochia --help` must stay light

    if backend in OURS:
        from trochia.backends.avr.live_avr import LiveAvr  # noqa: PLC0415 - only where there is one

        board, baud = board_of(machine, board, baud) or (FIRST, baud or SLOW)
        if port is None:
            from trochia.backends.avr.simulator import simulated  # noqa: PLC0415

            made = LiveAvr(machine, simulated(board, baud=baud), board=board)
            made.inputs.follow(switches_of(machine))
            return made
        from trochia.backends.avr.transports import SerialTransport  # noqa: PLC0415

        return LiveAvr(machine, SerialTransport(port, baud=baud), board=board)
    from trochia.backends.live_twin import DEEP, SHALLOW, LiveTwin  # noqa: PLC0415

    return LiveTwin(machine, switches=switches_of(machine), ahead=SHALLOW if virtual else DEEP)


def clock_of(backend: str) -> Callable[[], float]:
    """Return the clock that a backend of this kind goes by, in real time [s]."""
    if backend == "simavr":
        from trochia.backends.avr.simulator import UnhurriedClock  # noqa: PLC0415

        return UnhurriedClock()
    return time.monotonic
