"""The torque-speed plot: pull-out by closed form and as measured, pull-in, limits, and where a program works.

In: a curve, operating points.  Out: the bytes of a PNG or SVG.
"""

from __future__ import annotations

import io
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.analysis.sweep.curve import RPM

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from trochia.analysis.sweep.curve import Curve
    from trochia.analysis.sweep.points import OperatingPoints

_BLUE, _ORANGE, _GREEN, _RED = "#0072b2", "#d55e00", "#009e73", "#b3261e"
_INK, _SOFT, _FAINT = "#222222", "#666666", "#e2e2e2"
_STYLE: dict[Any, Any] = {
    "font.size": 10, "axes.edgecolor": "#999999", "axes.labelcolor": _INK, "text.color": _INK, "xtick.color": _INK,
    "ytick.color": _INK, "axes.linewidth": 0.8, "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "grid.color": _FAINT, "grid.linewidth": 0.7, "axes.axisbelow": True, "svg.hashsalt": "trochia",
}  # fmt: skip


def picture(
    made: Curve, title: str, points: OperatingPoints | None = None, *, margin: float = 0.0, form: str = "png"
) -> bytes:
    """Return the plot as ``png`` or ``svg``; ``margin`` is the part of the torque that planning leaves unused."""
    import matplotlib as mpl  # noqa: PLC0415 - takes half a second, and only a picture needs it
    from matplotlib.figure import Figure  # noqa: PLC0415 - as above

    with mpl.rc_context(_STYLE):
        sheet = Figure(figsize=(9.6, 5.4), dpi=130, layout="constrained")
        axes = sheet.subplots()
        sheet.suptitle(title, x=0.01, ha="left", fontsize=13, fontweight="bold")
        _draw_curves(axes, made, margin)
        _draw_limits(axes, made)
        if points is not None:
            _draw_points(axes, made, points)
        _dress(axes, made, points)
        out = io.BytesIO()
        sheet.savefig(out, format=form, metadata={"Date": None} if form == "svg" else None)
    return out.getvalue()


def _draw_curves(axes: Axes, made: Curve, margin: float) -> None:
    """Draw pull-out, what planning uses of it, and what was measured."""
    rpm = np.append(0.0, made.speeds) * RPM
    top = np.maximum(np.append(made.made.pull_out(np.array(0.0)), made.pull_out), 0.0)
    axes.plot(rpm, top, color=_BLUE, linewidth=2.4, label="pull-out, closed form")
    axes.fill_between(rpm, top * (1 - margin), color=_BLUE, alpha=0.10, linewidth=0)
    if margin:
        axes.plot(rpm, top * (1 - margin), color=_BLUE, linewidth=1.0, linestyle=(0, (4, 3)),
                  label=f"planned with ({margin:.0%} left unused)")  # fmt: skip
    if made.measured is not None:
        axes.plot(rpm[1:], made.measured, "o", color=_ORANGE, markersize=4.5, label="pull-out, measured on the twin")
    if made.pull_in is not None:
        axes.plot(rpm[1:], made.pull_in, color=_GREEN, linewidth=1.8, label="pull-in, measured on the twin")


def _draw_limits(axes: Axes, made: Curve) -> None:
    """Mark the corner, start/stop, the limits found, and the bands in which the motor hunts."""
    marks = {
        "corner": made.made.corner,
        "start/stop (estimate)": made.start_stop or None,
        "pull-out speed": made.limits.get("pull_out"),
        "start/stop speed": made.limits.get("start_stop"),
    }
    right = made.speeds[-1]
    for name, speed in marks.items():
        if speed is not None and speed < right:
            axes.axvline(speed * RPM, color=_SOFT, linewidth=0.9, linestyle=":")
            axes.annotate(f"{name} {speed * RPM:.0f} rpm", (speed * RPM, 0.02), xycoords=("data", "axes fraction"),
                          xytext=(-4, 0), textcoords="offset points", ha="right", va="bottom", rotation=90,
                          fontsize=8.5, color=_SOFT)  # fmt: skip
    for i, (low, high) in enumerate(made.unstable()):
        axes.axvspan(low * RPM, high * RPM, color=_RED, alpha=0.07, linewidth=0,
                     label="hunts (linear theory, this load)" if i == 0 else None)  # fmt: skip


def _draw_points(axes: Axes, made: Curve, points: OperatingPoints) -> None:
    """Draw the operating points; those above the curve in red."""
    torque = np.abs(points.torque)
    over = torque > np.interp(points.speed, made.speeds, made.pull_out)
    axes.plot(points.speed[~over] * RPM, torque[~over], ".", color=_INK, markersize=3.5, alpha=0.6,
              label="the program")  # fmt: skip
    if over.any():
        axes.plot(points.speed[over] * RPM, torque[over], "x", color=_RED, markersize=5, label="would lose steps")


def _dress(axes: Axes, made: Curve, points: OperatingPoints | None) -> None:
    """Name the axes, give steps/s on top, and let the legend stand where nothing is."""
    highest = float(made.pull_out.max())
    if points is not None and len(points.torque):
        highest = max(highest, float(np.abs(points.torque).max()))
    right = float(made.speeds[-1]) * RPM
    axes.set(xlabel="speed [rpm]", ylabel="torque [N·m]", xlim=(0, right), ylim=(0, 1.15 * highest or 1.0))
    per_rpm = made.made.motor.full_steps / 60.0
    upper = axes.secondary_xaxis(
        "top", functions=(partial(_times, factor=per_rpm), partial(_times, factor=1 / per_rpm))
    )
    upper.set_xlabel("full steps/s", color=_SOFT)
    upper.tick_params(colors=_SOFT)
    legend = axes.legend(loc="upper right", frameon=True, framealpha=0.9, edgecolor="none", fontsize=9)
    legend.set_zorder(10)


def _times(values: Any, *, factor: float) -> Any:  # noqa: ANN401 - what matplotlib hands over: a number or an array
    return np.asarray(values, np.float64) * factor
