"""``trochia profile``: a stepper's move step by step; laws compared, a requirement judged, the motor asked."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from trochia.cli import options
from trochia.cli.profile_asked import profile_options, wanted
from trochia.files import write_whole


@click.command()
@profile_options
def command(*, csv_file: str | None, plot: str | None, as_json: bool, **given: Any) -> None:  # noqa: ANN401 - click's
    """Tabulate a stepper's velocity profile, step by step, and say whether it will do.

    With a motor, its driver and its load (--motor, or -m for one of a machine): whether it starts and follows, how much
    torque is left where it is tightest, from which step on it would lose steps, at which speed it stalls.

    Exit code 1 where it does not meet what is required, or the motor cannot do it.

    Example: trochia profile --steps 400 --speed "200 rpm" --acceleration "100 rad/s2" --require "0.7 s"

    Example: trochia profile --motor QSH5718-41 --supply "24 V" --current "2.8 A" --travel-per-turn "5 mm"
    --mass "5 kg" --move "100 mm" --speed "50 mm/s" --acceleration "1000 mm/s2"
    """
    from trochia.cli.profile_found import find  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.cli.profile_told import csv_text, json_of, show  # noqa: PLC0415
    from trochia.cli.progress import Progress  # noqa: PLC0415

    for option, file in (("--csv", csv_file), ("--plot", plot)):
        if file is not None and not Path(file).parent.is_dir():
            raise click.BadParameter(f"there is no folder {Path(file).parent}", param_hint=option)
    if plot is not None and Path(plot).suffix not in {".png", ".svg"}:
        raise click.BadParameter(f"expected a name that ends in .png or .svg, not {plot}", param_hint="--plot")
    asked = wanted(given)
    with Progress() as progress:
        found = find(asked, progress)
    if csv_file is not None:
        write_whole(Path(csv_file), csv_text(found[0]).encode())
    if plot is not None:
        from trochia.analysis.stepper_picture import picture  # noqa: PLC0415 - it loads matplotlib

        uses = None if found[0].use is None else [(one.use, one.proof) for one in found if one.use is not None]
        title = None if asked.motor is None else asked.motor.title
        drawn = picture([one.profile for one in found], asked.requirement, uses, title=title,
                        form=Path(plot).suffix[1:])  # fmt: skip
        write_whole(Path(plot), drawn)
    files = [file for file in (csv_file, plot) if file is not None]
    if as_json:
        first, *others = (json_of(one, asked.motor, asked.chip_clock) for one in found)
        options.print_json({**first, "others": others, "files": files})
    else:
        for one in found:
            show(one, asked.motor, asked.chip_clock, asked.speed)
        for file in files:
            click.echo(f"wrote {file}")
    if not all(one.ok for one in found):
        raise SystemExit(1)
