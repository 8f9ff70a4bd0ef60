"""The comparison as a picture: true curve and step paths, deviation along the way, pulse trains.

In: a figure and methods.  Out: the bytes of a PNG.  A small figure is drawn whole; of a large one the step paths and
pulses are those about one place, the same for all methods: where the first one deviates most.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.pulses.interpolators import positions
from trochia.pulses.interpolators.compare import deviations, start_of, way_along
from trochia.pulses.interpolators.frame import Arc, Figure
from trochia.pulses.port import PortBit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from trochia.pulses.interpolators import Interpolator

_REACH = 9.0  # steps each way from the middle of a step path's panel
_TRAIN = 64  # ticks of the pulse trains
_PIXELS = 1000  # points across a deviation panel; more are drawn as their envelope
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#b0548a", "#b8860b", "#3a8fb7")  # told apart without red and green
_INK, _FAINT = "#333333", "#dddddd"
_STYLE: dict[Any, Any] = {
    "font.size": 9, "axes.edgecolor": "#999999", "axes.labelcolor": _INK, "text.color": _INK,
    "xtick.color": _INK, "ytick.color": _INK, "axes.titlesize": 10, "axes.titleweight": "bold", "axes.linewidth": 0.8,
}  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class _Track:
    """What one method makes of the figure, and how it is drawn."""

    title: str
    colour: str
    pulses: NDArray[np.uint8]
    points: NDArray[np.int64]
    way: NDArray[np.float64]
    away: NDArray[np.float64]


def picture(figure: Figure, methods: Sequence[Interpolator], title: str) -> bytes:
    """Return a PNG: a column of step paths a method, and strips of deviations and of pulses below."""
    import matplotlib as mpl  # noqa: PLC0415 - takes half a second, and only a picture needs it
    from matplotlib.figure import Figure as Sheet  # noqa: PLC0415 - as above

    tracks = [_track(figure, method, colour) for method, colour in zip(methods, _COLOURS, strict=False)]
    count = len(tracks)
    heights = (3.3, 0.7 + 0.75 * count, 0.7 + 0.5 * count)
    with mpl.rc_context(_STYLE):
        sheet = Sheet(figsize=(max(7.5, 2.9 * count), 0.4 + sum(heights)), dpi=110, layout="constrained")
        sheet.suptitle(title, fontsize=13, fontweight="bold")
        rows: Any = sheet.subfigures(3, 1, height_ratios=heights)
        _draw_paths(rows[0].subplots(1, count, squeeze=False, sharex=True, sharey=True)[0], figure, tracks)
        _draw_deviations(rows[1].subplots(count, 1, squeeze=False, sharex=True, sharey=True)[:, 0], figure, tracks)
        _draw_trains(rows[2].subplots(), tracks)
        out = io.BytesIO()
        sheet.savefig(out, format="png")
    return out.getvalue()


def _track(figure: Figure, method: Interpolator, colour: str) -> _Track:
    """Return a method's pulses with the points they lead through."""
    pulses = method.pulses(figure)
    points = positions(pulses, start_of(figure))
    return _Track(title=method.title, colour=colour, pulses=pulses, points=points, way=way_along(figure, points),
                  away=deviations(figure, points))  # fmt: skip


def _true_curve(figure: Figure, points: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return points of the true curve along a step path (n, 2) [steps]."""
    if isinstance(figure, Arc):
        angles = np.unwrap(np.arctan2(points[:, 1], points[:, 0]))
        swept = np.linspace(angles[0], angles[-1], 20_000)
        return figure.radius * np.stack((np.cos(swept), np.sin(swept)), axis=-1)
    return np.array([[0.0, 0.0], [figure.x, figure.y]])


def _view(track: _Track) -> tuple[NDArray[np.float64], float]:
    """Return middle and half width of the step paths' panels [steps]."""
    low, high = track.points.min(axis=0), track.points.max(axis=0)
    reach = float((high - low).max()) / 2 + 1.0
    if reach <= 1.5 * _REACH:
        return (low + high) / 2, reach
    return track.points[int(np.abs(track.away).argmax())].astype(np.float64), _REACH


def _draw_paths(panels: Sequence[Axes], figure: Figure, tracks: Sequence[_Track]) -> None:
    """Draw each method's steps over the true curve, and where in the figure that is."""
    curve = _true_curve(figure, tracks[0].points)
    middle, reach = _view(tracks[0])
    whole = float((tracks[0].points.max(axis=0) - tracks[0].points.min(axis=0)).max()) <= 2 * reach
    for panel, track in zip(panels, tracks, strict=True):
        near = np.abs(track.points - middle).max(axis=1) <= reach + 2
        shown = np.where(near[:, None], track.points, np.nan)
        panel.plot(*curve.T, color=_INK, linewidth=1.2)
        panel.plot(*shown.T, color=track.colour, linewidth=1.6, marker="o", markersize=3.2)
        panel.set(xlim=(middle[0] - reach, middle[0] + reach), ylim=(middle[1] - reach, middle[1] + reach))
        panel.set_aspect("equal")
        panel.set_title(track.title, color=track.colour)
        panel.locator_params(nbins=5, steps=[1, 2, 5, 10], min_n_ticks=2)
        panel.grid(visible=True, color=_FAINT, linewidth=0.6)
        panel.set_xlabel("X [steps]")
    panels[0].set_ylabel("Y [steps]")
    if not whole:
        _draw_place(panels[0], curve, middle)


def _draw_place(panel: Axes, curve: NDArray[np.float64], middle: NDArray[np.float64]) -> None:
    """Draw the whole figure small in a corner away from the curve, with a dot where the panels look."""
    inside = curve - middle
    inside = inside[np.abs(inside).max(axis=1) <= _REACH]
    corners = np.array([[-1, -1], [1, -1], [-1, 1], [1, 1]]) * 0.65 * _REACH
    free = [np.hypot(*(inside - corner).T).min(initial=np.inf) for corner in corners]
    x, y = (0.03 + 0.62 * (side > 0) for side in corners[int(np.argmax(free))])
    small = panel.inset_axes((x, y, 0.32, 0.32))
    small.plot(*curve.T, color=_INK, linewidth=0.9)
    small.plot(*middle, color=_COLOURS[1], marker="o", markersize=4)
    small.set_aspect("equal")
    small.set(xticks=[], yticks=[])
    small.margins(0.15)


def _draw_deviations(panels: Sequence[Axes], figure: Figure, tracks: Sequence[_Track]) -> None:
    """Draw how far from the curve the axes stand along the way, a strip a method; a long one by its envelope."""
    for panel, track in zip(panels, tracks, strict=True):
        if track.way.size <= _PIXELS:
            panel.plot(track.way, track.away, color=track.colour, linewidth=1.0)
            panel.fill_between(track.way, 0, track.away, color=track.colour, alpha=0.35, linewidth=0)
        else:
            cuts = np.linspace(0, track.way.size, _PIXELS, endpoint=False).astype(int)
            low, high = np.minimum.reduceat(track.away, cuts), np.maximum.reduceat(track.away, cuts)
            panel.fill_between(track.way[cuts], low, high, color=track.colour, alpha=0.6, linewidth=0.5)
        panel.axhline(0, color=_INK, linewidth=0.8)
        panel.margins(x=0)
        panel.grid(visible=True, axis="y", color=_FAINT, linewidth=0.6)
        panel.text(1.006, 0.5, f"{track.title}\ngreatest {np.abs(track.away).max():.2f}", color=track.colour,
                   transform=panel.transAxes, va="center")  # fmt: skip
        for side in ("top", "right", "bottom"):
            panel.spines[side].set_visible(False)
        panel.tick_params(axis="x", length=0)
    side = "outside" if isinstance(figure, Arc) else "left of it"
    panels[0].set_title(f"Deviation from the true curve [steps], + {side}", loc="left")
    panels[-1].set_xlabel("way along the curve [steps]")


def _draw_trains(panel: Axes, tracks: Sequence[_Track]) -> None:
    """Draw both axes' pulses, two rows a method."""
    longest = max(track.pulses.size for track in tracks)
    middle = _view(tracks[0])[0]
    for row, track in enumerate(tracks):
        nearest = int(np.hypot(*(track.points - middle).T).argmin())
        first = 0 if longest <= _TRAIN else min(max(nearest - _TRAIN // 2, 0), max(track.pulses.size - _TRAIN, 0))
        shown = track.pulses[first : first + _TRAIN]
        for line, bit in enumerate((PortBit.X_CLOCK, PortBit.Y_CLOCK)):
            base = -(2.7 * row + 1.15 * line)
            ticks = np.flatnonzero(shown & bit) + 1
            panel.bar(ticks, 0.85, 0.5, base, color=track.colour, linewidth=0)
            panel.hlines(base, 0.5, min(longest, _TRAIN) + 0.5, color=_FAINT, linewidth=0.8, zorder=0)
        panel.text(1.006, -(2.7 * row + 0.2), track.title, color=track.colour, va="center",
                   transform=panel.get_yaxis_transform())  # fmt: skip
    places = [-(2.7 * row + 1.15 * line) + 0.4 for row in range(len(tracks)) for line in range(2)]
    panel.set_yticks(places, ["X", "Y"] * len(tracks))
    panel.tick_params(axis="y", length=0)
    panel.set_xlim(0.3, min(longest, _TRAIN) + 0.7)
    panel.set_title("Pulse trains" if longest <= _TRAIN else "Pulse trains about the place above", loc="left")
    panel.set_xlabel("ticks")
    panel.locator_params(axis="x", integer=True)
    for side in ("top", "right", "left"):
        panel.spines[side].set_visible(False)
