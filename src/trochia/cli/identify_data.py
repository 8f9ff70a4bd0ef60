"""What ``trochia identify`` makes of data: steps, motions, frequency responses, the leadscrew's log, catalogue rows.

In: a file and a model.  Out: an estimate, further figures, and the frequency response where it is one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from trochia.errors import RecordingError

if TYPE_CHECKING:
    from pathlib import Path

    from trochia.analysis.identification import Estimate
    from trochia.analysis.identification.response import FrequencyResponse

_LINES = 400  # of a fit
RESPONSES = ("frequency-response", "two-mass")
MODELS = ("first-order", "fopdt", "second-order", "inverse-dynamics", *RESPONSES)


class FromData(NamedTuple):
    """What was found."""

    estimate: Estimate | None
    figures: dict[str, Any]
    response: FrequencyResponse | None = None


def from_data(path: Path, model: str, step: float, viscous: float) -> FromData:
    """Return what a file of data tells."""
    suffix = path.suffix.lower()
    if suffix == ".hex":
        return _hex(path)
    if suffix == ".toml":
        return _row(path)
    return _response(path, model, viscous) if model in RESPONSES else _csv(path, model, step)


def _hex(path: Path) -> FromData:
    """Return the fit of the leadscrew's log, and what is wrong with its rows."""
    from trochia.analysis.identification import read_hex  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.analysis.identification.step_log import step_log  # noqa: PLC0415

    dump = read_hex(path.read_text(encoding="utf-8", errors="replace"))
    log = step_log(dump)
    problems = [f"{path.name}:{line}: row {problem}" for line, problem in dump.problems]
    return FromData(log.pole(), {"steady_rad_s": log.steady, "repaired": len(log.repaired), "problems": problems})


def _row(path: Path) -> FromData:
    """Return the constants of a catalogue's row, and how far it disagrees with itself."""
    from trochia.analysis.identification.motor_row import read_row  # noqa: PLC0415 - as above

    row = read_row(path.read_text(encoding="utf-8", errors="replace"), path.name)
    return FromData(row.estimate(), {"deviations": row.deviations(), "source": row.source})


def _csv(path: Path, model: str, step: float) -> FromData:
    from trochia.analysis.identification import fit_step, inverse_dynamics  # noqa: PLC0415 - as above
    from trochia.analysis.identification.columns import read_columns  # noqa: PLC0415

    if model == "inverse-dynamics":
        t, position, force = read_columns(path, 3)
        return FromData(inverse_dynamics(position, force, _period(path, t)), {})
    t, y = read_columns(path, 2)
    return FromData(fit_step(t, y, step=step, model=model), {})


def _response(path: Path, model: str, viscous: float) -> FromData:
    """Return the response of output by input, with its coherence, and two masses fitted to it."""
    from trochia.analysis.identification.columns import read_columns  # noqa: PLC0415 - as above
    from trochia.analysis.identification.response import of_spectra  # noqa: PLC0415
    from trochia.analysis.identification.two_mass import two_mass  # noqa: PLC0415

    with path.open(encoding="utf-8-sig", errors="replace") as file:
        columns = 4 if file.readline().count(",") >= 3 else 3
    t, u, y, *injected = read_columns(path, columns)
    found = of_spectra(u, y, _period(path, t), excitation=injected[0] if injected else None)
    told = found.trusted(0.5)
    figures: dict[str, Any] = {
        "response": [
            {"frequency_Hz": float(f), "magnitude": float(abs(g)), "phase_deg": _degrees(g), "coherence": float(c)}
            for f, g, c in zip(found.frequency, found.value, found.coherence, strict=True)
        ],
        "coherence_median": float(sorted(found.coherence)[len(found.coherence) // 2]), "lines_trusted": len(told.value),
    }  # fmt: skip
    return FromData(two_mass(_thinned(found), viscous=viscous) if model == "two-mass" else None, figures, found)


def _thinned(found: FrequencyResponse) -> FrequencyResponse:
    """Return lines that are even by ratio: windows of one length give most of theirs to the highest decade."""
    from dataclasses import replace  # noqa: PLC0415 - as above

    import numpy as np  # noqa: PLC0415

    spaced = np.geomspace(1.0, len(found.frequency), _LINES)
    kept = np.unique(np.rint(spaced).astype(np.int64)) - 1
    return replace(found, frequency=found.frequency[kept], value=found.value[kept], coherence=found.coherence[kept])


def _degrees(value: complex) -> float:
    import cmath  # noqa: PLC0415 - of this one line
    import math  # noqa: PLC0415

    return math.degrees(cmath.phase(value))


def _period(path: Path, t: Any) -> float:  # noqa: ANN401 - an array; numpy is imported late
    """Return the even period of times."""
    import numpy as np  # noqa: PLC0415 - as above

    steps = np.diff(t)
    if not len(steps) or not float(np.median(steps)) > 0.0:
        raise RecordingError(f"{path.name}: its times do not rise", hint="The first column is the time [s].")
    period = float(np.median(steps))
    odd = np.nonzero(np.abs(steps - period) > 0.05 * period)[0]
    if len(odd):
        raise RecordingError(f"{path.name} has a gap behind row {int(odd[0]) + 1}: {steps[odd[0]]:.4g} s, "
                             f"where samples are {period:.4g} s apart",
                             hint="Record at an even rate, or cut the recording there.")  # fmt: skip
    return period
