"""The picture of a recording, or of two on one clock.  Out: the bytes of a PNG or SVG."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.recorder import Recording

_MOST = 4000  #: points drawn of a line: the least and the greatest of each of half as many stretches
_COLOURS = ("#1f6fb2", "#c2410c", "#2f855a", "#6b46c1", "#8a97a3", "#b7791f")


def picture(one: Recording, other: Recording | None = None, *, form: str = "png") -> bytes:
    """Return what axes, speed and errors did over time; with another on the same clock, how far that is from it."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: PLC0415 - heavy, asked for only
    from matplotlib.figure import Figure  # noqa: PLC0415

    rows = [row for row in _rows(one, other) if row[2]]
    sheet = Figure(figsize=(10.0, 2.3 * len(rows) + 0.8), dpi=120, layout="constrained")
    FigureCanvasAgg(sheet)
    panels = sheet.subplots(len(rows), 1, sharex=True, squeeze=False)[:, 0]
    for panel, (title, scale, lines) in zip(panels, rows, strict=True):
        for i, (name, times, values) in enumerate(lines):
            panel.plot(times, scale * values, color=_COLOURS[i % len(_COLOURS)], linewidth=0.9, label=name)
        panel.set_ylabel(title, fontsize=9)
        panel.grid(color="#e2e8f0", linewidth=0.6)
        panel.tick_params(labelsize=8)
        panel.legend(loc="upper right", fontsize=8, ncols=3)
    panels[-1].set_xlabel("time [s]" if other is None else "time from the start of motion [s]", fontsize=9)
    what = f"{one.machine}, {one.program}" if one.program else one.machine
    sheet.suptitle(what if other is None else f"{what}: what the second does otherwise than the first", fontsize=11)
    out = io.BytesIO()
    sheet.savefig(out, format=form, metadata={"Date": None} if form == "svg" else None)
    return out.getvalue()


def _rows(one: Recording, other: Recording | None) -> list[tuple[str, float, list[tuple[str, Any, Any]]]]:
    """Return panels: title, scale, lines of (name, times, values)."""
    if other is None:
        return [
            ("commanded [mm or degree]", 1.0, _lines(one, [f"{axis}.commanded" for axis in one.axes])),
            ("speed [mm/s]", 1.0, _lines(one, ["path.speed"])),
            ("error [µm or 0.001 degree]", 1000.0, _lines(one, [f"{axis}.error" for axis in one.axes]) or _errors(one)),
            ("beam", 1.0, _lines(one, ["beam"])),
        ]
    both = [axis for axis in one.axes if f"{axis}.commanded" in other]
    return [
        ("commanded [mm or degree]", 1.0, _lines(one, [f"{axis}.commanded" for axis in both])),
        ("commanded, apart\n[µm or 0.001 degree]", 1000.0, _apart(one, other, [f"{axis}.commanded" for axis in both])),
        ("actual, apart\n[µm or 0.001 degree]", 1000.0, _apart(one, other, [f"{axis}.actual" for axis in both])),
        ("speed, apart [mm/s]", 1.0, _apart(one, other, ["path.speed"])),
    ]


def _lines(one: Recording, names: list[str]) -> list[tuple[str, Any, Any]]:
    return [(name, *_thin(one.time, one[name].astype(np.float64))) for name in names if name in one]


def _errors(one: Recording) -> list[tuple[str, Any, Any]]:
    return [(f"{axis}.actual less commanded", *_thin(one.time, one[f"{axis}.actual"] - one[f"{axis}.commanded"]))
            for axis in one.axes if f"{axis}.actual" in one]  # fmt: skip


def _apart(one: Recording, other: Recording, names: list[str]) -> list[tuple[str, Any, Any]]:
    return [(name, *_thin(one.time, other[name].astype(np.float64) - one[name]))
            for name in names if name in one and name in other]  # fmt: skip


def _thin(times: NDArray[np.float64], values: NDArray[np.float64]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return a line of fewer points that keeps every peak."""
    stretch = len(values) // (_MOST // 2)
    if stretch <= 1:
        return times, values
    count = len(values) // stretch
    cut = values[: count * stretch].reshape(count, stretch)
    first = stretch * np.arange(count)
    at = np.sort(np.stack([first + cut.argmin(axis=1), first + cut.argmax(axis=1)], axis=1), axis=1).ravel()
    return times[at], values[at]
