"""`trochia gateway`: another program's protocol in front of a machine."""

from __future__ import annotations

import signal
import threading
from ipaddress import ip_address
from pathlib import Path
from typing import TYPE_CHECKING

import click

from trochia.cli import options
from trochia.cli.mover import check, clock_of, mover, mover_options

if TYPE_CHECKING:
    from trochia.gateways.grbl.doors import Door


@click.group()
def command() -> None:
    """Let other programs drive a machine in their own protocol.

    Example: trochia gateway grbl -m router --tcp 127.0.0.1:2323
    """


@command.command()
@options.machine
@mover_options("twin", "avr", "simavr")
@click.option("--tcp", metavar="HOST:PORT", help="Listen on a TCP port, as 127.0.0.1:2323; port 0 takes a free one.")
@click.option("--pty", is_flag=True, help="Be a pseudo-terminal, for senders that want a serial port.")
@click.option("--link", type=click.Path(path_type=Path), metavar="PATH", help="Name to give the pseudo-terminal.")
@click.option("--public", is_flag=True, help="Allow an address that other computers reach; GRBL knows no password.")
@click.option("--arm-beam", is_flag=True, help="Let senders light the beam.")
@click.option("--journal", type=click.Path(file_okay=False, path_type=Path), metavar="DIR",
              help="Folder of the machine's journal; without it nothing is kept.")  # fmt: skip
def grbl(
    *, machine_name: str, backend: str, port: str | None, baud: int | None, board: str | None, tcp: str | None,
    pty: bool, link: Path | None, public: bool, arm_beam: bool, journal: Path | None,
) -> None:  # fmt: skip
    """Speak GRBL 1.1 for a twin or a board, until Ctrl-C: UGS, CNCjs, bCNC, LaserGRBL, LightBurn can connect.

    Example: trochia gateway grbl -m router --pty --link /tmp/ttyTrochia
    """
    if (tcp is None) is (not pty):
        raise click.UsageError("say one of --tcp HOST:PORT and --pty")
    if link is not None and not pty:
        raise click.UsageError("--link names a pseudo-terminal: it needs --pty")
    check(backend, port)
    host, number = _address(tcp or "127.0.0.1:0", public=public)
    from trochia.cli.setup import of_machine  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.cli.user_codes import attach  # noqa: PLC0415
    from trochia.controller.runtime import Runtime  # noqa: PLC0415
    from trochia.gateways.grbl import Service, TcpDoor, TerminalDoor  # noqa: PLC0415
    from trochia.machine.load import load  # noqa: PLC0415
    from trochia.server.rest import bring_to_rest  # noqa: PLC0415

    machine = load(machine_name)
    moves = mover(machine, backend, port=port, baud=baud, board=board)
    door: Door = TerminalDoor(link) if pty else TcpDoor(host, number)
    clock, reading = clock_of(backend), of_machine(machine_name)
    runtime = Runtime(moves, journal=journal, work=reading.work, reading=reading, now=clock())
    end_codes = attach(runtime, machine, machine_name)
    over = threading.Event()
    # as Ctrl-C: an event set from a handler would wait for the lock that the very wait it interrupts may hold
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    runtime.start(clock)
    click.echo(f"{machine.name} ({moves.title}) speaks GRBL 1.1 at {door.name} (Ctrl-C ends)")
    try:
        Service(runtime, door, arm=arm_beam).run(over)
    except KeyboardInterrupt:
        click.echo("stopping")
    finally:
        door.close()
        bring_to_rest(runtime)
        runtime.close()
        end_codes()


def _address(text: str, *, public: bool) -> tuple[str, int]:
    """Return host and port; refuse an address that others reach, unless that is wanted."""
    host, _, number = text.rpartition(":")
    host = host or "127.0.0.1"
    if not number.isdigit() or int(number) > 65535:
        raise click.UsageError(f"expected HOST:PORT, like 127.0.0.1:2323, not {text!r}")
    try:
        loopback = host == "localhost" or ip_address(host).is_loopback
    except ValueError:
        loopback = False
    if not loopback and not public:
        raise click.UsageError(f"whoever reaches {host} could move the machine: say --public if that is meant")
    return host, int(number)
