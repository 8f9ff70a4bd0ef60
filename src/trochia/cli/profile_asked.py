"""The options of ``trochia profile``, and what they say in steps and seconds."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from trochia.cli import options, step_units
from trochia.cli.motor_options import asked as motor_asked
from trochia.cli.motor_options import motor_options

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.cli.motor_options import Asked
    from trochia.pulses.ramps import Demand, Profile, Requirement

_LAWS = "exact, austin, linear, library, torque"
_FILE = click.Path(dir_okay=False, writable=True)
_AS_CSV = click.Path(exists=True, dir_okay=False, path_type=Path)
MOST_OVERLAID = 12
_OF_MOTOR = ("driver", "supply", "current", "series", "excitation", "wiring", "friction", "mass", "force", "vertical",
             "efficiency", "margin")  # fmt: skip

_OPTIONS = (
    click.option("--steps", "steps", multiple=True, metavar="N", type=click.IntRange(1, 1_000_000),
                 help="Length of the move in steps; again for an overlay."),
    click.option("--move", "moves", multiple=True, metavar="LENGTH",
                 help='Its length otherwise, "2 turn", "90 deg", "100 mm".'),
    click.option("--steps-per-turn", type=click.IntRange(1, 1_000_000), metavar="N",
                 help="Steps of a turn, microsteps counted; 200 if not given, a motor's own where one is named."),
    click.option("--speed", required=True, metavar="SPEED",
                 help='Greatest speed: "200 rpm", "21 rad/s", "670 steps/s", "50 mm/s".'),
    click.option("--acceleration", "accelerations", multiple=True, metavar="A",
                 help='"100 rad/s²", "100 rad/s2", "3000 steps/s²", "2000 mm/s²"; again for an overlay.'),
    click.option("--deceleration", metavar="A", help="Without it the acceleration."),
    click.option("--law", "laws", multiple=True, metavar="NAME",
                 help=f"One of {_LAWS}; again for an overlay.  Without it exact, or torque where a motor or a torque "
                 "curve and no acceleration is given."),
    click.option("--start-stop", metavar="SPEED", help="Greatest speed to start at and stop from without lost steps."),
    motor_options,
    click.option("--torque-curve", type=_AS_CSV, metavar="FILE.csv",
                 help="In place of a motor: pull-out torque over speed; first line like speed_rpm,torque_Nm.  Then "
                 "--inertia is of rotor and load together."),
    click.option("--prove/--no-prove", default=None,
                 help="Play the move on the twin of the motor; without either, moves of up to 20 s are."),
    click.option("--against", "measured", multiple=True, type=_AS_CSV, metavar="FILE",
                 help="Lay over it what a controller made of it: time_s, time_ms or time_us in the first line, then "
                 "the time of each step."),
    click.option("--time-box", metavar="TIME", help="End in this time: the deceleration is chosen, or both ramps where "
                 "no acceleration is given."),
    click.option("--require", metavar="TIME", help="Judge the profile by this time; without it by the time box."),
    click.option("--tolerance", default="5 %", show_default=True, metavar="PERCENT", help="Of the required time."),
    click.option("--require-speed", metavar="SPEED", help="Judge it by this speed being reached, too."),
    click.option("--clock", "clock_text", default="1 MHz", show_default=True, metavar="F", help="The timer's clock."),
    click.option("--chip-clock", metavar="F", help='Of the chip, "16 MHz": which of its timer\'s divisions would do.'),
    click.option("--update", default="1 ms", show_default=True, metavar="TIME",
                 help="How often the law linear sets the speed anew, at least."),
    click.option("--csv", "csv_file", type=_FILE, metavar="FILE.csv", help="Write the whole table (of the first one)."),
    click.option("--plot", "-o", type=_FILE, metavar="FILE.png|FILE.svg", help="Draw all of them."),
    options.as_json,
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class Wanted:
    """What the options say: profiles to be made, by demand, law and what to call each beside its law."""

    cases: tuple[tuple[Demand, str, str], ...]
    time_box: float | None
    requirement: Requirement | None
    speed: float | None
    motor: Asked | None
    prove: bool | None
    measured: tuple[Profile, ...]
    chip_clock: float | None


def profile_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options, in their order."""
    for decorate in reversed(_OPTIONS):
        function = decorate(function)
    return function


def wanted(given: dict[str, Any]) -> Wanted:
    """Return the options' texts as numbers in steps and seconds.

    Raises
    ------
    click.BadParameter, click.UsageError
        For options that are no quantity, or do not go together.
    TrochiaError
        For a motor, a driver or a machine that cannot be, and a move that cannot.
    """
    from trochia.pulses.ramps import RAMPS, Requirement  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.pulses.ramps.measured import read_times  # noqa: PLC0415

    motor = _motor(given)
    scale = _scale(given, motor)
    time_box, time = (_optional(given, name, step_units.positive, "time") for name in ("time_box", "require"))
    by_torque = (motor is not None or given["torque_curve"] is not None) and time_box is None
    laws: tuple[str, ...] = given["laws"] or ("torque" if by_torque and not given["accelerations"] else "exact",)
    for law in laws:
        if law not in RAMPS:
            raise click.BadParameter(f"there is no law {law!r}; there are {', '.join(RAMPS)}", param_hint="--law")
    time = time_box if time is None else time
    tolerance = step_units.fraction(given["tolerance"], "--tolerance")
    return Wanted(
        cases=_cases(given, scale, motor, laws),
        time_box=time_box,
        requirement=None if time is None else Requirement(time=time, tolerance=tolerance),
        speed=_optional(given, "require_speed", scale.speed),
        motor=motor,
        prove=given["prove"],
        measured=tuple(
            read_times(
                path,
                steps_per_turn=scale.per_turn,
                clock=step_units.positive(given["clock_text"], "frequency", "--clock"),
            )
            for path in given["measured"]
        ),
        chip_clock=_optional(given, "chip_clock", step_units.positive, "frequency"),
    )


def _motor(given: dict[str, Any]) -> Asked | None:
    """Return the motor that the options name, if any."""
    if given["motor"] is None and given["machine_name"] is None:
        for name in _OF_MOTOR:
            if given[name]:
                raise click.UsageError(f"--{name.replace('_', '-')} needs the --motor it is for.")
        return None
    if given["torque_curve"] is not None:
        raise click.UsageError("A torque curve stands in place of a motor: give one of them.")
    return motor_asked(given)


def _scale(given: dict[str, Any], motor: Asked | None) -> step_units.StepScale:
    """Return how lengths become steps."""
    turn = given["steps_per_turn"]
    if motor is None:
        travel = _optional(given, "travel_per_turn", step_units.positive, "length")
        return step_units.StepScale(per_turn=turn or 200, travel=travel)
    own = motor.pulses_per_turn
    if turn is not None and turn != own:
        raise click.BadParameter(
            f"the motor makes {own} steps a turn with {motor.made.excitation.name}, not {turn}; leave it out, or give "
            "another --excitation", param_hint="--steps-per-turn",
        )  # fmt: skip
    return step_units.StepScale(per_turn=own, travel=motor.travel, rotary=motor.rotary)


def _cases(
    given: dict[str, Any], scale: step_units.StepScale, motor: Asked | None, laws: tuple[str, ...]
) -> tuple[tuple[Demand, str, str], ...]:
    """Return every length with every acceleration and law."""
    lengths = [(steps, f"{steps} steps") for steps in given["steps"]]
    lengths += [(max(1, round(scale.length(text, "--move"))), text) for text in given["moves"]]
    if not lengths:
        raise click.UsageError('Give the length of the move: --steps 400, or --move "2 turn".')
    found: list[tuple[Demand, str, str]] = []
    for steps, length in lengths:
        for acceleration in given["accelerations"] or (None,):
            name = [length] * (len(lengths) > 1) + [acceleration or ""] * (len(given["accelerations"]) > 1)
            found += [
                (_demand(given, scale, motor, (steps, acceleration, law)), law, ", ".join(name)) for law in laws
            ]  # fmt: skip
    if len(found) > MOST_OVERLAID:
        raise click.UsageError(f"At most {MOST_OVERLAID} profiles lie over each other, not {len(found)}.")
    return tuple(found)


def _demand(
    given: dict[str, Any],
    scale: step_units.StepScale,
    motor: Asked | None,
    case: tuple[int, str | None, str],
) -> Demand:  # fmt: skip
    """Return the demand of a case: steps, acceleration, law.

    A motor's torque counts in the law made for it; by the others it is judged afterwards.
    """
    from trochia.analysis.stepper_move import torque_curve  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.pulses.ramps import RAMPS, Demand, read_curve  # noqa: PLC0415

    steps, acceleration, law = case
    curve, inertia = None, None
    load = 0.0
    if motor is None:
        if given["torque_curve"] is not None:
            curve = read_curve(given["torque_curve"], scale.per_turn)
        inertia = _optional(given, "inertia", step_units.positive, "inertia")
        load = step_units.quantity(given["load_torque"] or "0 N·m", "torque", "--load-torque")
    elif law in RAMPS and RAMPS[law].by_torque:
        curve, load = torque_curve(motor.shaft, scale.per_turn)
        inertia = motor.shaft.inertia
    return Demand(
        steps=steps,
        steps_per_turn=scale.per_turn,
        speed=scale.speed(given["speed"], "--speed"),
        acceleration=None if acceleration is None else scale.acceleration(acceleration, "--acceleration"),
        deceleration=_optional(given, "deceleration", scale.acceleration),
        start_stop=_optional(given, "start_stop", scale.speed),
        curve=curve,
        load=load,
        inertia=inertia,
        clock=step_units.positive(given["clock_text"], "frequency", "--clock"),
        update=step_units.positive(given["update"], "time", "--update"),
        travel=None if scale.rotary else scale.travel,
    )


def _optional(given: dict[str, Any], name: str, parse: Callable[..., float], *rest: object) -> float | None:
    """Return an option as a number; None where it is not given."""
    text = given[name]
    return None if text is None else parse(text, *rest, "--" + name.replace("_", "-"))
