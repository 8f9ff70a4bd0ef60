"""``trochia interpolate``: the classic interpolators on a line or an arc, compared."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from trochia.cli import options
from trochia.cli.tables import table
from trochia.files import write_whole

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.pulses.interpolators import Figure, Interpolator
    from trochia.pulses.interpolators.compare import Merit

LARGEST = 100_000  #: coordinates and radii [steps]: most of a million ticks a method, a second in all
_SHORT = 64  # ticks: a figure no longer than this has its pulses printed

_method = click.option("--method", "name", default=None, metavar="NAME",
                       help="One of dda, bresenham, point, difference, octant (without it dda).")  # fmt: skip
_compare = click.option("--compare", is_flag=True, help="All methods in one table.")
_plot = click.option("--plot", type=click.Path(dir_okay=False, writable=True), metavar="FILE.png",
                     help="Draw curve, steps, deviation and pulses.")  # fmt: skip


def _common(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options both figures have."""
    for decorate in (options.as_json, _plot, _compare, _method):
        command = decorate(command)
    return command


@click.group()
def command() -> None:
    """Turn a line or an arc in whole steps into pulses, and compare the methods.

    Example: trochia interpolate arc 100 --compare --plot circle.png
    """


@command.command(context_settings={"ignore_unknown_options": True})
@click.argument("x", type=click.IntRange(-LARGEST, LARGEST))
@click.argument("y", type=click.IntRange(-LARGEST, LARGEST))
@_common
def line(  # noqa: PLR0917 - click hands options over by name
    x: int, y: int, name: str | None, compare: bool, plot: str | None, as_json: bool
) -> None:
    """Line from (0, 0) to (X, Y).

    Example: trochia interpolate line 5 3
    """
    from trochia.pulses.interpolators import Line  # noqa: PLC0415 - `trochia --help` must stay light

    if x == y == 0:
        raise click.BadParameter("a line from (0, 0) to (0, 0) has no step to make", param_hint="X Y")
    given = {"kind": "line", "x_steps": x, "y_steps": y}
    _report(Line(x=x, y=y), given, f"Line to ({x}, {y})", name, compare=compare, plot=plot, as_json=as_json)


@command.command()
@click.argument("radius", type=click.IntRange(1, LARGEST))
@click.option("--from", "begin", type=float, default=0.0, show_default=True, metavar="DEG", help="Where it starts.")
@click.option("--to", "end", type=float, default=360.0, show_default=True, metavar="DEG", help="Where it ends.")
@click.option("--cw", "clockwise", is_flag=True, help="Clockwise, as G2; without it counter-clockwise, as G3.")
@_common
def arc(  # noqa: PLR0917 - click hands options over by name
    radius: int,
    begin: float,
    end: float,
    clockwise: bool,
    name: str | None,
    compare: bool,
    plot: str | None,
    as_json: bool,
) -> None:
    """Arc of RADIUS about (0, 0); where both ends are one point, a whole turn.

    Example: trochia interpolate arc 100 --from 30 --to 150 --compare
    """
    from trochia.pulses.interpolators import Arc  # noqa: PLC0415 - `trochia --help` must stay light

    start, stop = _on_grid(radius, begin), _on_grid(radius, end)
    sweep = ((begin - end) if clockwise else (end - begin)) % 360.0
    if start == stop and 0.0 < sweep < 180.0:
        raise click.BadParameter(f"the arc from {begin:g} to {end:g} degrees is shorter than a step of radius {radius}",
                                 param_hint="--from --to")  # fmt: skip
    given = {"kind": "arc", "radius_steps": radius, "start_steps": start, "end_steps": stop, "clockwise": clockwise}
    way = "clockwise" if clockwise else "counter-clockwise"
    title = f"Arc of radius {radius} from {start} to {stop}, {way}"
    figure = Arc(start=start, end=stop, radius_squared=radius * radius, clockwise=clockwise)
    _report(figure, given, title, name, compare=compare, plot=plot, as_json=as_json)


def _on_grid(radius: int, degrees: float) -> tuple[int, int]:
    """Return the grid's nearest point on the circle."""
    if not math.isfinite(degrees):
        raise click.BadParameter(f"an angle is a number of degrees, not {degrees}", param_hint="--from --to")
    angle = math.radians(degrees % 360.0)
    return round(radius * math.cos(angle)), round(radius * math.sin(angle))


def _chosen(name: str | None, *, compare: bool) -> list[Interpolator]:
    """Return the methods asked for."""
    from trochia.pulses.interpolators import INTERPOLATORS  # noqa: PLC0415 - `trochia --help` must stay light

    if name is not None and name not in INTERPOLATORS:
        raise click.BadParameter(f"there is no method {name!r}; there are {', '.join(INTERPOLATORS)}",
                                 param_hint="--method")  # fmt: skip
    if compare and name is not None:
        raise click.UsageError("--compare takes all methods: give it or --method, not both")
    return list(INTERPOLATORS.values()) if compare else [INTERPOLATORS[name or "dda"]]


def _report(
    figure: Figure,
    given: dict[str, Any],
    title: str,
    name: str | None,
    *,
    compare: bool,
    plot: str | None,
    as_json: bool,
) -> None:
    """Print, and draw, what the methods make of a figure."""
    from trochia.pulses.interpolators.compare import merit  # noqa: PLC0415 - `trochia --help` must stay light

    methods = _chosen(name, compare=compare)
    if plot is not None and not Path(plot).parent.is_dir():
        raise click.BadParameter(f"there is no folder {Path(plot).parent}", param_hint="--plot")
    merits = [merit(method, figure) for method in methods]
    if plot is not None:
        _draw(Path(plot), figure, methods, title)
    if as_json:
        options.print_json(
            {"figure": given, "methods": [_row(merit) for merit in merits], "files": [plot] * bool(plot)}
        )
        return
    click.secho(title, bold=True)
    click.echo(table(_rows(merits)))
    if not compare and merits[0].ticks <= _SHORT:
        for axis, bit in (("X", 4), ("Y", 8)):
            ticks = [str(tick + 1) for tick, pulse in enumerate(methods[0].pulses(figure)) if pulse & bit]
            click.echo(f"  {axis} steps at ticks {' '.join(ticks) or '(none)'}")
    if plot is not None:
        click.echo(f"wrote {plot}")


def _draw(path: Path, figure: Figure, methods: list[Interpolator], title: str) -> None:
    """Write the picture, whole or not at all."""
    from trochia.pulses.interpolators.picture import picture  # noqa: PLC0415 - it loads matplotlib

    write_whole(path, picture(figure, methods, title))


def _row(merit: Merit) -> dict[str, Any]:
    """Return a method's merits by JSON's keys."""
    return {
        "name": merit.name,
        "ticks": merit.ticks,
        "steps": {"X": merit.steps_x, "Y": merit.steps_y},
        "end_steps": merit.end,
        "deviation_max_steps": merit.deviation_max,
        "deviation_rms_steps": merit.deviation_rms,
        "jitter_max": merit.jitter_max,
        "jitter_rms": merit.jitter_rms,
        "time_per_step_ns": merit.ns_per_step,
        "operations_per_step": merit.operations,
    }


def _rows(merits: list[Merit]) -> list[list[str]]:
    """Return the table: a head of two lines, then a row a method."""
    head = [
        ["", "", "steps", "", "deviation", "[steps]", "jitter", "[%]", "cost a", "step", "", ""],
        ["method", "ticks", "X", "Y", "max", "RMS", "max", "RMS", "ns", "simple", "products", "quotients"],
    ]
    return head + [
        [
            merit.title, str(merit.ticks), str(merit.steps_x), str(merit.steps_y),
            f"{merit.deviation_max:.3f}", f"{merit.deviation_rms:.3f}",
            f"{100 * merit.jitter_max:.1f}", f"{100 * merit.jitter_rms:.1f}", f"{merit.ns_per_step:.1f}",
            *(f"{merit.operations[kind]:.2f}" for kind in ("simple", "products", "quotients")),
        ]
        for merit in merits
    ]  # fmt: skip
