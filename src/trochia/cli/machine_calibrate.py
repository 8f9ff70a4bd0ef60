"""`trochia machine calibrate`: from measured points to what a machine file corrects."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from trochia import units
from trochia.cli.options import as_json, print_json
from trochia.cli.tables import table
from trochia.errors import ConfigError, UnitError

if TYPE_CHECKING:
    from trochia.analysis.calibration import Found
    from trochia.machine.machine import Machine

PAIRS = ("XY", "XZ", "YZ")
PARTS = ("screw", "backlash", "scale")


def _length(text: str, *, rotary: bool = False) -> float:
    """Return a length (an angle where rotary) from a text with its unit."""
    try:
        return units.parse(text, "angle" if rotary else "length")
    except UnitError as error:
        raise click.BadParameter(str(error)) from None


def _two(text: str | None, option: str) -> tuple[float, float]:
    """Return two lengths from ``100 mm, 80 mm``, or the same twice from one."""
    if text is None:
        raise click.UsageError(f"{option} is missing")
    parts = [_length(part.strip()) for part in text.split(",")]
    if len(parts) > 2:
        raise click.UsageError(f'{option} takes one or two lengths, like "100 mm, 80 mm", not {text!r}')
    return parts[0], parts[-1]


@click.command()
@click.argument("name", metavar="MACHINE")
@click.option("--axis", metavar="LETTER", help="Whose points are measured.")
@click.option("--points", type=click.Path(exists=True, dir_okay=False, path_type=Path), metavar="FILE.csv",
              help="Columns commanded, measured, direction (+ or -) if known; mm, or a unit in the title.")  # fmt: skip
@click.option("--asked", metavar="LENGTH", help="One way that was asked for (with --measured): the scale only.")
@click.option("--measured", multiple=True, metavar="LENGTH", help="What it measured (again for more measurements).")
@click.option("--take", "parts", type=click.Choice(PARTS), multiple=True,
              help="What is taken from the points (again for more); screw and backlash unless given.")  # fmt: skip
@click.option("--square", "pair", type=click.Choice(PAIRS), help="Find the angle between two axes.")
@click.option("--diagonals", metavar="D1,D2",
              help='Of a square moved along: from (-,-) to (+,+), and the other: "141.44 mm, 141.40 mm".')  # fmt: skip
@click.option("--sides", metavar="A,B", help="Its sides along the first and the second axis; one if they are equal.")
@click.option("--deviation", metavar="LENGTH", help="How far the first axis is off to plus along a true square.")
@click.option("--over", metavar="LENGTH", help="Over how much of the second axis.")
@click.option("--resolution", default="0 mm", show_default=True, metavar="LENGTH", help="Of the instrument.")
@click.option("--write", is_flag=True, help="Write it into the machine file; --undo takes it back.")
@click.option("--undo", is_flag=True, help="Give the machine file what it had before it was last changed.")
@as_json
def command(  # noqa: PLR0917 - click hands options over by name
    name: str, axis: str | None, points: Path | None, asked: str | None, measured: tuple[str, ...],
    parts: tuple[str, ...], pair: str | None, diagonals: str | None, sides: str | None, deviation: str | None,
    over: str | None, resolution: str, write: bool, undo: bool, as_json: bool,
) -> None:  # fmt: skip
    """Find scale, screw table, backlash or squareness from measured points; shows before and after.

    Points are measured with the corrections that the file has already: what is found is added.  Nothing is written
    without --write; comments stay, and the file is written whole or not at all.  ± is twice the standard deviation.

    Example: trochia machine calibrate mill.toml --axis X --points x.csv --resolution "1 um" --write
    """
    from trochia.machine.load import loads, text_of  # noqa: PLC0415 - `trochia --help` must stay light

    if undo:
        _undo(name, as_json=as_json)
        return
    if (axis is None) == (pair is None):
        raise click.UsageError("give --axis with --points, or with --asked and --measured; or --square")
    file, text = text_of(name)
    machine = loads(text, file)
    if pair is not None:
        made, keys, told = _squared(machine, pair, diagonals=diagonals, sides=sides, deviation=deviation,
                                    over=over, resolution=_length(resolution))  # fmt: skip
    else:
        found, parts = _found(machine, str(axis), points=points, asked=asked, measured=measured, parts=parts,
                              resolution=resolution)  # fmt: skip
        made, keys, told = _axis(machine, str(axis), found, parts)
    changed = _written(name, file, text, made, keys) if write else False
    if as_json:
        print_json(told | {"written": changed, "file": file})
        return
    _show(told)
    click.echo(f"written to {file}; `trochia machine calibrate {name} --undo` takes it back" if changed
               else "nothing written: --write does")  # fmt: skip


def _found(
    machine: Machine, axis: str, *, points: Path | None, asked: str | None, measured: tuple[str, ...],
    parts: tuple[str, ...], resolution: str,
) -> tuple[Found, tuple[str, ...]]:  # fmt: skip
    """Return what was found of an axis, and which parts of it are taken."""
    from trochia.analysis.calibration import fit, read_points  # noqa: PLC0415 - `trochia --help` must stay light

    rotary = any(one.name == axis and one.rotary for one in machine.axes)
    fine = 0.0 if resolution == "0 mm" else _length(resolution, rotary=rotary)
    if points is not None:
        found = fit(read_points(points, rotary=rotary), resolution=fine)
        return found, parts or ("screw", *(("backlash",) if found.backlash is not None else ()))
    if asked is None or not measured:
        raise click.UsageError("--axis goes with --points FILE.csv, or with --asked and --measured")
    if set(parts) - {"scale"}:
        raise click.UsageError("one length gives the scale only: --take scale")
    return _one_length(_length(asked, rotary=rotary), [_length(m, rotary=rotary) for m in measured], fine), ("scale",)


def _one_length(asked: float, measured: list[float], resolution: float) -> Found:
    """Return the scale from one way that was measured once or more."""
    from statistics import fmean, stdev  # noqa: PLC0415

    from trochia.analysis.calibration import Found, Spot  # noqa: PLC0415 - `trochia --help` must stay light

    if asked == 0.0:
        raise click.UsageError("--asked is a way, not 0")
    sigma = stdev(measured) if len(measured) > 1 else None
    error = fmean(measured) - asked
    sure = 2.0 * math.sqrt((sigma or 0.0) ** 2 / len(measured) + resolution**2 / 12.0)
    return Found(spots=(Spot(0.0, 0.0, 0.0), Spot(asked, error, sure)), scale=(error / asked, abs(sure / asked)),
                 backlash=None, repeatability=sigma, reference=0.0)  # fmt: skip


def _axis(
    machine: Machine, axis: str, found: Found, parts: tuple[str, ...]
) -> tuple[Machine, list[tuple[str, str]], dict[str, Any]]:
    """Return the machine, the keys that change, and what to tell."""
    from trochia.analysis.calibration import calibrated  # noqa: PLC0415 - `trochia --help` must stay light

    if "backlash" in parts and found.backlash is None:
        raise ConfigError("no place was come to from both ways", key="backlash",
                          hint="Measure places on the way up and on the way back.")  # fmt: skip
    result = calibrated(machine, axis, found, parts)
    keys = [(f"joints.{joint}", key) for joint in result.joints
            for key in (*(["transmission"] if "scale" in parts else []),
                        *(["compensation"] if set(parts) - {"scale"} else []))]  # fmt: skip
    index = next(j for j, joint in enumerate(machine.joints) if joint.name == result.joints[0])
    before, after = machine.joints[index], result.machine.joints[index]
    told = {
        "axis": axis, "joints": list(result.joints), "taken": list(parts),
        "unit": next(one.unit for one in machine.axes if one.name == axis),
        "repeatability": found.repeatability, "reference": found.reference,
        "scale": {"error_ppm": 1e6 * found.scale[0], "uncertainty_ppm": 1e6 * found.scale[1],
                  "steps_per_unit": [_per(before.steps_per_unit), _per(after.steps_per_unit)]},
        "backlash": None if found.backlash is None else {
            "found": found.backlash[0], "uncertainty": found.backlash[1],
            "corrected": [_given(before.compensation), _given(after.compensation)]},
        "points": [{"place": s.place, "error": s.error, "uncertainty": s.sure} for s in found.spots],
        "greatest_error": [result.before, result.after],
    }  # fmt: skip
    return result.machine, keys, told


def _given(compensation: Any) -> float:  # noqa: ANN401 - a Compensation or None
    return 0.0 if compensation is None else compensation.backlash


def _per(value: Any) -> float | None:  # noqa: ANN401 - a Fraction or None
    return None if value is None else float(value)


def _squared(
    machine: Machine, pair: str, *, diagonals: str | None, sides: str | None, deviation: str | None, over: str | None,
    resolution: float,
) -> tuple[Machine, list[tuple[str, str]], dict[str, Any]]:  # fmt: skip
    from trochia.analysis.calibration import by_deviation, by_diagonals, square  # noqa: PLC0415

    if (diagonals is None) == (deviation is None):
        raise click.UsageError("--square goes with --diagonals and --sides, or with --deviation and --over")
    if deviation is not None:
        if over is None:
            raise click.UsageError("--deviation goes with --over LENGTH")
        angle, sure = by_deviation(_length(deviation), _length(over), resolution=resolution)
    else:
        first, second = _two(diagonals, "--diagonals")
        angle, sure = by_diagonals(first, second, _two(sides, "--sides"), resolution=resolution)
    made = square(machine, pair, angle)
    before = 0.0 if machine.squareness is None else getattr(machine.squareness, pair)
    told = {"pair": pair, "angle_deg": angle, "uncertainty_deg": sure,
            "corrected_deg": [before, getattr(made.squareness, pair)]}  # fmt: skip
    return made, [("squareness", pair)], told


def _written(name: str, file: str, text: str, machine: Machine, keys: list[tuple[str, str]]) -> bool:
    """Write the machine's file, the text before kept."""
    from trochia.machine.key_text import with_keys  # noqa: PLC0415
    from trochia.machine.undo import change  # noqa: PLC0415

    path = Path(file)
    if not path.is_file():
        raise ConfigError(f"{name} comes with Trochia and is not written to", key="machine",
                          hint=f"Copy it first: trochia machine show {name} tells what it is.")  # fmt: skip
    change(path, with_keys(text, machine, keys, file=file), "calibration")
    return True


def _undo(name: str, *, as_json: bool) -> None:
    from trochia.machine.undo import undo  # noqa: PLC0415

    path = Path(name)
    if not path.is_file():
        raise ConfigError(f"{name} is no file: there is nothing to undo", key="machine")
    what = undo(path)
    print_json({"undone": what, "file": name}) if as_json else click.echo(f"{name} is as it was before its {what}")


def _show(told: dict[str, Any]) -> None:
    if "pair" in told:
        before, after = told["corrected_deg"]
        click.echo(
            f"{told['pair']}: {90 + told['angle_deg']:.5f} ± {told['uncertainty_deg']:.5f} degree between the axes"
        )
        click.echo(f"corrected: {before:.6g} → {after:.6g} degree beyond 90")
        return
    unit, small = told["unit"], ("µm", 1e3) if told["unit"] == "mm" else ("0.001 deg", 1e3)
    rows = [["place", "error", "±"]]
    rows += [[f"{p['place']:.4f} {unit}", f"{small[1] * p['error']:.2f} {small[0]}",
              f"{small[1] * p['uncertainty']:.2f} {small[0]}"] for p in told["points"]]  # fmt: skip
    click.echo(table(rows, left=()))
    scale = told["scale"]
    click.echo(f"scale       {scale['error_ppm']:+.2f} ± {scale['uncertainty_ppm']:.2f} ppm"
               + ("" if "scale" in told["taken"] else "  (not taken)"))  # fmt: skip
    before, after = scale["steps_per_unit"]
    if before is not None:
        click.echo(f"steps       {before:.10g} → {after:.10g} /{unit}")
    if told["backlash"] is not None:
        lost = told["backlash"]
        taken = "" if "backlash" in told["taken"] else "  (not taken)"
        had, gets = (small[1] * value for value in lost["corrected"])
        click.echo(f"backlash    {small[1] * lost['found']:.2f} ± {small[1] * lost['uncertainty']:.2f} {small[0]}; "
                   f"corrected {had:.2f} → {gets:.2f}{taken}")  # fmt: skip
    if told["repeatability"] is not None:
        click.echo(f"repeats to  {small[1] * told['repeatability']:.2f} {small[0]} (one standard deviation)")
    before, after = told["greatest_error"]
    click.echo(f"greatest error at these points {small[1] * before:.2f} → {small[1] * after:.2f} {small[0]}, foreseen")
