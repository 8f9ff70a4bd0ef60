"""`trochia machine channels`: what a live run on a machine can record."""

from __future__ import annotations

import click

from trochia.cli.options import as_json, print_json


@click.command()
@click.argument("name", metavar="MACHINE")
@as_json
def command(name: str, as_json: bool) -> None:
    """List the channels that `trochia run --record` can keep, with units and meanings.

    Example: trochia machine channels xy-table
    """
    from trochia.backends.live_signals import LiveSignals  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.machine.load import load  # noqa: PLC0415

    signals = LiveSignals(load(name))
    rows = [{"name": c.name, "unit": c.unit, "dtype": c.dtype, "meaning": signals.meanings[c.name]}
            for c in signals.channels]  # fmt: skip
    if as_json:
        print_json({"channels": rows})
        return
    width = max(len(row["name"]) for row in rows)
    for row in rows:
        click.echo(f"{row['name']:{width}}  {row['unit']:8}  {row['meaning']}")
