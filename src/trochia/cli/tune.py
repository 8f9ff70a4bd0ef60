"""``trochia tune``: gains for a machine's servo joint, or for a model given by its numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from trochia.cli import axis_options, options, tune_joint
from trochia.cli.tune_moves import move, move_options

if TYPE_CHECKING:
    from trochia.analysis.tuning import Margins

_ONLY_AXIS = ("shaping", "optimise", "relay")  # the first two are those of `analysis.tuning.AXIS_RULES`
_AXIS_RULES = (*_ONLY_AXIS, "bandwidth")
_ULTIMATE_RULES = ("ziegler-nichols-closed", "ziegler-nichols-pi", "tyreus-luyben")  # `tuning.rules.ULTIMATE_RULES`
_MODEL_RULES = ("simc", "ziegler-nichols", *_ULTIMATE_RULES, "bandwidth")


@click.command()
@axis_options.machine
@axis_options.joint
@click.option("--rule", type=click.Choice(_ONLY_AXIS + _MODEL_RULES), help="Without it shaping for a joint, else simc.")
@click.option("--identify", "first", is_flag=True, help="Find the joint's model by experiment first, not by its file.")
@click.option("--apply", is_flag=True, help="Write the loop into the machine's file; --undo takes it back.")
@click.option("--undo", is_flag=True, help="Give the machine's file the loop that it had before the last --apply.")
@move_options
@click.option("--ms", default=1.6, show_default=True, help="Greatest sensitivity allowed.")
@click.option("--gain", type=float, help="Of the model gain exp(-dead s) / (lag s + 1).")
@click.option("--lag", type=float, help="Of the model [s]; without it the model integrates.")
@click.option("--dead", type=float, help="Of the model [s].")
@click.option("--ku", type=float, help="Ultimate gain, for rules that start from it.")
@click.option("--tu", type=float, help="Ultimate period [s].")
@click.option("--bandwidth", type=float, help="Of position control of gain / (s (lag s + 1)) [Hz].")
@click.option("--damping", type=float, default=0.7, show_default=True, help="With --bandwidth.")
@axis_options.plots
def command(*, machine_name: str | None, joint: str | None, rule: str | None, plot: str | None, as_json: bool,
            ms: float, move_kind: str | None, size: str | None, time: str | None, **more: Any) -> None:  # noqa: ANN401 - click's  # fmt: skip
    """Tune a servo joint on its twin (before and after side by side), or gains for a model by a rule.

    With --move nothing is tuned: a step or a parabolic move is run under the joint's own loop, and its rise, overshoot,
    settling, following error and the feed-forward that would help are told.

    Example: trochia tune -m xy-table --joint X --rule optimise -o tuned.html
    """
    first, apply, undo = (bool(more.pop(name)) for name in ("first", "apply", "undo"))
    if undo and (rule or first or apply or plot or move_kind):
        raise click.UsageError("--undo takes a machine with -m, and nothing else")
    if (size or time) and move_kind is None:
        raise click.UsageError("--size and --time are of a --move")
    if machine_name is None:
        if rule in _ONLY_AXIS or first or plot or apply or undo or move_kind:
            raise click.UsageError("shaping, the search, relay, experiments, moves, pictures and files are for a "
                                   "joint: give a machine with -m")  # fmt: skip
        _model(rule or ("bandwidth" if more["bandwidth"] else "simc"), more, as_json=as_json)
        return
    if rule in _MODEL_RULES and rule not in _AXIS_RULES:
        raise click.BadParameter(f"{rule} is for a model's numbers; a joint takes {', '.join(_AXIS_RULES)}",
                                 param_hint="--rule")  # fmt: skip
    if move_kind is not None and (rule or first or apply):
        raise click.UsageError("--move tunes nothing: it goes with -m, --joint, --size, --time and -o")
    wish = tune_joint.Asked(rule or "shaping", ms, more["bandwidth"], float(more["damping"]))
    _machine(machine_name, joint, wish, plot, as_json=as_json, first=first, apply=apply, undo=undo,
             moved=None if move_kind is None else (move_kind, {"size": size, "time": time}))  # fmt: skip


def _machine(
    machine_name: str, joint: str | None, wish: tune_joint.Asked, plot: str | None, *, as_json: bool, first: bool,
    apply: bool, undo: bool, moved: tuple[str, dict[str, str | None]] | None,
) -> None:  # fmt: skip
    """Do what is asked of a machine's joint."""
    if undo:
        tune_joint.undo(machine_name, as_json=as_json)
        return
    asked = axis_options.asked_axis(machine_name, joint)
    if moved is not None:
        move(asked, moved[0], moved[1], plot, as_json=as_json)
    else:
        tune_joint.joint(asked, wish, plot, first=first, apply=apply, as_json=as_json)


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
    if rule in _ULTIMATE_RULES:
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
        click.echo(f"  {tune_joint.said(margins)}")
