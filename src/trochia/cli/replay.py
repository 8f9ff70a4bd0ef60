"""`trochia replay`: look at a recording, or hold it against another."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from trochia import units
from trochia.cli.options import as_json, print_json
from trochia.cli.tables import clock, table
from trochia.errors import UnitError

if TYPE_CHECKING:
    from trochia.analysis.replay import Held, Look
    from trochia.recorder import Recording

_TEN = 1e4


def _tolerance(_context: click.Context, _parameter: click.Parameter, value: str | None) -> float | None:
    """Return a length from a text like ``10 um`` [mm]."""
    if value is None:
        return None
    try:
        length = units.parse(value, "length")
    except UnitError as error:
        raise click.BadParameter(str(error)) from None
    if length < 0:
        raise click.BadParameter("a tolerance is zero or more")
    return length


folder = click.Path(path_type=Path)


@click.command()
@click.argument("recording", metavar="FOLDER", type=folder)
@click.argument("other", metavar="[OTHER]", required=False, type=folder)
@click.option("--align", type=click.Choice(["motion", "start", "time"]), default="motion", show_default=True,
              help="From where two are held against each other: where each job begins to move, the first sample, or "
                   "the times as they stand.")  # fmt: skip
@click.option("--tolerance", callback=_tolerance, metavar="LENGTH",
              help='Fail (exit code 1) where OTHER leaves the way of FOLDER by more, like "10 um".')  # fmt: skip
@click.option("--csv", type=click.Path(dir_okay=False, path_type=Path), metavar="FILE",
              help="Write the samples as CSV; of two, those of OTHER.")  # fmt: skip
@click.option("--contouring", is_flag=True,
              help="Of one: how well it was followed: spikes, spectra, repeatability, resolution, circle.")  # fmt: skip
@click.option("-o", "--plot", type=click.Path(dir_okay=False), metavar="FILE.png|FILE.svg|FILE.html",
              help="Draw it over time; of two, how far they are apart; with --contouring what that tells.")  # fmt: skip
@click.option("--verify", is_flag=True, help="Read every sample and hold it against the checksum.")
@as_json
def command(
    *, recording: Path, other: Path | None, align: str, tolerance: float | None, csv: Path | None,
    contouring: bool, plot: str | None, verify: bool, as_json: bool,
) -> None:  # fmt: skip
    """Look at a recording; with OTHER, tell how far that is from it: channel by channel, when, at which line.

    FOLDER is what `trochia simulate` (OUTPUT/recording) or `trochia run --record` wrote; one that was cut short is read
    to its last whole sample.  `path` is the distance from the way of FOLDER, whenever it was gone: holds and overrides
    do not matter to it.

    With --contouring one recording tells how well it was followed: what a machine did, or its twin before it runs.

    Example: trochia replay out/recording run --tolerance "10 um"
    """
    if tolerance is not None and other is None:
        raise click.UsageError("--tolerance holds OTHER against FOLDER: give both")
    if contouring and other is not None:
        raise click.UsageError("--contouring is of one recording")
    from trochia.recorder import read, to_csv  # noqa: PLC0415 - `trochia --help` must stay light

    one = read(recording, verify=verify)
    second = None if other is None else read(other, verify=verify)
    if csv is not None:
        to_csv(second or one, csv)
    if contouring:
        _study(one, plot, as_json=as_json)
        return
    if second is None:
        _single(one, plot, as_json=as_json)
        return
    good = _both(one, second, align, tolerance, plot, as_json=as_json)
    sys.exit(0 if good else 1)


def _draw(plot: str, one: Recording, other: Recording | None, rows: list[tuple[str, str]]) -> None:
    """Draw a recording, or how far another is from it."""
    from trochia.analysis.replay.picture import picture  # noqa: PLC0415
    from trochia.cli.axis_options import write_plot  # noqa: PLC0415

    what = f"{one.machine}, {Path(one.program).name or 'unnamed'}"
    title = what if other is None else f"{what}: what the second does otherwise than the first"
    write_plot(plot, title, lambda form: picture(one, other, form=form), rows)


def _single(one: Recording, plot: str | None, *, as_json: bool) -> None:
    """Show one recording."""
    from trochia.analysis.replay import look  # noqa: PLC0415

    seen = look(one)
    if plot is not None:
        _draw(plot, one, None, [(c["name"], f"{_number(c['least'])} to {_number(c['greatest'])} {c['unit']}")
                                for c in seen.channels if c["name"] != "state"])  # fmt: skip
    print_json(seen.figures()) if as_json else _show(seen)


def _study(one: Recording, plot: str | None, *, as_json: bool) -> None:
    """Tell how well one recording was followed."""
    from trochia.analysis.contouring import study  # noqa: PLC0415
    from trochia.analysis.contouring.page import study_picture, study_rows  # noqa: PLC0415
    from trochia.cli.axis_options import write_plot  # noqa: PLC0415

    found = study(one)
    rows = study_rows(found)
    if plot is not None:
        title = f"{one.machine}, {Path(one.program).name or 'unnamed'}: how well it was followed"
        write_plot(plot, title, lambda form: study_picture(one, found, title, form=form), rows)
    if as_json:
        print_json(found.figures() | {"files": [] if plot is None else [plot]})
        return
    for name, value in rows:
        click.echo(f"  {name:<22} {value}")
    if plot is not None:
        click.echo(f"wrote {plot}")


def _show(seen: Look) -> None:
    about = seen.about
    cut = "" if about["complete"] else ", cut short"
    click.echo(f"{about['machine']}{', ' + about['program'] if about['program'] else ''} ({about['origin']})")
    click.echo(f"{about['samples']} samples every {1000 * about['period_s']:g} ms, {clock(about['duration_s'])} from "
               f"{about['start_s']:.3f} s{cut}")  # fmt: skip
    rows = [["channel", "unit", "least", "greatest", "rms", "greatest at", "line"]]
    rows += [[c["name"], c["unit"], _number(c["least"]), _number(c["greatest"]), _number(c["rms"]),
              f"{c['time_s']:.3f} s", "-" if c["line"] is None else str(c["line"])]
             for c in seen.channels if c["name"] != "state"]  # fmt: skip
    click.echo(table(rows, left=(0, 1)))
    if seen.states:
        shown = [f"{name} {time:.3f} s" for time, name in seen.states]
        click.echo("states   " + ", ".join(shown[:12]) + (f" and {len(shown) - 12} more" if len(shown) > 12 else ""))


def _both(
    one: Recording, second: Recording, align: str, tolerance: float | None, plot: str | None, *, as_json: bool
) -> bool:
    """Hold one against the other; return whether it is within the tolerance."""
    from trochia.analysis.replay import aligned, hold_against  # noqa: PLC0415

    pair = aligned(one, second, by=align)
    held = hold_against(pair, (one, second))
    beyond = [] if tolerance is None else held.beyond(tolerance)
    if plot is not None:
        _draw(plot, pair.a, pair.b, [(name, f"{_number(each.peak)} {each.unit} at most, {_number(each.rms)} rms")
                                     for name, each in held.deviations.items()])  # fmt: skip
    if as_json:
        print_json({
            "ok": not beyond, "seconds": held.seconds, "began_s": held.began, "missing": held.missing,
            "programs": [one.program, second.program], "beyond": beyond, "tolerance_mm": tolerance,
            "deviations": {name: each.figures() for name, each in held.deviations.items()},
        })  # fmt: skip
        return not beyond
    if Path(one.program).name != Path(second.program).name:
        click.echo(f"warning: two programs: {one.program or 'unnamed'} and {second.program or 'unnamed'}", err=True)
    _tell(held)
    if tolerance is not None:
        click.echo(f"beyond {1000 * tolerance:g} µm: {', '.join(beyond)}" if beyond
                   else f"within {1000 * tolerance:g} µm")  # fmt: skip
    return not beyond


def _tell(held: Held) -> None:
    click.echo(f"{clock(held.seconds)} held against each other, from {held.began[0]:.3f} s of the first and "
               f"{held.began[1]:.3f} s of the second")  # fmt: skip
    rows = [["channel", "unit", "greatest", "rms", "at", "line"]]
    rows += [[name, each.unit, _number(each.peak), _number(each.rms), f"{each.time:.3f} s",
              "-" if each.line is None else str(each.line)] for name, each in held.deviations.items()]  # fmt: skip
    click.echo(table(rows, left=(0, 1)))
    if held.missing:
        click.echo(f"in one only: {', '.join(held.missing)}")


def _number(value: float) -> str:
    """Return a number for a column: six places where it is no great number."""
    return f"{value:.6f}" if abs(value) < _TEN else f"{value:.1f}"
