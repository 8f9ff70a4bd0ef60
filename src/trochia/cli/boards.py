"""`trochia boards`: what is on the serial ports."""

from __future__ import annotations

import click

from trochia.cli import options


@click.command()
@click.argument("devices", metavar="[DEVICE]...", nargs=-1)
@options.as_json
def command(*, devices: tuple[str, ...], as_json: bool) -> None:
    """Find serial ports and say what is on them: a board with Trochia's image, one with GRBL, nothing.

    Takes three seconds or so.  Opening a port resets most boards; nothing begins to move, but what a board was doing
    for nobody ends.  Ports that another program has open are left alone.

    Example: trochia boards
    """
    from concurrent.futures import ThreadPoolExecutor  # noqa: PLC0415 - `trochia --help` must stay light

    from trochia.backends.avr import ports  # noqa: PLC0415

    known = ports.names()
    asked = list(devices) or list(known)
    with ThreadPoolExecutor(max_workers=max(len(asked), 1)) as pool:
        found = list(pool.map(ports.look, asked))
    if as_json:
        options.print_json({"boards": [
            {"port": one.port, "kind": one.kind, "text": one.text, "board": one.board, "baud": one.baud,
             "schema": None if one.schema is None else f"{one.schema:08x}", "plug": known.get(one.port)}
            for one in found
        ]})  # fmt: skip
        return
    if not found:
        click.echo("no serial port is there; is the cable in?")
    width = max((len(one.port) for one in found), default=0)
    for one in found:
        plug = known.get(one.port)
        click.echo(f"{one.port:{width}}  {one.text}{f'  ({plug})' if plug else ''}")
