"""`trochia flash`: write Trochia's image to a board."""

from __future__ import annotations

import shlex
from pathlib import Path

import click

BOOTLOADER = 115_200


@click.command()
@click.argument("board", metavar="BOARD")
@click.option("--port", metavar="DEVICE", help="Serial port of the board; needed where there are several.")
@click.option("--image", "file", type=click.Path(exists=True, dir_okay=False, path_type=Path), metavar="FILE",
              help="Another image (Intel HEX) than the one that comes with Trochia.")  # fmt: skip
@click.option("--baud", type=click.Choice(["115200", "1000000"]), default="115200", show_default=True,
              help="At which rate the image talks; the higher one for laser pictures.")  # fmt: skip
@click.option("--bootloader", type=click.IntRange(min=1200), default=BOOTLOADER, show_default=True,
              help="Baud rate of the board's bootloader; 57600 for old ones.")  # fmt: skip
@click.option("--dry-run", is_flag=True, help="Say what would be done, and touch nothing.")
@click.option("-y", "--yes", is_flag=True, help="Do not ask.")
def command(
    *, board: str, port: str | None, file: Path | None, baud: str, bootloader: int, dry_run: bool, yes: bool
) -> None:
    """Write Trochia's image to a BOARD: uno-stepdir, mega-stepdir, uno-l293d.

    What the board held before is overwritten.  Nothing moves: an image stands still with its drives off until a
    program connects.

    Example: trochia flash uno-stepdir --port /dev/ttyACM0
    """
    from trochia.backends.avr import flash, images, ports  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.backends.avr.wiring import BOARDS  # noqa: PLC0415

    if board not in BOARDS:
        raise click.UsageError(f"no board is called {board!r}; there are {images.boards()}")
    kind = BOARDS[board]
    image = images.shipped(board, int(baud)) if file is None else images.Image(path=file)
    known = "" if image.schema is None else f", schema {image.schema:08x}, {image.baud} baud"
    there = [port] if port else list(ports.names())
    if len(there) != 1 and not dry_run:
        listed = f"there are {', '.join(there)}" if there else "none is there; is the cable in?"
        raise click.UsageError(f"say which port: --port DEVICE ({listed})")
    device = there[0] if len(there) == 1 else "DEVICE"
    click.echo(f"{image.path.name}: {image.size:,} bytes for {board} ({kind.mcu}){known}")
    line = shlex.join(flash.command(kind, image, device, bootloader=bootloader))
    if dry_run:
        click.echo(f"would run: {line}")
        return
    if not yes:
        click.confirm(f"write it to the board on {device}?", abort=True, err=True)
    ports.opened(device, bootloader).close()  # in use, not there, not ours: known before anything is written
    click.echo("writing and reading back: half a minute, or up to a minute where no bootloader answers")
    flash.write(kind, image, device, bootloader=bootloader)
    click.echo(f"{device} holds {board} now")
