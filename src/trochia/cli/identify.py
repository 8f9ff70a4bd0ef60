"""``trochia identify``: a model from measured motion, or by an experiment on the twin of a machine's servo joint."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from trochia.cli import axis_options, options
from trochia.errors import RecordingError

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.analysis.identification import Estimate
    from trochia.experiments import Identified

_MODELS = ("first-order", "fopdt", "second-order", "inverse-dynamics")


@click.command()
@click.argument("data", required=False, type=click.Path(exists=True, dir_okay=False), metavar="[DATA.csv|DATA.hex]")
@axis_options.machine
@axis_options.joint
@click.option("--model", type=click.Choice(_MODELS), default="first-order", show_default=True,
              help="Of a CSV: a step response (time, value), or motion (time, position, force).")  # fmt: skip
@click.option("--step", default=1.0, show_default=True, help="Size of the step that the CSV answers to.")
@axis_options.plots
def command(*, data: str | None, machine_name: str | None, joint: str | None, model: str, step: float,
            plot: str | None, as_json: bool) -> None:  # fmt: skip
    """Find a model: of a step response, a motion, the leadscrew's log, or a servo joint by experiment on its twin.

    The experiment pushes, runs at steady speeds, measures a frequency response and crosses the gap; it is refused
    where it would leave travel, speed or command, and leaves the motor off whatever happens.

    Example: trochia identify -m xy-table --joint X -o response.png
    """
    if (data is None) == (machine_name is None):
        raise click.UsageError("give either a file of data, or a machine with -m")
    if machine_name is not None:
        _experiment(machine_name, joint, plot, as_json=as_json)
        return
    if plot is not None:
        raise click.BadParameter("pictures are of experiments: give a machine with -m", param_hint="--plot")
    assert data is not None, "one of both is given"
    found = _hex(Path(data)) if Path(data).suffix.lower() == ".hex" else _csv(Path(data), model, step)
    if as_json:
        options.print_json(found[0].figures() | {"metrics": {"rms": found[0].rms, "fit": found[0].fit}} | found[1])
    else:
        show(found[0])
        for name, value in found[1].items():
            click.echo(f"  {name.replace('_', ' ')}: {value}")


def show(found: Estimate) -> None:
    """Print an estimate."""
    click.secho(f"{found.model}: fit {found.fit:.5f} over {found.samples} samples", bold=True)
    for name, number in found.numbers.items():
        click.echo(f"  {name.replace('_', ' '):<16} {number}")


def _hex(path: Path) -> tuple[Estimate, dict[str, Any]]:
    """Return the fit of the leadscrew's log, and what is wrong with its rows."""
    from trochia.analysis.identification import read_hex  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.analysis.identification.step_log import step_log  # noqa: PLC0415

    dump = read_hex(path.read_text(encoding="utf-8", errors="replace"))
    log = step_log(dump)
    problems = [f"{path.name}:{line}: row {problem}" for line, problem in dump.problems]
    return log.pole(), {"steady_rad_s": log.steady, "repaired": len(log.repaired), "problems": problems}


def _csv(path: Path, model: str, step: float) -> tuple[Estimate, dict[str, Any]]:
    from trochia.analysis.identification import fit_step, inverse_dynamics  # noqa: PLC0415 - as above
    from trochia.analysis.identification.columns import read_columns  # noqa: PLC0415

    if model == "inverse-dynamics":
        t, position, force = read_columns(path, 3)
        return inverse_dynamics(position, force, _period(path, t)), {}
    t, y = read_columns(path, 2)
    return fit_step(t, y, step=step, model=model), {}


def _period(path: Path, t: Any) -> float:  # noqa: ANN401 - an array; numpy is imported late
    """Return the even period of times."""
    import numpy as np  # noqa: PLC0415 - as above

    steps = np.diff(t)
    period = float(np.median(steps))
    odd = np.nonzero(np.abs(steps - period) > 0.05 * period)[0]
    if len(odd):
        raise RecordingError(f"{path.name} has a gap behind row {int(odd[0]) + 1}: {steps[odd[0]]:.4g} s, "
                             f"where samples are {period:.4g} s apart",
                             hint="Record at an even rate, or cut the recording there.")  # fmt: skip
    return period


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
