"""`trochia serve`: a machine under the live controller, for browsers and programs."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from trochia.cli import options
from trochia.cli.mover import check, clock_of, mover, mover_options

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.backends.live import SegmentBackend
    from trochia.controller.runtime import Runtime
    from trochia.server.desk import Desk
    from trochia.server.doors import Doors
    from trochia.server.listen import Served

LOOPBACK = ("127.0.0.1", "::1", "localhost")
file = click.Path(dir_okay=False, path_type=Path)


def settings_folder() -> Path:
    """Return where users are kept unless told otherwise."""
    return Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config") / "trochia"


def users_option(command: Callable[..., None]) -> Callable[..., None]:
    """Add the option that names the users file."""
    return click.option("--users", "users_file", type=file, metavar="FILE",
                        help="Who may log in; ~/.config/trochia/users.json unless given.")(command)  # fmt: skip


@click.command()
@options.machine
@mover_options("twin", "avr", "simavr")
@click.option("--tcp", type=click.IntRange(0, 65535), default=8765, show_default=True, metavar="PORT",
              help="Port of the page and the interface; 0: any that is free.")  # fmt: skip
@click.option("--host", default="127.0.0.1", show_default=True, metavar="ADDRESS",
              help="Where to listen; beyond this computer only together with --allow.")  # fmt: skip
@click.option("--allow", multiple=True, metavar="NAME",
              help="A name or address by which browsers may reach the server (again for more).")  # fmt: skip
@click.option("--certificate", type=file, metavar="PEM", help="Speak TLS with this certificate.")
@click.option("--key", type=file, metavar="PEM", help="The certificate's private key.")
@users_option
@click.option("--journal", type=click.Path(file_okay=False, path_type=Path), metavar="DIR",
              help="Folder of the machine's journal, in it the log of who asked for what, and offsets and variables "
                   "over a restart; without it nothing is kept.")  # fmt: skip
@click.option("--recordings", type=click.Path(file_okay=False, path_type=Path), metavar="DIR",
              help="Folder of the recordings that clients start; without it they cannot.")  # fmt: skip
@click.option("--logs", type=click.Path(file_okay=False, path_type=Path), metavar="DIR",
              help="Folder of the logs that programs write (LOGOPEN, LOG); without it none are kept.")  # fmt: skip
def command(
    *, machine_name: str, backend: str, port: str | None, baud: int | None, board: str | None, tcp: int, host: str,
    allow: tuple[str, ...], certificate: Path | None, key: Path | None, users_file: Path | None,
    journal: Path | None, recordings: Path | None, logs: Path | None,
) -> None:  # fmt: skip
    """Serve a machine: a page with its state and STOP, an HTTP and WebSocket interface, a Python client.

    The first start makes a user `operator` and shows the password once; `trochia users` makes more.
    Ctrl-C brakes what moves and switches the drives off.  Nothing moves when a board is connected to.

    Example: trochia serve -m xy-table --journal journal

    Example: trochia serve -m mill.toml --backend avr --port /dev/ttyACM0
    """
    if port is not None and port.isdecimal():
        raise click.UsageError(f"--port names a board's serial port; the page's is --tcp {port}")
    check(backend, port)
    if host not in LOOPBACK and not allow:
        raise click.UsageError(f"--host {host} opens the machine to the network: name by --allow what browsers may "
                               "call it, like --allow mill.local")  # fmt: skip
    if (certificate is None) != (key is None):
        raise click.UsageError("--certificate and --key go together")
    from trochia.machine.load import load  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.server.desk import Desk  # noqa: PLC0415
    from trochia.server.doors import Doors  # noqa: PLC0415
    from trochia.server.listen import Served, listen  # noqa: PLC0415
    from trochia.server.users import Users  # noqa: PLC0415

    if logs is not None:
        logs.mkdir(parents=True, exist_ok=True)
    users = Users(users_file or settings_folder() / "users.json")
    machine = load(machine_name)
    moves = mover(machine, backend, port=port, baud=baud, board=board)
    password = users.first()
    if password is not None:
        click.echo(f"user operator, password {password}\nshown this once; kept in {users.path} as a key only")
    socket = listen(host, tcp)
    doors = Doors.of(int(socket.getsockname()[1]), allow, secure=certificate is not None)
    clock = clock_of(backend)
    runtime, end_codes = _runtime(moves, machine_name, journal, recordings, logs, now=clock())
    desk = Desk(runtime, users, doors, log=None if journal is None else journal / "access")
    tls = (certificate, key) if certificate is not None and key is not None else None
    try:
        _serve(runtime, desk, Served(desk, socket, tls), _address(doors, host), clock)
    finally:
        end_codes()


def _runtime(
    moves: SegmentBackend, name: str, journal: Path | None, recordings: Path | None, logs: Path | None, *, now: float
) -> tuple[Runtime, Callable[[], None]]:
    """Return what runs the machine, and what ends the programs of its codes."""
    from trochia.cli.setup import of_machine  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.cli.user_codes import attach  # noqa: PLC0415
    from trochia.controller.offsets import NAME  # noqa: PLC0415
    from trochia.controller.runtime import Runtime  # noqa: PLC0415

    reading = of_machine(name)
    runtime = Runtime(moves, journal=journal, recordings=recordings, work=reading.work, reading=reading,
                      logs=logs, keep=None if journal is None else journal / NAME, now=now)  # fmt: skip
    return runtime, attach(runtime, moves.machine, name)


def _address(doors: Doors, host: str) -> str:
    """Return the address to tell people: the first name that was allowed, or where we listen."""
    scheme = "https" if doors.secure else "http"
    named = [
        o for o in sorted(doors.origins) if not any(f"//{name}" in o for name in ("127.0.0.1", "localhost", "[::1]"))
    ]
    near = [o for o in sorted(doors.origins) if o.startswith(f"{scheme}://{f'[{host}]' if ':' in host else host}")]
    return [*near, *named, *sorted(doors.origins)][0]


def _serve(runtime: Runtime, desk: Desk, served: Served, address: str, clock: Callable[[], float]) -> None:
    """Serve until told to stop, then bring the machine to rest."""
    from trochia.server.rest import bring_to_rest  # noqa: PLC0415

    def terminated(_signal: int, _frame: object) -> None:
        raise KeyboardInterrupt

    signal.signal(signal.SIGTERM, terminated)
    sys.setswitchinterval(0.001)  # else whoever computes keeps the controller waiting for 5 ms, a whole turn
    runtime.start(clock)
    click.echo(f"{runtime.backend.machine.name} ({runtime.backend.title}) at {address} (Ctrl-C ends)")
    try:
        served.run()
    except KeyboardInterrupt:
        click.echo("stopping")
    finally:
        rested = bring_to_rest(runtime)
        served.close()
        desk.close()
        runtime.close()
        click.echo("at rest, drives off" if rested else "the machine did not come to rest in time; drives off")
