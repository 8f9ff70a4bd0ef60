"""``trochia tune``: gains for a machine's servo joint, or for a model given by its numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from trochia.cli import axis_options, options

if TYPE_CHECKING:
    from trochia.analysis.tuning import Judged, Margins, Shaped
    from trochia.machine.servo_plant import ServoPlant

_AXIS_RULES = ("shaping", "optimise")  # those of `analysis.tuning.AXIS_RULES`
_MODEL_RULES = ("simc", "ziegler-nichols", "ziegler-nichols-closed", "bandwidth")


@click.command()
@axis_options.machine
@axis_options.joint
@click.option(
    "--rule", type=click.Choice(_AXIS_RULES + _MODEL_RULES), help="Without it shaping for a joint, else simc."
)
@click.option("--identify", "first", is_flag=True, help="Find the joint's model by experiment first, not by its file.")
@click.option("--ms", default=1.6, show_default=True, help="Greatest sensitivity allowed.")
@click.option("--gain", type=float, help="Of the model gain exp(-dead s) / (lag s + 1).")
@click.option("--lag", type=float, help="Of the model [s]; without it the model integrates.")
@click.option("--dead", type=float, help="Of the model [s].")
@click.option("--ku", type=float, help="Ultimate gain, for ziegler-nichols-closed.")
@click.option("--tu", type=float, help="Ultimate period [s].")
@click.option("--bandwidth", type=float, help="Of position control of gain / (s (lag s + 1)) [Hz].")
@click.option("--damping", type=float, default=0.7, show_default=True, help="With --bandwidth.")
@axis_options.plots
def command(*, machine_name: str | None, joint: str | None, rule: str | None, first: bool, plot: str | None,
            as_json: bool, ms: float, **model: Any) -> None:  # noqa: ANN401 - click's  # fmt: skip
    """Tune a servo joint on its twin (before and after side by side), or gains for a model by a rule.

    Example: trochia tune -m xy-table --joint X --rule optimise -o tuned.html
    """
    if machine_name is not None:
        if rule in _MODEL_RULES:
            raise click.BadParameter(f"{rule} is for a model's numbers; a joint takes {' or '.join(_AXIS_RULES)}",
                                     param_hint="--rule")  # fmt: skip
        _joint(axis_options.asked_axis(machine_name, joint), rule or "shaping", ms, plot, first=first, as_json=as_json)
        return
    if rule in _AXIS_RULES or first or plot is not None:
        raise click.UsageError("shaping, the search, experiments and pictures are for a joint: give a machine with -m")
    _model(rule or ("bandwidth" if model["bandwidth"] else "simc"), model, as_json=as_json)


def _needed(model: dict[str, Any], *names: str) -> list[float]:
    """Return the values of options, or name the one that is missing."""
    for name in names:
        if model[name] is None:
            raise click.UsageError(f"this rule needs --{name}")
    return [float(model[name]) for name in names]


def _model(rule: str, model: dict[str, Any], *, as_json: bool) -> None:
    from trochia.analysis.tuning import Fopdt, Integrating, Ultimate, margins_of  # noqa: PLC0415 - light --help
    from trochia.analysis.tuning.closed import closed_loop  # noqa: PLC0415
    from trochia.analysis.tuning.rules import FOPDT_RULES, ULTIMATE_RULES, bandwidth_and_damping, simc  # noqa: PLC0415

    found: dict[str, Any] = {"model": None, "uncertainty": None, "margins": None, "metrics": None}
    margins: Margins | None = None
    if rule == "ziegler-nichols-closed":
        gain, time = _needed(model, "ku", "tu")
        gains = ULTIMATE_RULES[rule](Ultimate(gain=gain, time=time))
        found["model"] = {"ku": gain, "tu_s": time}
    elif rule == "bandwidth":
        gain, lag, bandwidth = _needed(model, "gain", "lag", "bandwidth")
        gains = bandwidth_and_damping(gain, lag, bandwidth=bandwidth, damping=float(model["damping"]))
        closed = closed_loop(gains, [gain], [lag, 1.0, 0.0])
        margins = closed.margins
        found |= {"model": {"gain": gain, "lag_s": lag}, "metrics": closed.step.figures()}
    else:
        gain, dead = _needed(model, "gain", "dead")
        lag = model["lag"]
        if lag is None and rule != "simc":
            raise click.UsageError("this rule needs --lag")
        plant = Integrating(gain=gain, dead=dead) if lag is None else Fopdt(gain=gain, lag=lag, dead=dead)
        gains = simc(plant) if isinstance(plant, Integrating) else FOPDT_RULES[rule](plant)
        margins = margins_of(lambda w: gains.response(w) * plant.response(w), 1e-3 / dead, 30.0 / dead)
        found["model"] = {"gain": gain, "lag_s": lag, "dead_s": dead}
    found |= {"gains": gains.figures(), "margins": None if margins is None else margins.figures()}
    if as_json:
        options.print_json(found)
        return
    click.secho(f"{rule}: kp {gains.kp:.6g}, ki {gains.ki:.6g} 1/s, kd {gains.kd:.6g} s", bold=True)
    if margins is not None:
        click.echo(f"  {_said(margins)}")


def _said(margins: Margins) -> str:
    return f"gain margin {margins.gm:.3f}, phase margin {margins.pm_deg:.2f}°, Ms {margins.ms:.3f}"


def _joint(
    asked: axis_options.AskedAxis, rule: str, ms: float, plot: str | None, *, first: bool, as_json: bool
) -> None:
    from trochia.analysis.tuning import Moves, Robustness, judge, optimise, shape  # noqa: PLC0415 - light --help
    from trochia.machine.servos import CascadeLoop, PidLoop  # noqa: PLC0415
    from trochia.servo.joint import loop_of  # noqa: PLC0415

    plant, uncertainty = asked.plant, None
    if first:
        from trochia.cli.identify import figures, run_experiment  # noqa: PLC0415

        found = run_experiment(asked, lambda what: None if as_json else click.echo(f"  {what} …", err=True))
        plant, uncertainty = found.plant, figures(found)["uncertainty"]
    period, limit = asked.drive.period, asked.bounds.command
    moves = Moves(step=0.1, way=asked.speed / 6.0, time=0.5)
    shaped = (shape(plant, period, most_ms=ms, limit=limit, size=moves.step) if rule == "shaping"
              else optimise(plant, period, bounds=Robustness(ms=ms), limit=limit, size=moves.step))  # fmt: skip
    after = judge(asked.plant, shaped.loop, moves)
    data = asked.drive.loop
    before = judge(asked.plant, loop_of(asked.drive), moves) if isinstance(data, CascadeLoop | PidLoop) else None
    files: list[str] = []
    if plot is not None:
        _draw(asked, after, before, plot)
        files = [plot]
    if as_json:
        options.print_json({
            "model": _model_figures(plant), "uncertainty": uncertainty, "gains": _gains(shaped),
            "margins": after.margins.figures(), "metrics": after.figures(),
            "before": None if before is None else before.figures() | {"margins": before.margins.figures()},
            "files": files,
        })  # fmt: skip
        return
    _show(asked.name, rule, shaped, after, before)
    for file in files:
        click.echo(f"wrote {file}")


def _draw(asked: axis_options.AskedAxis, after: Judged, before: Judged | None, plot: str) -> None:
    from trochia.analysis.tuning.picture import tuning_picture  # noqa: PLC0415 - it loads matplotlib

    title = f"joint {asked.name}: tuned on its twin"
    rows = [(name.replace("_", " "), "none" if value is None else f"{value:.4g}")
            for name, value in (after.margins.figures() | after.figures()).items()]  # fmt: skip
    axis_options.write_plot(
        plot, title, lambda form: tuning_picture(asked.plant, after, title, before, form=form), rows
    )


def _model_figures(plant: ServoPlant) -> dict[str, Any]:
    return {
        "motor_inertia": plant.motor_inertia, "load_inertia": plant.load_inertia, "stiffness": plant.stiffness,
        "damping": plant.damping, "gap": plant.gap,
        "viscous": plant.motor_friction.viscous + plant.load_friction.viscous,
        "coulomb": plant.motor_friction.coulomb + plant.load_friction.coulomb,
    }  # fmt: skip


def _gains(shaped: Shaped) -> dict[str, Any]:
    """Return the gains by the machine file's keys."""
    loop = shaped.loop
    assert loop.position is not None, "a cascade has both"
    assert loop.speed is not None, "a cascade has both"
    given: dict[str, Any] = {
        "position_gain": loop.position.kp, "speed_gain": loop.speed.kp,
        "speed_integral": loop.speed.ki / loop.speed.kp, "velocity_forward": 1.0, "acceleration_forward": 1.0,
        "friction_forward": 1.0, "notch": None,
    }  # fmt: skip
    if shaped.notch is not None:
        given["notch"] = dict(zip(("frequency_Hz", "width", "depth"), shaped.notch, strict=True))
    return given


def _show(name: str, rule: str, shaped: Shaped, after: Judged, before: Judged | None) -> None:
    """Print the loop as it stands in a machine file, and what it does."""
    gains = _gains(shaped)
    click.secho(f"[joints.{name}.loop]", bold=True)
    click.echo('kind = "cascade"')
    click.echo(f'position_gain = "{gains["position_gain"]:.6g} 1/s"')
    click.echo(f'speed_gain = "{gains["speed_gain"]:.6g} V·s/rad"')
    click.echo(f'speed_integral = "{gains["speed_integral"]:.6g} 1/s"')
    click.echo("velocity_forward = 1\nacceleration_forward = 1\nfriction_forward = 1")
    if shaped.notch is not None:
        frequency, width, depth = shaped.notch
        click.echo(f'notch = {{ frequency = "{frequency:.5g} Hz", width = {width:.4g}, depth = {depth:.4g} }}')
    for what, judged in (("before", before), (rule, after)):
        if judged is not None:
            step, following = judged.step, judged.following
            click.echo(f"# {what}: {_said(judged.margins)}; settles in {step.settling * 1e3:.1f} ms, overshoot "
                       f"{step.overshoot:.1%}, following error {following.peak:.3g} rad at most")  # fmt: skip
    if before is None:
        click.echo("# the joint's own loop computes in whole numbers: it is not judged beside this one")
