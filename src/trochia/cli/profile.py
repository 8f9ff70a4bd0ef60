"""``trochia profile``: a stepper's move step by step; laws compared, a requirement judged."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from trochia.cli import options, step_units
from trochia.cli.tables import clock, table
from trochia.files import write_whole

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.pulses.ramps import Demand, Profile, Requirement, Verdict

_SHOWN = 5  # rows of the table's beginning and of its end
_LAWS = "exact, austin, linear, library, torque"

_OPTIONS = (
    click.option("--steps", type=click.IntRange(1, 1_000_000), required=True, metavar="N", help="Length of the move."),
    click.option("--steps-per-turn", type=click.IntRange(1, 1_000_000), default=200, show_default=True, metavar="N",
                 help="Steps of a turn, microsteps counted."),
    click.option("--speed", required=True, metavar="SPEED",
                 help='Greatest speed: "200 rpm", "21 rad/s", "670 steps/s".'),
    click.option("--acceleration", metavar="A", help='"100 rad/s²", "100 rad/s2" or "3000 steps/s²".'),
    click.option("--deceleration", metavar="A", help="Without it the acceleration."),
    click.option("--law", "laws", multiple=True, metavar="NAME",
                 help=f"One of {_LAWS}; again for an overlay.  Without it exact, or torque where a torque curve and "
                 "no acceleration is given."),
    click.option("--start-stop", metavar="SPEED", help="Greatest speed to start at and stop from without lost steps."),
    click.option("--torque-curve", type=click.Path(exists=True, dir_okay=False, path_type=Path), metavar="FILE.csv",
                 help="Pull-out torque over speed; first line like speed_rpm,torque_Nm."),
    click.option("--load-torque", default="0 N·m", show_default=True, metavar="TORQUE", help="What the load takes."),
    click.option("--inertia", metavar="J", help='Of rotor and load together: "200 g·cm²", "2e-5 kg·m²".'),
    click.option("--time-box", metavar="TIME", help="End in this time: the deceleration is chosen, or both ramps where "
                 "no acceleration is given."),
    click.option("--require", metavar="TIME", help="Judge the profile by this time; without it by the time box."),
    click.option("--tolerance", default="5 %", show_default=True, metavar="PERCENT", help="Of the required time."),
    click.option("--clock", "clock_text", default="1 MHz", show_default=True, metavar="F", help="The timer's clock."),
    click.option("--update", default="1 ms", show_default=True, metavar="TIME",
                 help="How often the law linear sets the speed anew, at least."),
    click.option("--csv", "csv_file", type=click.Path(dir_okay=False, writable=True), metavar="FILE.csv",
                 help="Write the whole table (of the first law)."),
    click.option("--plot", type=click.Path(dir_okay=False, writable=True), metavar="FILE.png", help="Draw all laws."),
    options.as_json,
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class _Asked:
    """What the options say."""

    demand: Demand
    laws: tuple[str, ...]
    time_box: float | None
    requirement: Requirement | None


def _options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options, in their order."""
    for decorate in reversed(_OPTIONS):
        function = decorate(function)
    return function


@click.command()
@_options
def command(*, csv_file: str | None, plot: str | None, as_json: bool, **given: Any) -> None:  # noqa: ANN401 - click's
    """Tabulate a stepper's velocity profile, step by step, and say whether it will do.

    Exit code 1 where it does not meet the required time, or the motor cannot do it.

    Example: trochia profile --steps 400 --speed "200 rpm" --acceleration "100 rad/s2" --require "0.7 s"
    """
    from trochia.pulses.ramps import profile, verdict  # noqa: PLC0415 - `trochia --help` must stay light

    asked = _asked(given)
    for option, file in (("--csv", csv_file), ("--plot", plot)):
        if file is not None and not Path(file).parent.is_dir():
            raise click.BadParameter(f"there is no folder {Path(file).parent}", param_hint=option)
    profiles = [profile(asked.demand, law, time_box=asked.time_box) for law in asked.laws]
    verdicts = [verdict(made, asked.requirement) for made in profiles]
    if csv_file is not None:
        write_whole(Path(csv_file), _csv(profiles[0]).encode())
    if plot is not None:
        from trochia.pulses.ramps.picture import picture  # noqa: PLC0415 - it loads matplotlib

        write_whole(Path(plot), picture(profiles, asked.requirement))
    files = [file for file in (csv_file, plot) if file is not None]
    if as_json:
        first, *others = (_json(*pair) for pair in zip(profiles, verdicts, strict=True))
        options.print_json({**first, "others": others, "files": files})
    else:
        for made, judged in zip(profiles, verdicts, strict=True):
            _show(made, judged)
        for file in files:
            click.echo(f"wrote {file}")
    if not all(judged.ok for judged in verdicts):
        raise SystemExit(1)


def _asked(given: dict[str, Any]) -> _Asked:
    """Return the options' texts as numbers in steps and seconds."""
    from trochia.pulses.ramps import RAMPS, Demand, Requirement, read_curve  # noqa: PLC0415 - as above

    turn = given["steps_per_turn"]

    def optional(name: str, parse: Callable[..., float], *rest: object) -> float | None:
        text = given[name]
        return None if text is None else parse(text, *rest, "--" + name.replace("_", "-"))

    curve_file = given["torque_curve"]
    demand = Demand(
        steps=given["steps"],
        steps_per_turn=turn,
        speed=step_units.speed(given["speed"], turn, "--speed"),
        acceleration=optional("acceleration", step_units.acceleration, turn),
        deceleration=optional("deceleration", step_units.acceleration, turn),
        start_stop=optional("start_stop", step_units.speed, turn),
        curve=None if curve_file is None else read_curve(curve_file, turn),
        load=step_units.quantity(given["load_torque"], "torque", "--load-torque"),
        inertia=optional("inertia", step_units.positive, "inertia"),
        clock=step_units.positive(given["clock_text"], "frequency", "--clock"),
        update=step_units.positive(given["update"], "time", "--update"),
    )
    time_box = optional("time_box", step_units.positive, "time")
    by_torque = curve_file is not None and demand.acceleration is None and time_box is None
    laws: tuple[str, ...] = given["laws"] or ("torque" if by_torque else "exact",)
    for law in laws:
        if law not in RAMPS:
            raise click.BadParameter(f"there is no law {law!r}; there are {', '.join(RAMPS)}", param_hint="--law")
    time = optional("require", step_units.positive, "time")
    time = time_box if time is None else time
    tolerance = step_units.fraction(given["tolerance"], "--tolerance")
    requirement = None if time is None else Requirement(time=time, tolerance=tolerance)
    return _Asked(demand=demand, laws=laws, time_box=time_box, requirement=requirement)


def _csv(profile: Profile) -> str:
    """Return the whole table as CSV; numbers with nine significant digits."""
    columns = profile.columns()
    lines = [",".join(columns)]
    lines += [
        ",".join(f"{value:.9g}" for value in row)
        for row in zip(*(column.tolist() for column in columns.values()), strict=True)
    ]
    return "\n".join(lines) + "\n"


def _json(profile: Profile, verdict: Verdict) -> dict[str, Any]:
    """Return a profile by JSON's keys; the table is a list of rows."""
    from trochia.pulses.ramps import RAMPS  # noqa: PLC0415 - `trochia --help` must stay light

    columns = {key: column.tolist() for key, column in profile.columns().items()}
    by_torque = RAMPS[profile.law].by_torque
    return {
        "law": profile.law,
        "steps": profile.demand.steps,
        "time_s": profile.duration,
        "peak_steps_s": profile.peak,
        "acceleration_steps_s2": None if by_torque else profile.demand.rising,
        "deceleration_steps_s2": None if by_torque else profile.demand.falling,
        "verdict": {"ok": verdict.ok, "reason": verdict.reason, "remedy": verdict.remedy},
        "table": [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)],
    }


def _show(profile: Profile, verdict: Verdict) -> None:
    """Print the first and last rows, the summary, and the verdict."""
    from trochia.pulses.ramps import COLUMNS, RAMPS  # noqa: PLC0415 - `trochia --help` must stay light

    demand = profile.demand
    click.secho(
        f"{profile.title}: {demand.steps} step{'s' * (demand.steps > 1)} in {clock(profile.duration)}", bold=True
    )
    columns = profile.columns()
    size = profile.delays.size
    rows = range(size) if size <= 2 * _SHOWN + 1 else [*range(_SHOWN), None, *range(size - _SHOWN, size)]
    cells = [[title for _, title, _ in COLUMNS]]
    cells += [
        ["…" for _ in COLUMNS] if row is None else [f"{columns[key][row]:.{digits}f}" for key, _, digits in COLUMNS]
        for row in rows
    ]
    click.echo(table(cells, left=()))
    reached, held = _parts(profile)
    click.echo(f"  accelerates for {reached} steps, holds {demand.said(profile.peak)} for {held}, "
               f"brakes for {size - reached - held}")  # fmt: skip
    if not RAMPS[profile.law].by_torque:
        click.echo(f"  acceleration {demand.said_acceleration(demand.rising)}, "
                   f"deceleration {demand.said_acceleration(demand.falling)}")  # fmt: skip
    click.secho(f"  {'It will do' if verdict.ok else 'It will not do'}: {verdict.reason}",
                fg="green" if verdict.ok else "red")  # fmt: skip
    if verdict.remedy is not None:
        click.echo(f"  {verdict.remedy}")


def _parts(profile: Profile) -> tuple[int, int]:
    """Return the steps before the shortest delay is first used, and how many use it."""
    shortest = float(profile.delays.min())
    held = (profile.delays <= shortest * (1.0 + 1e-9)).nonzero()[0]
    return int(held[0]), int(held[-1] - held[0] + 1)
