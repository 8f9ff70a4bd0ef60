"""``trochia tune -m MACHINE``: gains for a servo joint on its twin, before and after; written to its file on demand."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from trochia.cli import axis_options, options
from trochia.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.analysis.tuning import Judged, Margins
    from trochia.machine.servo_plant import ServoPlant
    from trochia.machine.servos import CascadeLoop, PidLoop, PmacLoop
    from trochia.servo.axis import Loop

_NAMES = {
    "gm": "gain margin", "pm_deg": "phase margin [°]", "ms": "Ms", "rise_s": "rise, 10 to 90 % [s]",
    "settling_s": "settled within 2 % [s]", "error": "left at the end", "following_error_peak": "following error [rad]",
    "following_error_rms": "following error, rms [rad]", "with_speed_s": "goes with speed [s]",
    "with_acceleration_s2": "goes with acceleration [s²]", "with_way": "goes with the way [rad]",
}  # fmt: skip
DIGITS = 6  #: of a gain in a file
_STEP, _COUNTS = 0.1, 20.0  # of the step by which loops are judged: radians, and counts, at least


class Asked(NamedTuple):
    """A rule, and what it is told: greatest sensitivity, bandwidth [Hz], damping ratio."""

    rule: str
    ms: float
    bandwidth: float | None
    damping: float


class Found(NamedTuple):
    """Gains as a machine's file has them, and what was measured on the way."""

    data: CascadeLoop | PidLoop | PmacLoop
    measured: dict[str, Any]


def joint(asked: axis_options.AskedAxis, wish: Asked, plot: str | None, *, first: bool, apply: bool,
          as_json: bool) -> None:  # fmt: skip
    """Tune a joint, tell before and after, and write what was asked for."""
    from dataclasses import replace  # noqa: PLC0415 - light --help

    from trochia.analysis.tuning import Moves, judge  # noqa: PLC0415
    from trochia.servo.nominal import nominal_loop  # noqa: PLC0415

    path = _file_of(asked) if apply else None
    plant, uncertainty = asked.plant, None
    if first:
        from trochia.cli.identify import figures, run_experiment  # noqa: PLC0415

        found = run_experiment(asked, _progress(as_json=as_json))
        plant, uncertainty = found.plant, figures(found)["uncertainty"]
    moves = Moves(step=max(_STEP, _COUNTS / (asked.plant.counts or 1e9)), way=asked.speed / 6.0, time=0.5)
    tuned = _tuned(asked, plant, wish, moves.step)
    # judged as the file will have it: its digits, and the feed-forward of the joint's own data
    after = judge(asked.plant, nominal_loop(replace(asked.drive, loop=tuned.data)), moves)
    before = _before(asked, nominal_loop(asked.drive), moves)
    files: list[str] = []
    if plot is not None:
        _draw(asked, after, before, plot)
        files.append(plot)
    if path is not None:
        _write(asked, path, tuned.data)
        files.append(str(path))
    if as_json:
        options.print_json({
            "model": _model_figures(plant), "uncertainty": uncertainty, "gains": _gains(tuned.data) | tuned.measured,
            "margins": after.margins.figures(), "metrics": after.figures(),
            "before": None if before is None else before.figures() | {"margins": before.margins.figures()},
            "files": files,
        })  # fmt: skip
        return
    _show(asked, wish.rule, tuned, after, before)
    for file in files:
        click.echo(f"wrote {file}")


def undo(machine_name: str, *, as_json: bool) -> None:
    """Give a machine's file the gains that it had before they were last tuned."""
    from trochia.machine.undo import undo as take_back  # noqa: PLC0415 - light --help

    path = Path(machine_name)
    if not path.is_file():
        raise ConfigError(f"{machine_name} is no file: only a machine's file that was tuned is undone", key="machine")
    what = take_back(path)
    if as_json:
        options.print_json({"undone": what, "files": [str(path)]})
    else:
        click.echo(f"{what} of {path} is as it was before it was tuned")


def _progress(*, as_json: bool) -> Callable[[str], None]:
    return lambda what: None if as_json else click.echo(f"  {what} …", err=True)


def _tuned(asked: axis_options.AskedAxis, plant: ServoPlant, wish: Asked, size: float) -> Found:
    """Return the gains of a rule."""
    if wish.rule == "relay":
        return _relay(asked)
    if wish.rule == "bandwidth":
        from trochia.analysis.tuning.commission import commissioned  # noqa: PLC0415 - light --help

        if wish.bandwidth is None:
            raise click.UsageError("this rule needs --bandwidth")
        return Found(commissioned(asked.drive, plant, bandwidth=wish.bandwidth, damping=wish.damping), {})
    return _shaped(asked, plant, wish.rule, wish.ms, size)


def _shaped(asked: axis_options.AskedAxis, plant: ServoPlant, rule: str, ms: float, size: float) -> Found:
    from trochia.analysis.tuning import Robustness, optimise, shape  # noqa: PLC0415 - light --help
    from trochia.machine.servos import CascadeLoop, NotchData  # noqa: PLC0415

    period, limit = asked.drive.period, asked.bounds.command
    shaped = (shape(plant, period, most_ms=ms, limit=limit, size=size) if rule == "shaping"
              else optimise(plant, period, bounds=Robustness(ms=ms), limit=limit, size=size))  # fmt: skip
    position, speed, old = shaped.loop.position, shaped.loop.speed, asked.drive.loop
    assert position is not None, "a cascade has both"
    assert speed is not None, "a cascade has both"
    notch = None if shaped.notch is None else NotchData(
        **dict(zip(("frequency", "width", "depth"), map(_rounded, shaped.notch), strict=True)))  # fmt: skip
    data = CascadeLoop(
        position_gain=_rounded(position.kp), speed_gain=_rounded(speed.kp),
        speed_integral=_rounded(speed.ki / speed.kp),
        velocity_forward=1.0, acceleration_forward=1.0, friction_forward=1.0, notch=notch, period=old.period,
        dead_band=old.dead_band if isinstance(old, CascadeLoop) else 0.0,
    )  # fmt: skip
    return Found(data, {})


def _relay(asked: axis_options.AskedAxis) -> Found:
    """Return Ziegler and Nichols' PID of the ultimate gain that a relay finds on the twin."""
    from trochia.analysis.tuning.rules import ziegler_nichols_closed  # noqa: PLC0415 - light --help
    from trochia.experiments.relay import relay  # noqa: PLC0415
    from trochia.machine.servos import PidLoop  # noqa: PLC0415

    counts = asked.plant.counts
    hysteresis = 4.0 / counts if counts else 1e-3
    seen = relay(asked.twin(), asked.bounds, size=0.1 * asked.bounds.command, hysteresis=hysteresis)
    gains = ziegler_nichols_closed(seen.ultimate)
    data = PidLoop(kp=_rounded(gains.kp), ki=_rounded(gains.ki), kd=_rounded(gains.kd), period=asked.drive.loop.period)
    return Found(data, {"ku": seen.gain.value, "ku_sigma": seen.gain.sigma, "tu_s": seen.time.value,
                        "tu_sigma_s": seen.time.sigma})  # fmt: skip


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _before(asked: axis_options.AskedAxis, loop: Loop, moves: Any) -> Judged | None:  # noqa: ANN401 - Moves
    """Return what the joint's own loop does; None where it is unstable."""
    from trochia.analysis.tuning import judge  # noqa: PLC0415 - light --help

    try:
        return judge(asked.plant, loop, moves)
    except ConfigError:
        return None


def _file_of(asked: axis_options.AskedAxis) -> Path:
    path = Path(asked.machine)
    if not path.is_file():
        from importlib import resources  # noqa: PLC0415 - light --help

        shipped = resources.files("trochia") / "data" / "machines" / f"{asked.machine}.toml"
        raise ConfigError(f"{asked.machine} comes with Trochia and is not written to", key="machine",
                          hint=f"Copy it first: cp {shipped} .")  # fmt: skip
    return path


def _write(asked: axis_options.AskedAxis, path: Path, data: CascadeLoop | PidLoop | PmacLoop) -> None:
    from trochia.machine.loop_text import with_loop  # noqa: PLC0415 - light --help
    from trochia.machine.undo import change  # noqa: PLC0415

    text = with_loop(path.read_text(encoding="utf-8"), asked.name, data, file=path.name)
    change(path, text, f"joints.{asked.name}.loop")


def _draw(asked: axis_options.AskedAxis, after: Judged, before: Judged | None, plot: str) -> None:
    from trochia.analysis.tuning.picture import tuning_picture  # noqa: PLC0415 - it loads matplotlib

    title = f"joint {asked.name}: tuned on its twin"
    was = {} if before is None else before.margins.figures() | before.figures()
    rows = [(_NAMES.get(name, name), f"{_said_value(was[name])} → {_said_value(value)}" if was else _said_value(value))
            for name, value in (after.margins.figures() | after.figures()).items()]  # fmt: skip
    axis_options.write_plot(
        plot, title, lambda form: tuning_picture(asked.plant, after, title, before, form=form), rows
    )


def _said_value(value: float | None) -> str:
    return "none" if value is None else f"{value:.4g}"


def _model_figures(plant: ServoPlant) -> dict[str, Any]:
    return {
        "motor_inertia": plant.motor_inertia, "load_inertia": plant.load_inertia, "stiffness": plant.stiffness,
        "damping": plant.damping, "gap": plant.gap, "lag_s": plant.amplifier.lag,
        "viscous": plant.motor_friction.viscous + plant.load_friction.viscous,
        "coulomb": plant.motor_friction.coulomb + plant.load_friction.coulomb,
    }  # fmt: skip


def _gains(data: CascadeLoop | PidLoop | PmacLoop) -> dict[str, Any]:
    """Return the gains by the machine file's keys."""
    from trochia.machine.servos import PmacLoop  # noqa: PLC0415 - light --help

    names = [name for name in data.__slots__ if name not in {"notch", "period", "limit", "low_pass"}]
    given: dict[str, Any] = {"kind": data.kind} | {name: getattr(data, name) for name in names}
    notch = None if isinstance(data, PmacLoop) else data.notch
    given["notch"] = None if notch is None else {"frequency_Hz": notch.frequency, "width": notch.width,
                                                 "depth": notch.depth}  # fmt: skip
    return given


def _show(asked: axis_options.AskedAxis, rule: str, tuned: Found, after: Judged, before: Judged | None) -> None:
    """Print the loop as it stands in a machine file, and what it does."""
    from trochia.machine.dump import table_of  # noqa: PLC0415 - light --help

    head, *lines = table_of(f"joints.{asked.name}.loop", tuned.data, rotary=asked.rotary)
    click.secho(head, bold=True)
    for line in lines:
        click.echo(line)
    if "ku" in tuned.measured:
        m = tuned.measured
        click.echo(f"# relay: Ku {m['ku']:.5g} ± {m['ku_sigma']:.1g} V/rad, Tu {m['tu_s'] * 1e3:.4g} ms")
    for what, judged in (("before", before), (rule, after)):
        if judged is not None:
            step, following = judged.step, judged.following
            settles = f"settles in {step.settling * 1e3:.1f} ms" if step.settling < math.inf else "does not settle"
            error = f"following error {following.peak:.3g} rad at most"
            click.echo(f"# {what}: {said(judged.margins)}; {settles}, overshoot {step.overshoot:.1%}, {error}")
    if before is None:
        click.echo("# before: unstable, and not run")


def said(margins: Margins) -> str:
    """Return margins in words."""
    return f"gain margin {margins.gm:.3f}, phase margin {margins.pm_deg:.2f}°, Ms {margins.ms:.3f}"
