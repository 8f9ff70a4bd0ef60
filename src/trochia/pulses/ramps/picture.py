"""Profiles as a picture: speed over time, speed over steps, and the acceleration found back from the delays.

In: profiles of one move.  Out: the bytes of a PNG.
"""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from trochia.pulses.ramps.profile import Profile
    from trochia.pulses.ramps.verdict import Requirement

_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#b0548a", "#b8860b", "#3a8fb7")  # told apart without red and green
_STROKES = ("-", (0, (5, 2)), (0, (1.5, 1.5)), (0, (6, 2, 1.5, 2)), (0, (3, 1)), "-")  # laws often lie on each other
_INK, _FAINT = "#333333", "#dddddd"
_POINTS = 4000  # of a line; a longer move is thinned evenly
_STYLE: dict[Any, Any] = {
    "font.size": 9, "axes.edgecolor": "#999999", "axes.labelcolor": _INK, "text.color": _INK, "xtick.color": _INK,
    "ytick.color": _INK, "axes.titlesize": 10, "axes.titleweight": "bold", "axes.titlelocation": "left",
    "axes.linewidth": 0.8, "axes.spines.top": False, "axes.grid": True, "grid.color": _FAINT, "grid.linewidth": 0.6,
}  # fmt: skip


def picture(profiles: Sequence[Profile], requirement: Requirement | None = None) -> bytes:
    """Return a PNG with all profiles laid over each other, and the required time as a band."""
    import matplotlib as mpl  # noqa: PLC0415 - takes half a second, and only a picture needs it
    from matplotlib.figure import Figure  # noqa: PLC0415 - as above

    demand = profiles[0].demand
    with mpl.rc_context(_STYLE):
        sheet = Figure(figsize=(9.0, 7.4), dpi=110, layout="constrained")
        sheet.suptitle(f"{demand.steps} steps to {demand.said(demand.speed)}", fontsize=13, fontweight="bold")
        panels: Any = sheet.subplot_mosaic([["time", "time"], ["step", "acceleration"]], height_ratios=(1.25, 1))
        for index, profile in enumerate(profiles):
            _draw(panels, profile, _COLOURS[index % len(_COLOURS)], _STROKES[index % len(_STROKES)])
        _dress(panels, profiles, requirement)
        out = io.BytesIO()
        sheet.savefig(out, format="png")
    return out.getvalue()


def _thin(size: int) -> np.ndarray[Any, np.dtype[np.intp]]:
    """Return the rows to draw, the last one always."""
    return np.unique(np.linspace(0, size - 1, min(size, _POINTS)).astype(np.intp))


def _draw(panels: dict[str, Axes], profile: Profile, colour: str, stroke: Any) -> None:  # noqa: ANN401 - matplotlib's
    """Draw one profile."""
    rows = _thin(profile.delays.size)
    times = np.concatenate(((0.0,), profile.times))
    middles, speeds = (0.5 * (times[1:] + times[:-1]))[rows], profile.speeds[rows]
    look: dict[str, Any] = {"color": colour, "linestyle": stroke, "linewidth": 1.6}
    label = f"{profile.title}, {profile.duration:.4g} s"
    panels["time"].plot(middles, speeds, label=label, **look)
    panels["step"].plot(rows, speeds, **look)
    if profile.delays.size > 1:
        inner = _thin(profile.delays.size - 1)
        panels["acceleration"].plot(inner + 1, profile.accelerations[inner] * profile.demand.step_angle, **look)


def _dress(panels: dict[str, Axes], profiles: Sequence[Profile], requirement: Requirement | None) -> None:
    """Name axes, mark start/stop speed and required time, give rpm on the right."""
    demand = profiles[0].demand
    top = 1.12 * max(profile.peak for profile in profiles)
    for name, title, across in (("time", "Speed over time", "time [s]"), ("step", "Speed of each step", "step")):
        panel = panels[name]
        panel.set(title=title, xlabel=across, ylabel="speed [steps/s]", ylim=(0.0, top))
        if demand.start_stop is not None and demand.start_stop < top:
            panel.axhline(demand.start_stop, color=_INK, linewidth=0.9, linestyle=":")
            panel.annotate("start/stop", (0.5, demand.start_stop), xycoords=("axes fraction", "data"), ha="center",
                           xytext=(0, 3), textcoords="offset points")  # fmt: skip
    if requirement is not None:
        panels["time"].axvspan(*requirement.band, color="#f0c808", alpha=0.25, linewidth=0, label="must end in here")
    turn = float(demand.steps_per_turn)

    def to_rpm(speed: float) -> float:
        return 60.0 * speed / turn

    def from_rpm(rpm: float) -> float:
        return rpm * turn / 60.0

    functions: Any = (to_rpm, from_rpm)
    right = panels["time"].secondary_yaxis("right", functions=functions)
    right.set_ylabel("speed [rpm]")
    panels["time"].set_xlim(left=0.0)
    panels["time"].legend(loc="lower center", frameon=True, framealpha=0.9, edgecolor=_FAINT)
    panels["acceleration"].set(title="Acceleration found back from the delays", xlabel="step", ylabel="[rad/s²]")
    panels["acceleration"].axhline(0.0, color=_INK, linewidth=0.8)
