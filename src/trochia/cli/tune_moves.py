"""``trochia tune --move``: a step or a parabolic move of a servo joint under the loop of its file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from trochia import units
from trochia.cli import axis_options, options
from trochia.errors import UnitError

if TYPE_CHECKING:
    from trochia.analysis.tuning.trial import Trial

_PART_OF_TRAVEL = {"step": 0.002, "parabolic": 0.05}  # of a move whose size nobody gave
_SPEED = 0.6  # of the joint's, which a move whose time nobody gave reaches
_TO_SPEED = 1.5  # peak over mean of a parabola


def move(asked: axis_options.AskedAxis, kind: str, given: dict[str, str | None], plot: str | None, *,
         as_json: bool) -> None:  # fmt: skip
    """Run a move on the twin, and tell what it was like."""
    from trochia.analysis.tuning.trial import LISTEN, parabola_of, step_of, trial  # noqa: PLC0415 - light --help

    drive, scale = asked.drive, asked.drive.per_radian
    low, high = asked.bounds.low * scale, asked.bounds.high * scale
    size = _quantity(given["size"], "angle" if asked.rotary else "length", "--size")
    size = size if size is not None else _PART_OF_TRAVEL[kind] * (high - low)
    seconds = _quantity(given["time"], "time", "--time") or _TO_SPEED * abs(size) / (_SPEED * asked.speed * scale)
    start, rest = 0.5 * (low + high), round(LISTEN / drive.period)
    wanted = (step_of(start, size, max(2 * rest, 8)) if kind == "step"
              else parabola_of(start, size, seconds, drive.period, rest))  # fmt: skip
    seen = trial(drive, kind, wanted, start=start, travel=(low, high), speed=asked.bounds.speed * scale)
    files: list[str] = []
    if plot is not None:
        title = f"joint {asked.name}: {'step' if kind == 'step' else 'parabolic move'} of {size:.4g} {asked.unit}"
        axis_options.write_plot(
            plot, title, lambda form: _picture(seen, title, asked.unit, form), _rows(seen, asked.unit)
        )
        files = [plot]
    if as_json:
        options.print_json({
            "model": None, "uncertainty": None, "gains": None, "margins": seen.margins.figures(),
            "metrics": seen.figures(), "move": {"kind": kind, "size": size, "unit": asked.unit, "time_s": seconds},
            "suggested": seen.suggested, "files": files,
        })  # fmt: skip
        return
    for name, value in _rows(seen, asked.unit):
        click.echo(f"  {name:<28} {value}")
    for file in files:
        click.echo(f"wrote {file}")


def _quantity(text: str | None, dimension: str, option: str) -> float | None:
    if text is None:
        return None
    try:
        value = units.parse(text, dimension)
    except UnitError as error:
        raise click.BadParameter(str(error), param_hint=option) from None
    if option == "--time" and not value > 0.0:
        raise click.BadParameter(f"must be above zero, not {text}", param_hint=option)
    if value == 0.0:
        raise click.BadParameter("must not be zero", param_hint=option)
    return value


def _rows(seen: Trial, unit: str) -> list[tuple[str, str]]:
    """Return what is told of a move, name and value."""
    margins = seen.margins
    rows = [("gain margin, phase margin, Ms", f"{margins.gm:.3g}, {margins.pm_deg:.1f}°, {margins.ms:.3f}")]
    if seen.step is not None:
        rise, settling = (_milliseconds(v) for v in (seen.step.rise, seen.step.settling))
        left = f"{seen.step.error:.2%}"
        rows += [("rise, 10 to 90 %", rise), ("settled within 2 %", settling),
                 ("overshoot", f"{seen.step.overshoot:.1%}"), ("left at the end", left)]  # fmt: skip
    if seen.following is not None:
        error = seen.following
        rows += [
            ("following error", f"{error.peak:.4g} {unit} at most, {error.rms:.4g} {unit} rms"),
            ("goes with speed", f"{error.speed_part * 1e3:+.4g} ms"),
            ("goes with acceleration", f"{error.acceleration_part * 1e6:+.4g} ms²"),
            ("goes with the way", f"{error.friction_part:+.4g} {unit}"),
        ]
    if seen.limited > 0.0:
        rows.append(("current at its limit for", _milliseconds(seen.limited)))
    rows += [(f"suggested {name}", f"{value:g}") for name, value in seen.suggested.items()]
    return rows


def _milliseconds(seconds: float) -> str:
    return f"{seconds * 1e3:.3g} ms" if seconds < float("inf") else "not in this time"


def _picture(seen: Trial, title: str, unit: str, form: str) -> bytes:
    from trochia.analysis.tuning.picture import trial_picture  # noqa: PLC0415 - it loads matplotlib

    return trial_picture(seen, title, unit, form=form)


def move_options(command: Any) -> Any:  # noqa: ANN401 - click's
    """Add the options of a move."""
    for option in (
        click.option("--time", metavar="TIME", help="Of a parabolic move, each way; else by the joint's speed."),
        click.option("--size", metavar="LENGTH", help="Of the move, like '1 mm'; else by the joint's travel."),
        click.option("--move", "move_kind", type=click.Choice(("step", "parabolic")),
                     help="Tune nothing: run this move under the loop that the joint has, and tell its figures."),
    ):  # fmt: skip
        command = option(command)
    return command
