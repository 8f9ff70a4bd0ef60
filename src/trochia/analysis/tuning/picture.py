"""Pictures of a frequency response and of a loop before and after tuning.

In: responses, judged loops.  Out: the bytes of a PNG or SVG.
"""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.servo.sampled import open_loop

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from trochia.analysis.identification.response import FrequencyResponse
    from trochia.analysis.tuning.moves import Judged
    from trochia.analysis.tuning.trial import Trial
    from trochia.machine.servo_plant import ServoPlant
    from trochia.servo.axis import Loop

    Array = NDArray[np.float64]

_BLUE, _ORANGE, _GREEN, _RED = "#0072b2", "#d55e00", "#009e73", "#b3261e"
_INK, _SOFT, _FAINT = "#222222", "#666666", "#e2e2e2"
_STYLE: dict[Any, Any] = {
    "font.size": 10, "axes.edgecolor": "#999999", "axes.labelcolor": _INK, "text.color": _INK, "xtick.color": _INK,
    "ytick.color": _INK, "axes.linewidth": 0.8, "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "grid.color": _FAINT, "grid.linewidth": 0.7, "axes.axisbelow": True, "svg.hashsalt": "trochia",
}  # fmt: skip


def response_picture(
    measured: FrequencyResponse, title: str, model: NDArray[np.complex128] | None = None, *, form: str = "png"
) -> bytes:
    """Return magnitude, phase and coherence of a response, with a model's over it (lines,)."""
    import matplotlib as mpl  # noqa: PLC0415 - takes half a second, and only a picture needs it
    from matplotlib.figure import Figure  # noqa: PLC0415 - as above

    with mpl.rc_context(_STYLE):
        sheet = Figure(figsize=(9.6, 7.2), dpi=130, layout="constrained")
        size, phase, coherence = sheet.subplots(3, 1, sharex=True, height_ratios=[3, 2, 1])
        sheet.suptitle(title, x=0.01, ha="left", fontsize=13, fontweight="bold")
        f = measured.frequency
        size.loglog(f, np.abs(measured.value), ".", color=_ORANGE, markersize=4, label="measured")
        phase.semilogx(f, _phase(measured.value), ".", color=_ORANGE, markersize=4)
        if model is not None:
            size.loglog(f, np.abs(model), color=_BLUE, linewidth=1.6, label="model")
            phase.semilogx(f, _phase(model), color=_BLUE, linewidth=1.6)
        coherence.semilogx(f, measured.coherence, color=_GREEN, linewidth=1.2)
        size.set(ylabel="position by torque [rad/N·m]")
        phase.set(ylabel="phase [°]", yticks=[-360, -270, -180, -90, 0], ylim=(-370, 10))
        coherence.set(ylabel="coherence", xlabel="frequency [Hz]", ylim=(0, 1.05))
        size.legend(frameon=False)
        return _bytes(sheet, form)


def _phase(value: NDArray[np.complex128]) -> Array:
    """Return phases in -360 to 0 degrees, those near 0 beside 0."""
    degrees = np.degrees(np.angle(value))
    return np.where(degrees > 10.0, degrees - 360.0, degrees)


def tuning_picture(
    plant: ServoPlant, after: Judged, title: str, before: Judged | None = None, *, form: str = "png"
) -> bytes:
    """Return step, following error, motor current, Bode and Nyquist plots, before and after."""
    import matplotlib as mpl  # noqa: PLC0415 - as above
    from matplotlib.figure import Figure  # noqa: PLC0415 - as above

    with mpl.rc_context(_STYLE):
        sheet = Figure(figsize=(11.0, 10.0), dpi=130, layout="constrained")
        (step, nyquist), (move, bode), (current, phase) = sheet.subplots(3, 2, height_ratios=[5, 4, 3])
        sheet.suptitle(title, x=0.01, ha="left", fontsize=13, fontweight="bold")
        for judged, colour, name in ((before, _SOFT, "before"), (after, _BLUE, "after")):
            if judged is not None:
                _draw(plant, judged, (step, move, bode, nyquist), colour, name)
                current.plot(judged.move_time * 1e3, judged.move_current, color=colour, linewidth=0.9, label=name)
                f, whole = _opened(plant, judged.loop)
                degrees = _phase(whole)
                degrees[1:][np.abs(np.diff(degrees)) > 180.0] = np.nan  # no line from one edge to the other
                phase.semilogx(f, degrees, color=colour, linewidth=1.4, label=name)
        current.set(title="motor current of that move", xlabel="time [ms]", ylabel="A")
        phase.set(title="phase of the loop", xlabel="frequency [Hz]", ylabel="°", yticks=[-360, -270, -180, -90, 0],
                  ylim=(-370, 10))  # fmt: skip
        phase.axhline(-180.0, color=_INK, linewidth=0.8)
        _dress(step, move, bode, nyquist, after)
        return _bytes(sheet, form)


def trial_picture(seen: Trial, title: str, unit: str, *, form: str = "png") -> bytes:
    """Return position, error, command and current of a move over time."""
    import matplotlib as mpl  # noqa: PLC0415 - as above
    from matplotlib.figure import Figure  # noqa: PLC0415 - as above

    with mpl.rc_context(_STYLE):
        sheet = Figure(figsize=(11.0, 7.6), dpi=130, layout="constrained")
        (place, command), (error, current) = sheet.subplots(2, 2, sharex=True)
        sheet.suptitle(title, x=0.01, ha="left", fontsize=13, fontweight="bold")
        t = seen.time * 1e3
        place.plot(t, seen.wanted[:, 0], color=_SOFT, linewidth=1.2, linestyle=(0, (4, 2)), label="wanted")
        place.plot(t, seen.measured, color=_BLUE, linewidth=1.8, label="measured")
        place.legend(frameon=False)
        error.plot(t, (seen.wanted[:, 0] - seen.measured) * 1e3, color=_ORANGE, linewidth=1.2)
        command.plot(t, seen.command, color=_GREEN, linewidth=1.0)
        current.plot(t, seen.current, color=_RED, linewidth=1.0)
        place.set(title="position", ylabel=unit)
        error.set(title="error", ylabel=f"0.001 {unit}", xlabel="time [ms]")
        command.set(title="command", ylabel="V")
        current.set(title="motor current", ylabel="A", xlabel="time [ms]")
        return _bytes(sheet, form)


def _draw(plant: ServoPlant, judged: Judged, axes: tuple[Axes, ...], colour: str, name: str) -> None:
    step, move, bode, nyquist = axes
    figures, margins = judged.step, judged.margins
    settles = f"{figures.settling * 1e3:.0f} ms" if math.isfinite(figures.settling) else "not"
    step.plot(judged.step_time * 1e3, judged.step_response, color=colour, linewidth=1.8,
              label=f"{name}: settles {settles}, overshoot {figures.overshoot:.1%}")  # fmt: skip
    move.plot(judged.move_time * 1e3, judged.move_error * 1e3, color=colour, linewidth=1.4,
              label=f"{name}: {judged.following.peak * 1e3:.3g} mrad at most")  # fmt: skip
    f, whole = _opened(plant, judged.loop)
    bode.loglog(f, np.abs(whole), color=colour, linewidth=1.6, label=f"{name}: |L|")
    bode.loglog(f, np.abs(1.0 / (1.0 + whole)), color=colour, linewidth=1.1, linestyle=(0, (4, 2)),
                label=f"{name}: |S|, Ms {margins.ms:.2f}")  # fmt: skip
    nyquist.plot(whole.real, whole.imag, color=colour, linewidth=1.6,
                 label=f"{name}: GM {margins.gm:.2g}, PM {margins.pm_deg:.0f}°")  # fmt: skip


def _opened(plant: ServoPlant, loop: Loop) -> tuple[Array, NDArray[np.complex128]]:
    """Return frequencies [Hz], and the loop cut open there."""
    top = 0.499 / loop.period
    f = np.geomspace(top * 1e-3, top, 1500)
    return f, open_loop(plant, loop, f)


def _dress(step: Axes, move: Axes, bode: Axes, nyquist: Axes, after: Judged) -> None:
    last = after.step.settling if math.isfinite(after.step.settling) else float(after.step_time[-1])
    step.set(title="step", xlabel="time [ms]", ylabel="position [rad]",
             xlim=(0, 1e3 * min(float(after.step_time[-1]), 6.0 * last)))  # fmt: skip
    move.set(title="following error of a parabolic move", xlabel="time [ms]", ylabel="error [mrad]")
    bode.set(title="loop and sensitivity", xlabel="frequency [Hz]", ylim=(1e-3, 1e3))
    bode.axhline(1.0, color=_INK, linewidth=0.8)
    turn = np.linspace(0.0, 2.0 * math.pi, 200)
    radius = 1.0 / after.margins.ms
    nyquist.plot(radius * np.cos(turn) - 1.0, radius * np.sin(turn), color=_RED, linewidth=0.9, linestyle=":",
                 label=f"1/Ms = {radius:.2f} around -1")  # fmt: skip
    nyquist.plot([-1.0], [0.0], "+", color=_RED, markersize=9)
    nyquist.set(title="Nyquist", xlabel="real", ylabel="imaginary", xlim=(-3.2, 1.2), ylim=(-2.4, 1.6), aspect="equal")
    for axes in (step, move, bode, nyquist):
        axes.legend(frameon=True, framealpha=0.85, edgecolor="none", fontsize=8.5)


def _bytes(sheet: Figure, form: str) -> bytes:
    out = io.BytesIO()
    sheet.savefig(out, format=form, metadata={"Date": None} if form == "svg" else None)
    return out.getvalue()
