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
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from trochia.analysis.sweep.curve import Curve
    from trochia.analysis.sweep.points import OperatingPoints

_BLUE, _ORANGE, _GREEN, _RED = "#0072b2", "#d55e00", "#009e73", "#b3261e"
_MORE = ("#d55e00", "#009e73", "#b0548a", "#b8860b", "#3a8fb7")  # of the curves besides
_FINE = 400  # points of a closed form
_NEAR, _LABELS = 0.03, 3  # part of the width within which labels are set one over the other, and rows of them
_INK, _SOFT, _FAINT = "#222222", "#666666", "#e2e2e2"
_STYLE: dict[Any, Any] = {
    "font.size": 10, "axes.edgecolor": "#999999", "axes.labelcolor": _INK, "text.color": _INK, "xtick.color": _INK,
    "ytick.color": _INK, "axes.linewidth": 0.8, "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "grid.color": _FAINT, "grid.linewidth": 0.7, "axes.axisbelow": True, "svg.hashsalt": "trochia",
}  # fmt: skip


def picture(
    made: Curve,
    title: str,
    points: OperatingPoints | None = None,
    *,
    margin: float = 0.0,
    others: Sequence[tuple[str, Curve]] = (),
    form: str = "png",
) -> bytes:
    """Return the plot as ``png`` or ``svg``.

    Parameters
    ----------
    margin
        Part of the torque that planning leaves unused.
    others
        Curves to be drawn besides, with what to call each; the legend then has the titles.
    """
    import matplotlib as mpl  # noqa: PLC0415 - takes half a second, and only a picture needs it
    from matplotlib.figure import Figure  # noqa: PLC0415 - as above

    with mpl.rc_context(_STYLE):
        sheet = Figure(figsize=(9.6, 5.4), dpi=130, layout="constrained")
        axes = sheet.subplots()
        head = title if not others else "Pull-out torque"
        sheet.suptitle(head, x=0.01, ha="left", fontsize=13, fontweight="bold")
        _draw_curves(axes, made, 0.0 if others else margin, title if others else None)
        for index, (name, other) in enumerate(others):
            _draw_other(axes, other, name, _MORE[index % len(_MORE)])
        if not others:
            _draw_limits(axes, made)
        if points is not None:
            _draw_points(axes, made, points)
        _dress(axes, made, points, [other for _, other in others])
        out = io.BytesIO()
        sheet.savefig(out, format=form, metadata={"Date": None} if form == "svg" else None)
    return out.getvalue()


def _closed(made: Curve) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the closed form, close enough to be drawn: speeds [rpm] and torques."""
    speeds = np.linspace(0.0, float(made.speeds[-1]), _FINE)
    return speeds * RPM, np.maximum(made.made.pull_out(speeds), 0.0)


def _draw_other(axes: Axes, made: Curve, name: str, colour: str) -> None:
    """Draw another motor, supply or driver."""
    rpm, top = _closed(made)
    axes.plot(rpm, top, color=colour, linewidth=2.0, label=name)
    if made.measured is not None:
        axes.plot(made.speeds * RPM, made.measured, "o", color=colour, markersize=4)


def _draw_curves(axes: Axes, made: Curve, margin: float, name: str | None) -> None:
    """Draw pull-out, what planning uses of it, and what was measured; ``name`` where it is one of several."""
    rpm, top = _closed(made)
    axes.plot(rpm, top, color=_BLUE, linewidth=2.4, label="pull-out, closed form" if name is None else name)
    axes.fill_between(rpm, top * (1 - margin), color=_BLUE, alpha=0.10, linewidth=0)
    if margin:
        axes.plot(rpm, top * (1 - margin), color=_BLUE, linewidth=1.0, linestyle=(0, (4, 3)),
                  label=f"planned with ({margin:.0%} left unused)")  # fmt: skip
    if made.measured is not None:
        axes.plot(made.speeds * RPM, made.measured, "o-" if name is None else "o", linewidth=0.8,
                  color=_ORANGE if name is None else _BLUE, markersize=4.5,
                  label="pull-out, measured on the twin" if name is None else "dots: measured on the twin")  # fmt: skip
    if made.pull_in is not None and name is None:
        axes.plot(made.speeds * RPM, made.pull_in, color=_GREEN, linewidth=1.8, label="pull-in, measured on the twin")


def _draw_limits(axes: Axes, made: Curve) -> None:
    """Mark the corner, start/stop, the limits found, and the bands in which the motor hunts."""
    marks = {
        "corner": made.made.corner,
        "start/stop (estimate)": made.start_stop or None,
        "pull-out speed": made.limits.get("pull_out") or None,
        "start/stop speed": made.limits.get("start_stop") or None,
    }
    right = made.speeds[-1]
    last, row = -right, 0
    for name, speed in sorted(((n, s) for n, s in marks.items() if s is not None and s < right), key=lambda m: m[1]):
        row = (row + 1) % _LABELS if speed - last < _NEAR * right else 0
        last = speed
        axes.axvline(speed * RPM, color=_SOFT, linewidth=0.9, linestyle=":")
        axes.annotate(f"{name} {speed * RPM:.0f} rpm", (speed * RPM, 0.02 + row / _LABELS),
                      xycoords=("data", "axes fraction"), xytext=(-4, 0), textcoords="offset points", ha="right",
                      va="bottom", rotation=90, fontsize=8.5, color=_SOFT,
                      bbox={"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 0.6})  # fmt: skip
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


def _dress(axes: Axes, made: Curve, points: OperatingPoints | None, others: Sequence[Curve]) -> None:
    """Name the axes, give steps/s on top, and let the legend stand where nothing is."""
    highest = max(float(_closed(one)[1].max()) for one in (made, *others))
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
