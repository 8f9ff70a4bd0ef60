"""The picture of a study: errors over time with their turns, spectra, motor currents, the circle; and its table.

In: a recording and its study.  Out: the bytes of a PNG or SVG, or rows of a table.
"""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from trochia.analysis.contouring.circle import CircleTest
    from trochia.analysis.contouring.study import AxisStudy, Study
    from trochia.recorder import Recording

_COLOURS = ("#d55e00", "#009e73", "#0072b2", "#cc79a7", "#8a6d00", "#555555")
_STYLE: dict[Any, Any] = {
    "font.size": 10, "axes.edgecolor": "#999999", "axes.linewidth": 0.8, "axes.spines.top": False,
    "axes.spines.right": False, "axes.grid": True, "grid.color": "#e2e2e2", "axes.axisbelow": True,
    "svg.hashsalt": "trochia",
}  # fmt: skip
_MOST = 20_000  # points drawn


def study_picture(recording: Recording, found: Study, title: str, *, form: str = "png") -> bytes:
    """Return the picture."""
    import matplotlib as mpl  # noqa: PLC0415 - takes half a second, and only a picture needs it
    from matplotlib.figure import Figure  # noqa: PLC0415 - as above

    with mpl.rc_context(_STYLE):
        sheet = Figure(figsize=(11.0, 10.0), dpi=120, layout="constrained")
        sheet.suptitle(title, x=0.01, ha="left", fontsize=13, fontweight="bold")
        grid = sheet.add_gridspec(3, 2)
        error, current = sheet.add_subplot(grid[0, :]), sheet.add_subplot(grid[1, :])
        _errors(error, recording, found)
        _currents(current, recording)
        wide = grid[2, :] if found.circle is None else grid[2, 0]
        _spectra(sheet.add_subplot(wide), found)
        if found.circle is not None:
            _circle(sheet.add_subplot(grid[2, 1], projection="polar"), found.circle)
        out = io.BytesIO()
        sheet.savefig(out, format=form, metadata={"Date": None} if form == "svg" else None)
        return out.getvalue()


def _scale(unit: str) -> tuple[float, str]:
    return (1e3, "µm") if unit == "mm" else (1.0, unit)


def _errors(axes: Axes, recording: Recording, found: Study) -> None:
    step = max(1, len(recording) // _MOST)
    for colour, (name, one) in zip(_COLOURS, found.axes.items(), strict=False):
        factor, unit = _scale(one.unit)
        error = factor * (recording[f"{name}.actual"][::step] - recording[f"{name}.commanded"][::step])
        axes.plot(recording.time[::step], error, color=colour, linewidth=0.9, label=f"{name} [{unit}]")
        for turn in one.turns:
            axes.axvline(turn.time, color=colour, linewidth=0.6, linestyle=(0, (2, 3)))
    axes.set(title="following error; broken lines: an axis turns round", xlabel="time [s]")
    axes.legend(frameon=True, framealpha=0.85, edgecolor="none")


def _currents(axes: Axes, recording: Recording) -> None:
    step = max(1, len(recording) // _MOST)
    names = [c.name for c in recording.header.channels if c.name.startswith("joint.") and c.name.endswith(".current")]
    for colour, name in zip(_COLOURS, names, strict=False):
        axes.plot(recording.time[::step], recording[name][::step], color=colour, linewidth=0.7,
                  label=f"joint {name.split('.')[1]}")  # fmt: skip
    axes.set(title="motor current" if names else "no motor current was recorded", xlabel="time [s]", ylabel="A")
    if names:
        axes.legend(frameon=True, framealpha=0.85, edgecolor="none")


def _spectra(axes: Axes, found: Study) -> None:
    for colour, (name, one) in zip(_COLOURS, found.axes.items(), strict=False):
        if one.spectrum is not None:
            factor, unit = _scale(one.unit)
            axes.loglog(one.spectrum.frequency[1:], np.maximum(factor * one.spectrum.amplitude[1:], 1e-9), color=colour,
                        linewidth=0.8, label=f"{name} [{unit}]")  # fmt: skip
    axes.set(title="spectrum of the error", xlabel="frequency [Hz]")
    axes.legend(frameon=True, framealpha=0.85, edgecolor="none")


def _circle(axes: Any, test: CircleTest) -> None:  # noqa: ANN401 - polar axes have no type of their own
    step = max(1, len(test.angle) // _MOST)
    reach = max(1e3 * float(np.abs(test.deviation).max()), 0.1)
    turn = np.linspace(0, math.tau, 361)
    axes.plot(turn, np.zeros_like(turn), color="#8a97a3", linewidth=1)
    axes.plot(test.angle[::step], 1e3 * test.deviation[::step], color=_COLOURS[2], linewidth=0.9)
    axes.set_ylim(-3 * reach, 1.4 * reach)
    axes.set_yticks([-reach, 0.0, reach], [f"{v:.1f}" for v in (-reach, 0.0, reach)])
    axes.set_title(f"circle of {test.radius:.4g} mm: G {1e3 * test.circular_deviation:.2f} µm")


def study_rows(found: Study) -> list[tuple[str, str]]:
    """Return what is told of a study, name and value."""
    rows = [("contour error", f"{1e3 * found.contour.peak:.3g} µm at most, {1e3 * found.contour.rms:.3g} µm rms")]
    for name, one in found.axes.items():
        rows += [(f"{name} {what}", text) for what, text in _axis_rows(one)]
    if found.circle is not None:
        low, high = (1e3 * value for value in found.circle.radial_deviation)
        rows += [("circular deviation G", f"{1e3 * found.circle.circular_deviation:.3g} µm"),
                 ("radial deviation F", f"{low:.3g} to {high:.3g} µm")]  # fmt: skip
    return rows


def _axis_rows(one: AxisStudy) -> list[tuple[str, str]]:
    factor, unit = _scale(one.unit)
    following = f"{factor * one.following.peak:.3g} {unit} at most, {factor * one.following.rms:.3g} {unit} rms"
    rows = [("following error", following)]
    if one.spike is not None:
        line = "" if one.spike.line is None else f", line {one.spike.line}"
        where = f"at {one.spike.time:.3f} s{line}, the greatest of {len(one.turns)}"
        rows.append(("reversal spike", f"{factor * one.spike.height:+.3g} {unit} {where}"))
    if one.spread is not None:
        rows.append(("repeatability", f"±{factor * one.spread:.3g} {unit} (3 sigma), places {len(one.visits)}"))
    if one.reversal is not None:
        rows.append(("reversal error", f"{factor * one.reversal:+.3g} {unit}"))
    if one.resolution is not None:
        rows.append(("resolution", f"{factor * one.resolution:.4g} {unit}"))
    if one.spectrum is not None:
        said = [f"{factor * a:.3g} {unit} at {f:.4g} Hz" for f, a in one.spectrum.peaks(3) if factor * a >= 1e-3]
        rows += [("spectrum", ", ".join(said))] if said else []
    return rows
