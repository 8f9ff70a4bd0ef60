"""``trochia identify``: a model from measured motion, or by an experiment on the twin of a machine's servo joint."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from trochia.cli import axis_options, identify_data, options

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.analysis.identification import Estimate
    from trochia.experiments import Identified


@click.command()
@click.argument("data", required=False, type=click.Path(exists=True, dir_okay=False),
                metavar="[DATA.csv|DATA.hex|MOTOR.toml]")  # fmt: skip
@axis_options.machine
@axis_options.joint
@click.option("--model", type=click.Choice(identify_data.MODELS), default="first-order", show_default=True,
              help="Of a CSV: a step response (time, value); motion (time, position, force); frequency response or two "
                   "masses (time, input, output, and where a loop is closed what was injected).")  # fmt: skip
@click.option("--step", default=1.0, show_default=True, help="Size of the step that the CSV answers to.")
@click.option(
    "--viscous", default=0.0, show_default=True, help="Friction that --model two-mass takes as known [N·m·s/rad]."
)
@axis_options.plots
def command(*, data: str | None, machine_name: str | None, joint: str | None, model: str, step: float, viscous: float,
            plot: str | None, as_json: bool) -> None:  # fmt: skip
    """Find a model: of data, of a motor's row in a catalogue, or of a servo joint by experiment on its twin.

    The experiment pushes, runs at steady speeds, measures a frequency response and crosses the gap; it is refused
    where it would leave travel, speed or command, and leaves the motor off whatever happens.

    Data are a step response, a motion, a chirp or multisine (CSV), or the electronic leadscrew's log (Intel HEX).

    Example: trochia identify -m xy-table --joint X -o response.png
    """
    if (data is None) == (machine_name is None):
        raise click.UsageError("give either a file of data, or a machine with -m")
    if machine_name is not None:
        _experiment(machine_name, joint, plot, as_json=as_json)
        return
    assert data is not None, "one of both is given"
    found = identify_data.from_data(Path(data), model, step, viscous)
    if plot is not None and found.response is None:
        raise click.BadParameter("pictures are of experiments and of frequency responses", param_hint="--plot")
    _tell(data, found, plot, as_json=as_json)


def _tell(data: str, found: identify_data.FromData, plot: str | None, *, as_json: bool) -> None:
    """Tell what data say."""
    estimate, files = found.estimate, []
    if plot is not None and found.response is not None:
        rows = [] if estimate is None else [(name, str(number)) for name, number in estimate.numbers.items()]
        axis_options.write_plot(plot, data, lambda form: _response_of(found, data, form), rows)
        files = [plot]
    if as_json:
        figures = {"model": "frequency-response", "parameters": {}, "uncertainty": {}} if estimate is None else (
            estimate.figures() | {"metrics": {"rms": estimate.rms, "fit": estimate.fit}})  # fmt: skip
        options.print_json(figures | found.figures | {"files": files})
        return
    if estimate is not None:
        show(estimate)
    for name, value in found.figures.items():
        if name == "response":
            click.echo(
                f"  {len(value)} lines from {value[0]['frequency_Hz']:.4g} to {value[-1]['frequency_Hz']:.4g} Hz"
            )
        elif name == "deviations":
            for what, off in value.items():
                click.echo(
                    f"  {what.replace('_', ' ')} of the row: " + ("not given" if off is None else f"{off:+.2%} off")
                )
        else:
            click.echo(f"  {name.replace('_', ' ')}: {value}")
    for file in files:
        click.echo(f"wrote {file}")


def _response_of(found: identify_data.FromData, title: str, form: str) -> bytes:
    from trochia.analysis.identification.two_mass import plant_of  # noqa: PLC0415 - light --help
    from trochia.analysis.tuning.picture import response_picture  # noqa: PLC0415 - it loads matplotlib
    from trochia.servo.sampled import plant_response  # noqa: PLC0415

    assert found.response is not None, "asked for with one"
    model = None
    if found.estimate is not None:
        names = ("motor_inertia", "load_inertia", "stiffness", "damping", "load_share")
        plant = plant_of([found.estimate[name] for name in names], found.estimate["viscous"], found.estimate["lag"])
        model = plant_response(plant, found.response.frequency, found.response.period)
    return response_picture(found.response, title, model, form=form)


def show(found: Estimate) -> None:
    """Print an estimate."""
    click.secho(f"{found.model}: fit {found.fit:.5f} over {found.samples} samples", bold=True)
    for name, number in found.numbers.items():
        click.echo(f"  {name.replace('_', ' '):<16} {number}")


def _experiment(machine_name: str, joint: str | None, plot: str | None, *, as_json: bool) -> None:
    asked = axis_options.asked_axis(machine_name, joint)
    found = run_experiment(asked, lambda what: None if as_json else click.echo(f"  {what} …", err=True))
    title = f"{machine_name}, joint {asked.name}: position by torque"
    files: list[str] = []
    if plot is not None:
        axis_options.write_plot(plot, title, lambda form: _draw(found, title, form), _rows(found))
        files = [plot]
    if as_json:
        options.print_json(figures(found) | {"files": files})
        return
    for estimate in found.estimates:
        show(estimate)
    for file in files:
        click.echo(f"wrote {file}")


def run_experiment(asked: axis_options.AskedAxis, progress: Callable[[str], None]) -> Identified:
    """Return what the experiment finds on the twin of a joint."""
    from trochia.experiments import identify  # noqa: PLC0415 - as above

    bounds, period = asked.bounds, asked.drive.period
    way = bounds.high - bounds.low
    speed = min(asked.speed, way / 8.0)
    return identify(asked.twin(), bounds, speed=speed, reach=min(2.0, 0.02 * way),
                    band=(1.0, min(400.0, 0.3 / period)), progress=progress)  # fmt: skip


def figures(found: Identified) -> dict[str, Any]:
    """Return what ``--json`` prints."""
    numbers = {name: number for e in found.estimates for name, number in e.numbers.items()}
    return {
        "model": "two-mass" if found.train is not None else "one-mass",
        "parameters": {name: number.value for name, number in numbers.items()},
        "uncertainty": {n: number.sigma if number.sigma == number.sigma else None for n, number in numbers.items()},
        "units": {name: number.unit for name, number in numbers.items()},
        "metrics": {e.model: {"rms": e.rms, "fit": e.fit, "samples": e.samples} for e in found.estimates}
        | {"coherence_median": float(sorted(found.response.coherence)[len(found.response.coherence) // 2]),
           "distortion": found.response.distortion},
    }  # fmt: skip


def _rows(found: Identified) -> list[tuple[str, str]]:
    return [(name.replace("_", " "), str(number)) for e in found.estimates for name, number in e.numbers.items()]


def _draw(found: Identified, title: str, form: str) -> bytes:
    from trochia.analysis.tuning.picture import response_picture  # noqa: PLC0415 - it loads matplotlib
    from trochia.servo.sampled import plant_response  # noqa: PLC0415

    model = plant_response(found.plant, found.response.frequency, found.response.period) / found.plant.torque_constant
    return response_picture(found.response, title, model, form=form)
