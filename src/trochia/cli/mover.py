"""Who moves the machine: its twin, or a board with Trochia's image.

In: what the command line says.  Out: a live backend, not yet opened.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.backends.live import SegmentBackend
    from trochia.machine.machine import Machine


def mover_options(command: Callable[..., None]) -> Callable[..., None]:
    """Add the options that say who moves; the command gets them as ``backend``, ``port``, ``baud``, ``board``."""
    for decorate in (
        click.option("--board", metavar="BOARD", default="uno-stepdir", show_default=True,
                     help="Which board it is (--backend avr)."),
        click.option("--baud", type=click.IntRange(min=1200), default=115200, show_default=True, help="Its baud rate."),
        click.option("--port", metavar="DEVICE", help="Serial port of a board (--backend avr or grbl)."),
        click.option("--backend", type=click.Choice(["twin", "avr", "grbl"]), default="twin", show_default=True,
                     help="Who moves: the twin, a board with Trochia's image, one with GRBL."),
    ):  # fmt: skip
        command = decorate(command)
    return command


def check(backend: str, port: str | None, *, virtual: bool, kept: bool) -> None:
    """Refuse options that do not go together; ``kept``: a journal or a recording is asked for."""
    if (backend != "twin") != (port is not None):
        raise click.UsageError("--backend avr or grbl and --port DEVICE go together")
    if backend == "grbl" and kept:
        raise click.UsageError("a GRBL board has no journal: leave --journal and --record out")
    if virtual and backend != "twin":
        raise click.UsageError("a board has its own clock: leave --virtual out")


def mover(machine: Machine, backend: str, *, port: str | None, baud: int, board: str, virtual: bool) -> SegmentBackend:
    """Return the twin, or the board on a port.

    Raises
    ------
    LinkError
        When the port cannot be opened.
    ConfigError
        When the machine is not one for this board.
    """
    if backend == "avr" and port is not None:
        from trochia.backends.avr.live_avr import LiveAvr  # noqa: PLC0415 - only where there is one
        from trochia.backends.avr.transports import SerialTransport  # noqa: PLC0415
        from trochia.backends.avr.wiring import BOARDS  # noqa: PLC0415

        if board not in BOARDS:
            raise click.UsageError(f"no board is called {board!r}; there are {', '.join(BOARDS)}")
        return LiveAvr(machine, SerialTransport(port, baud=baud), board=board)
    from trochia.backends.live_twin import DEEP, SHALLOW, LiveTwin  # noqa: PLC0415
    from trochia.backends.switches import switches_of  # noqa: PLC0415

    return LiveTwin(machine, switches=switches_of(machine), ahead=SHALLOW if virtual else DEEP)
