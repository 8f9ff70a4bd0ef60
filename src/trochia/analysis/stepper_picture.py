"""Profiles as a picture: speed over time and over steps, acceleration found back from the delays, torque of the motor.

In: profiles, what each uses of its motor where there is one.  Out: the bytes of a PNG or SVG.
"""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from trochia.analysis.stepper_move import MoveUse
    from trochia.analysis.stepper_proof import Proof
    from trochia.pulses.ramps import Profile
    from trochia.pulses.ramps.verdict import Requirement

    Use = tuple[MoveUse, Proof | None]

_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#b0548a", "#b8860b", "#3a8fb7")  # told apart without red and green
_STROKES = ("-", (0, (5, 2)), (0, (1.5, 1.5)), (0, (6, 2, 1.5, 2)), (0, (3, 1)), "-")  # laws often lie on each other
_INK, _SOFT, _FAINT, _RED = "#333333", "#777777", "#dddddd", "#b3261e"
_PAPER: dict[str, Any] = {"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 1.0}  # behind a label
_POINTS = 4000  # of a line; a longer move is thinned evenly
_ROWS = {False: (8.2, [["time", "time"], ["step", "acceleration"]], (1.25, 1)),
         True: (11.4, [["time", "time"], ["step", "acceleration"], ["torque", "torque"]], (1.25, 1, 1))}  # fmt: skip
_STYLE: dict[Any, Any] = {
    "font.size": 9, "axes.edgecolor": "#999999", "axes.labelcolor": _INK, "text.color": _INK, "xtick.color": _INK,
    "ytick.color": _INK, "axes.titlesize": 10, "axes.titleweight": "bold", "axes.titlelocation": "left",
    "axes.linewidth": 0.8, "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True,
    "grid.color": _FAINT, "grid.linewidth": 0.6, "axes.axisbelow": True, "svg.hashsalt": "trochia",
}  # fmt: skip


def picture(
    profiles: Sequence[Profile],
    requirement: Requirement | None = None,
    uses: Sequence[Use] | None = None,
    *,
    title: str | None = None,
    form: str = "png",
) -> bytes:
    """Return all profiles laid over each other as ``png`` or ``svg``, with the required time as a band."""
    import matplotlib as mpl  # noqa: PLC0415 - takes half a second, and only a picture needs it
    from matplotlib.figure import Figure  # noqa: PLC0415 - as above

    demand = profiles[0].demand
    rooms: Any
    height, rooms, ratios = _ROWS[uses is not None]
    with mpl.rc_context(_STYLE):
        sheet = Figure(figsize=(9.6, height), dpi=130, layout="constrained")
        steps = sorted({profile.demand.steps for profile in profiles})
        head = f"{' and '.join(map(str, steps))} steps, up to {demand.said(demand.speed)}"
        sheet.suptitle(head if title is None else f"{title}\n{head}", x=0.01, ha="left", fontsize=12, fontweight="bold")
        panels: Any = sheet.subplot_mosaic(rooms, height_ratios=ratios)
        for index, profile in enumerate(profiles):
            look: dict[str, Any] = {"color": _COLOURS[index % len(_COLOURS)], "linewidth": 1.6,
                                    "linestyle": _STROKES[index % len(_STROKES)]}  # fmt: skip
            _draw(panels, profile, look)
            if uses is not None:
                _draw_torque(panels, profile, uses[index], look, first=index == 0)
        _dress(panels, profiles, requirement)
        if uses is not None:
            _dress_torque(panels, uses)
        out = io.BytesIO()
        sheet.savefig(out, format=form, metadata={"Date": None} if form == "svg" else None)
    return out.getvalue()


def _thin(size: int) -> np.ndarray[Any, np.dtype[np.intp]]:
    """Return the rows to draw, the last one always."""
    return np.unique(np.linspace(0, size - 1, min(size, _POINTS)).astype(np.intp))


def _draw(panels: dict[str, Axes], profile: Profile, look: dict[str, Any]) -> None:
    """Draw one profile."""
    rows = _thin(profile.delays.size)
    middles = (profile.times - 0.5 * profile.delays)[rows]
    few: dict[str, Any] = {"marker": "o", "markersize": 3} if rows.size <= 30 else {}
    panels["time"].plot(
        middles, profile.speeds[rows], label=f"{profile.title}, {profile.duration:.4g} s", **look, **few
    )
    panels["step"].plot(rows, profile.speeds[rows], **look, **few)
    if profile.delays.size > 1:
        inner = _thin(profile.delays.size - 1)
        panels["acceleration"].plot(inner + 1, profile.accelerations[inner] * profile.demand.step_angle, **look)


def _draw_torque(panels: dict[str, Axes], profile: Profile, use: Use, look: dict[str, Any], *, first: bool) -> None:
    """Draw what each step takes of the torque that is there, and where the twin lost steps."""
    asked, proof = use
    rows, panel = _thin(profile.delays.size), panels["torque"]
    there = np.maximum(asked.available, 0.0)[rows]
    panel.plot(rows, np.abs(asked.needed)[rows], label=f"asked: {profile.title}", **look)
    panel.plot(rows, there, color=_SOFT, linewidth=1.2, label="there: pull-out less frictions" if first else None)
    panel.plot(rows, (1 - asked.margin) * there, color=_SOFT, linewidth=1.0, linestyle=(0, (4, 3)),
               label=f"with {asked.margin:.0%} left unused" if first else None)  # fmt: skip
    if proof is not None:
        _draw_proof(panels, profile, proof, first=first)


def _draw_proof(panels: dict[str, Axes], profile: Profile, proof: Proof, *, first: bool) -> None:
    """Draw how fast the rotor turned on the twin, and where it lost steps."""
    rows = _thin(proof.time.size)
    panels["time"].plot(proof.time[rows], proof.rotor[rows] / profile.demand.step_angle, color=_SOFT, linewidth=0.7,
                        alpha=0.6, zorder=1, label="the rotor, on the twin" if first else None)  # fmt: skip
    if proof.step is None:
        return
    at = float(profile.times[proof.step])
    for name, place in (("torque", proof.step), ("step", proof.step), ("time", at)):
        panels[name].axvline(place, color=_RED, linewidth=1.1)
    left = at > 0.5 * profile.duration
    panels["time"].annotate(
        f"the twin loses {abs(proof.lost)} full steps from here on", (at, 0.99), xycoords=("data", "axes fraction"),
        xytext=(-4 if left else 4, 0), textcoords="offset points", va="top", ha="right" if left else "left", color=_RED,
        bbox=_PAPER,
    )  # fmt: skip


def _dress_torque(panels: dict[str, Axes], uses: Sequence[Use]) -> None:
    """Name the axes of the torque, and mark the estimate of the start/stop speed."""
    panel, use = panels["torque"], uses[0][0]
    highest = max(float(max(one.available.max(), np.abs(one.needed).max())) for one, _ in uses)
    panel.set(title="Torque asked at each step, and what is there", xlabel="step", ylabel="torque [N·m]",
              ylim=(0.0, 1.25 * highest or 1.0))  # fmt: skip
    panel.legend(loc="upper right", frameon=True, framealpha=0.9, edgecolor=_FAINT, ncols=2)
    top = panels["time"].get_ylim()[1]
    for name in ("time", "step"):
        if 0.0 < use.start_stop < top:
            _mark(panels[name], use.start_stop, "starts and stops up to here (estimate)")


def _mark(panel: Axes, speed: float, text: str) -> None:
    """Mark a speed across a panel."""
    panel.axhline(speed, color=_INK, linewidth=0.9, linestyle=":")
    panel.annotate(text, (0.02, speed), xycoords=("axes fraction", "data"), ha="left", fontsize=8, color=_SOFT,
                   xytext=(0, 3), textcoords="offset points", bbox=_PAPER)  # fmt: skip


def _dress(panels: dict[str, Axes], profiles: Sequence[Profile], requirement: Requirement | None) -> None:
    """Name axes, mark start/stop speed and required time, give rpm on the right."""
    demand = profiles[0].demand
    top = 1.15 * max(profile.peak for profile in profiles)
    for name, title, across in (("time", "Speed over time", "time [s]"), ("step", "Speed of each step", "step")):
        panel = panels[name]
        panel.set(title=title, xlabel=across, ylabel="speed [steps/s]", ylim=(0.0, top))
        if demand.start_stop is not None and demand.start_stop < top:
            _mark(panel, demand.start_stop, "start/stop")
    if requirement is not None and requirement.time is not None:
        panels["time"].axvspan(*requirement.band, color="#f0c808", alpha=0.25, linewidth=0, label="must end in here")
    turn = float(demand.steps_per_turn)

    def to_rpm(speed: float) -> float:
        return 60.0 * speed / turn

    def from_rpm(rpm: float) -> float:
        return rpm * turn / 60.0

    functions: Any = (to_rpm, from_rpm)
    right = panels["time"].secondary_yaxis("right", functions=functions)
    right.set_ylabel("speed [rpm]")
    panels["time"].set_xlim(0.0, 1.03 * max(profile.duration for profile in profiles))
    panels["time"].legend(loc="lower center", frameon=True, framealpha=0.9, edgecolor=_FAINT)
    panels["acceleration"].set(title="Acceleration found back from the delays", xlabel="step",
                               ylabel="acceleration [rad/s²]")  # fmt: skip
    panels["acceleration"].axhline(0.0, color=_INK, linewidth=0.8)
