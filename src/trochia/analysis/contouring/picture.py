"""The picture of a circle test: the deviation drawn many times its size on the circle.  Out: a PNG file."""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING

import numpy as np

from trochia.files import write_whole

if TYPE_CHECKING:
    from pathlib import Path

    from trochia.analysis.contouring.circle import CircleTest

_MOST = 20_000  #: points drawn


def circle_picture(path: Path, test: CircleTest) -> None:
    """Write the picture of a circle test."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: PLC0415 - heavy, asked for only
    from matplotlib.figure import Figure  # noqa: PLC0415

    step = max(1, len(test.angle) // _MOST)
    angle, off = test.angle[::step], 1000 * test.deviation[::step]
    reach = max(float(np.abs(off).max()), 0.1)
    figure = Figure(figsize=(7, 7), dpi=130)
    FigureCanvasAgg(figure)
    axes = figure.add_subplot(projection="polar")
    turn = np.linspace(0, math.tau, 721)
    axes.plot(turn, np.zeros_like(turn), color="#8a97a3", linewidth=1, label="as commanded")
    axes.plot(angle, off, color="#1f6fb2", linewidth=1, label="actual")
    axes.set_ylim(-3 * reach, 1.5 * reach)
    axes.set_yticks([-reach, 0.0, reach])
    axes.set_yticklabels([f"{value:.1f} µm" for value in (-reach, 0.0, reach)])
    low, high = (1000 * value for value in test.radial_deviation)
    axes.set_title(f"circle of {test.radius:.4g} mm: circular deviation {1000 * test.circular_deviation:.2f} µm,\n"
                   f"radial deviation {low:.2f} to {high:.2f} µm", fontsize=11)  # fmt: skip
    axes.legend(loc="lower right", fontsize=9)
    out = io.BytesIO()
    figure.savefig(out, format="png")
    write_whole(path, out.getvalue())
