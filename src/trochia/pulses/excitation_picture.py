"""An excitation as a picture: levels and terminals over the steps, phase currents if given, and the field's way round.

In: the steps of an excitation.  Out: the bytes of a PNG or SVG.
"""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.pulses.excitation_table import LETTERS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from trochia.pulses.excitation_table import Step

    Array = NDArray[np.float64]

_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#b0548a", "#b8860b", "#3a8fb7")  # told apart without red and green
_INK, _SOFT, _FAINT = "#222222", "#666666", "#e2e2e2"
_FEW = 16  # steps a turn that are numbered, and shown over two turns
_STYLE: dict[Any, Any] = {
    "font.size": 10, "axes.edgecolor": "#999999", "axes.labelcolor": _INK, "text.color": _INK, "xtick.color": _INK,
    "ytick.color": _INK, "axes.linewidth": 0.8, "axes.spines.top": False, "axes.spines.right": False,
    "axes.axisbelow": True, "grid.color": _FAINT, "grid.linewidth": 0.7, "svg.hashsalt": "trochia",
}  # fmt: skip
_SECTORS = ("A+", "A+B+", "B+", "B+A-", "A-", "A-B-", "B-", "B-A+")


def picture(
    steps: Sequence[Step], title: str, currents: tuple[Array, Array] | None = None, *, form: str = "png"
) -> bytes:
    """Return the picture as ``png`` or ``svg``.

    Parameters
    ----------
    currents
        Where [steps] (points,) and phase currents, in parts of that at rest (points, phases), to draw over the levels.
    """
    import matplotlib as mpl  # noqa: PLC0415 - takes half a second, and only a picture needs it
    from matplotlib.figure import Figure  # noqa: PLC0415 - as above

    phases = len(steps[0].levels)
    with mpl.rc_context(_STYLE):
        sheet = Figure(figsize=(11.0, max(4.6, 1.5 + 0.55 * phases)), dpi=120, layout="constrained")
        sheet.suptitle(title, x=0.01, ha="left", fontsize=13, fontweight="bold")
        halves: Any = sheet.subfigures(1, 2, width_ratios=(1.75, 1.0))
        left, right = halves
        lanes: Any = left.subplots(phases, 1, sharex=True, squeeze=False)
        for k in range(phases):
            _draw_phase(lanes[k, 0], steps, k, currents)
        lanes[-1, 0].set_xlabel("steps")
        _draw_field(right.add_subplot(projection="polar"), steps)
        out = io.BytesIO()
        sheet.savefig(out, format=form, metadata={"Date": None} if form == "svg" else None)
    return out.getvalue()


def _draw_phase(axes: Axes, steps: Sequence[Step], k: int, currents: tuple[Array, Array] | None) -> None:
    """Draw the levels of one phase, and its current."""
    turns = 2 if len(steps) <= _FEW else 1
    count = turns * len(steps)
    levels = np.array([step.levels[k] for step in steps] * turns)
    colour, bipolar = _COLOURS[k % len(_COLOURS)], len(steps[0].levels) == 2
    axes.axhline(0.0, color="#999999", linewidth=0.8)
    axes.stairs(levels, np.arange(count + 1), baseline=0.0, fill=True, color=colour, alpha=0.14)
    axes.step(np.arange(count + 1), np.append(levels, levels[-1]), where="post", color=colour, linewidth=2.0,
              label="level")  # fmt: skip
    if currents is not None:
        at, amount = currents
        x = np.concatenate([at + turn * len(steps) for turn in range(turns)])
        axes.plot(x, np.tile(amount[:, k], turns), color=_INK, linewidth=1.5, label="current")
        if k == 0:
            axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize=9, ncols=2, borderpad=0)
    if turns == 2:
        axes.set_xticks(np.arange(count) + 0.5, [str(n % len(steps) + 1) for n in range(count)])
        axes.tick_params(axis="x", length=0)
    for edge in np.arange(0, count + 1, max(1, len(steps) // 4)):
        axes.axvline(float(edge), color=_FAINT, linewidth=0.8, zorder=0)
    highest = 1.0 if currents is None else max(1.0, float(np.abs(currents[1]).max()))
    axes.set(xlim=(0, count), ylim=((-1.18 if bipolar else -0.1) * highest, 1.18 * highest))
    name = LETTERS[k]
    if bipolar:
        axes.set_yticks([-1, 0, 1], [f"{name}-", "0", f"{name}+"])
    else:
        axes.set_yticks([0, 1], ["", name])


def _draw_field(axes: Any, steps: Sequence[Step]) -> None:  # noqa: ANN401 - matplotlib's polar axes have no own type
    """Draw where the field stands in each step, over the eight sectors of a motor of two phases."""
    longest, phases, few = max(step.length for step in steps), len(steps[0].levels), len(steps) <= _FEW
    angles, lengths = np.array([step.angle for step in steps]), np.array([step.length for step in steps])
    if few:
        for step, ahead in zip(steps, [*steps[1:], steps[0]], strict=True):
            axes.annotate(
                "",
                (ahead.angle, ahead.length),
                (step.angle, step.length),
                zorder=2,
                arrowprops={"arrowstyle": "-|>", "color": _SOFT, "linewidth": 1.0, "shrinkA": 9, "shrinkB": 9},
            )
            axes.plot(
                [step.angle, step.angle], [0, step.length], color=_COLOURS[0], linewidth=2.0, alpha=0.55, zorder=1
            )
            axes.text(
                step.angle,
                step.length,
                str(step.number),
                ha="center",
                va="center",
                fontsize=9,
                color="white",
                zorder=4,
                bbox={"boxstyle": "circle,pad=0.25", "facecolor": _COLOURS[0], "edgecolor": "white"},
            )
    else:
        axes.plot(np.append(angles, angles[0]), np.append(lengths, lengths[0]), color=_COLOURS[0], linewidth=0.9)
        axes.plot(angles, lengths, ".", color=_COLOURS[0], markersize=4)
        axes.annotate("", (angles[4], 0.8 * longest), (angles[0], 0.8 * longest), arrowprops={
            "arrowstyle": "-|>", "color": _SOFT, "connectionstyle": f"arc3,rad={0.12 * _sense(steps)}"})  # fmt: skip
    if phases == 2:
        axes.set_thetagrids(np.arange(0, 360, 45), _SECTORS)
    else:
        axes.set_thetagrids(360.0 / phases * np.arange(phases), list(LETTERS[:phases]))
    axes.set_rlim(0, 1.18 * longest)
    axes.set_rgrids([1.0, longest] if longest > 1.01 else [1.0], [])
    axes.spines["polar"].set_visible(False)
    axes.set_title("where the field stands, and holds", fontsize=10, color=_SOFT, pad=14)


def _sense(steps: Sequence[Step]) -> int:
    """Return 1 where the field turns forwards, -1 where it turns back."""
    return 1 if math.sin(steps[1].angle - steps[0].angle) > 0 else -1
