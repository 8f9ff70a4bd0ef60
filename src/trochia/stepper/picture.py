"""A picture of what ran: position, speed and lost steps over time, as asked and as the rotor had them.

In: outputs that kept what they saw (``Kept``, or ``TwinOutput(…, keep=True)``).  Out: a PNG file, or a figure that a
notebook shows.
"""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.errors import ConfigError
from trochia.files import write_whole
from trochia.stepper.outputs import Kept, TwinOutput

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STEPS = 200  #: of a turn, where an output does not know [steps]
_MEAN = 25  # samples over which the speed that is asked for is a mean
_MEANT = "#55636f"
_ASKED, _ROTOR, _LOST = "#a9b4be", "#1d6fb8", "#c4462f"


def figure(*outputs: Kept | TwinOutput, steps_per_turn: int = STEPS) -> Figure:
    """Return a figure with a column for each output.

    Raises
    ------
    ConfigError
        Without outputs, and for a twin that kept nothing.
    """
    from matplotlib.figure import Figure  # noqa: PLC0415 - heavy, and only pictures need it

    if not outputs:
        raise ConfigError("a picture needs a motor's output", hint="Kept(), or TwinOutput(twin, keep=True).")
    made = Figure(figsize=(2.0 + 6.0 * len(outputs), 6.4), layout="constrained")
    rows = made.subplots(3, len(outputs), sharex="col", squeeze=False)
    for column, output in enumerate(outputs):
        axes = rows[:, column]
        axes[0].set_title(f"Motor {column + 1}" if len(outputs) > 1 else "What the motor did")
        if isinstance(output, Kept):
            _steps(axes, output, steps_per_turn)
        else:
            _rotor(axes, output)
        for each, label in zip(axes, ("position [degrees]", "speed [rpm]", "lost [full steps]"), strict=True):
            each.set_ylabel(label)
            each.grid(color="#e6ebef")
            each.spines[["top", "right"]].set_visible(False)
        axes[0].legend(frameon=False)
        axes[2].set_xlabel("time [s]")
    return made


def picture(path: str | Path, *outputs: Kept | TwinOutput, steps_per_turn: int = STEPS) -> Path:
    """Write the figure to a PNG file, whole or not at all, and return its path.

    Raises
    ------
    ConfigError
        As ``figure``, and when the file cannot be written.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: PLC0415 - see figure

    made = figure(*outputs, steps_per_turn=steps_per_turn)
    FigureCanvasAgg(made)
    buffer = io.BytesIO()
    made.savefig(buffer, format="png", dpi=130, metadata={"Software": "Trochia"})
    try:
        write_whole(Path(path), buffer.getvalue())
    except OSError as error:
        raise ConfigError(f"{path} cannot be written: {error.strerror}") from None
    return Path(path)


def _steps(axes: Any, output: Kept, steps_per_turn: int) -> None:  # noqa: ANN401 - an array of Axes
    """Draw what was asked, where nobody knows what a rotor made of it."""
    at, ways = np.array(output.moments), np.array(output.directions)
    axes[0].step(at, np.cumsum(ways) * 360 / steps_per_turn, where="post", color=_ASKED, label="asked")
    if at.size > 1:
        axes[1].step(at[1:], ways[1:] / np.maximum(np.diff(at), 1e-9) * 60 / steps_per_turn, color=_ASKED)
    axes[2].text(0.5, 0.5, "no twin: nobody can tell", transform=axes[2].transAxes, ha="center", color="#55636f")


def _rotor(axes: Any, output: TwinOutput) -> None:  # noqa: ANN401 - an array of Axes
    """Draw what a twin did."""
    if not output.kept:
        raise ConfigError(
            "the twin kept nothing to draw", hint="TwinOutput(twin, keep=True), and settle() after steps."
        )
    whole = {name: np.concatenate([getattr(run, name) for run in output.kept])
             for name in ("time", "theta", "omega", "position", "lost_steps")}  # fmt: skip
    time, excitation = whole["time"], output.twin.made.excitation
    asked = np.degrees(
        (excitation.first_angle + whole["position"] * excitation.step_angle) / output.twin.made.motor.teeth
    )
    axes[0].plot(time, asked, color=_ASKED, lw=3, label="asked")
    axes[0].plot(time, np.degrees(whole["theta"]), color=_ROTOR, lw=1, label="rotor")
    axes[1].plot(time, whole["omega"] * 30 / np.pi, color=_ROTOR, lw=0.8)
    if time.size > _MEAN:
        mean = (asked[_MEAN:] - asked[:-_MEAN]) / (time[_MEAN:] - time[:-_MEAN]) / 6
        axes[1].plot((time[_MEAN:] + time[:-_MEAN]) / 2, mean, color=_MEANT, lw=1.5)
    axes[2].step(time, whole["lost_steps"], where="post", color=_LOST)
    least, most = int(whole["lost_steps"].min()), int(whole["lost_steps"].max())
    axes[2].set_ylim(min(least, 0) - 4, max(most, 0) + 4)
