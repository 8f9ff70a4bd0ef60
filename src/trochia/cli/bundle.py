"""`trochia bundle`: what somebody who was not there needs to see what happened, in one file."""

from __future__ import annotations

from pathlib import Path

import click

from trochia.cli.options import as_json, print_json
from trochia.cli.tables import table

folder = click.Path(file_okay=False, path_type=Path)


@click.command()
@click.option("-m", "--machine", "machine_name", metavar="MACHINE", help="Pack this machine file.")
@click.option("--journal", type=folder, metavar="DIR", help="Pack the last entries of this journal.")
@click.option("--recordings", type=folder, metavar="DIR",
              help="Pack the newest recording in this folder, or the recording itself.")  # fmt: skip
@click.option("--entries", type=click.IntRange(min=1), default=5000, show_default=True,
              help="How many entries of the journal.")  # fmt: skip
@click.option("--room", type=click.FloatRange(min=0), default=64.0, show_default=True, metavar="MB",
              help="What the recording may take at most; of its parts the newest that fit.")  # fmt: skip
@click.option("--with-program", is_flag=True, help="Pack the text of the journal's last job too.")
@click.option("-o", "--output", type=click.Path(dir_okay=False, path_type=Path), required=True, metavar="FILE.zip",
              help="The file to be made.")  # fmt: skip
@click.option("--force", is_flag=True, help="Write over a file that exists.")
@as_json
def command(
    *, machine_name: str | None, journal: Path | None, recordings: Path | None, entries: int, room: float,
    with_program: bool, output: Path, force: bool, as_json: bool,
) -> None:  # fmt: skip
    """Pack versions, machine file, the journal's end and the last recording, to be sent to who can help.

    Nothing is sent.  Users, keys, passwords and the log of who asked for what are never packed; what was, is told.

    Example: trochia bundle -m mill.toml --journal journal --recordings recordings -o bundle.zip
    """
    if output.exists() and not force:
        raise click.UsageError(f"{output} exists already: write over it with --force, or choose another name")
    from trochia.controller.bundle import Bundle, newest  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.machine.load import text_of  # noqa: PLC0415

    bundle = Bundle()
    if machine_name is not None:
        file, text = text_of(machine_name)
        bundle.machine(text, file)
    if journal is not None:
        bundle.journal(journal, count=entries, program=with_program)
    if recordings is not None:
        last = newest(recordings)
        if last is None:
            bundle.left_out.append(f"a recording: there is none in {recordings.name}")
        else:
            bundle.recording(last, room=round(room * 1e6))
    bundle.write(output)
    if as_json:
        packed = [{"name": name, "bytes": size, "what": what} for name, size, what in bundle.packed]
        print_json({"file": str(output), "left_out": bundle.left_out, "packed": packed})
        return
    click.echo(table([[name, f"{size:,} bytes", what] for name, size, what in bundle.packed], left=(0, 2)))
    for what in bundle.left_out:
        click.echo(f"not packed: {what}")
    click.echo(f"{output}: {output.stat().st_size:,} bytes; look into it before you send it")
