"""The static picture of a job, for a page without a browser: the path coloured by speed, and the speed over time.

In: :class:`trochia.analysis.report.ReportData` with samples or at least a programmed path.  Out: a PNG file.
"""

from __future__ import annotations

import io
import itertools
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.analysis.report.decimate import bucket_extremes, bucket_times, simplify
from trochia.analysis.report.texts import duration, number
from trochia.files import write_whole

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from trochia.analysis.report import MotionSamples, ReportData

    Floats = NDArray[np.float64]

INK, SOFT, FAINT, GRID, RAPID = "#17212b", "#55636f", "#8a97a3", "#e6ebef", "#a9b4be"
#: Width [inch] and dots an inch: 1600 pixels across, sharp where a page shows it at 1000.
_WIDTH, _DPI = 10.0, 160
#: Height of the title, and of the speed under the path [inch].
_HEAD, _FOOT = 1.15, 2.85
_POINTS, _TIMES = 40_000, 4_000
_DOTS_WANTED = 300
#: Letters of a title beside the legend.
_TITLE = 30
#: The bright end of the map is left out: yellow does not show on white.
_MAP_END = 0.9


def path_picture(path: Path, data: ReportData) -> None:
    """Write the picture to ``path`` (PNG), whole or not at all.

    Raises
    ------
    OSError
        When the file cannot be written.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: PLC0415 - heavy, and only pictures need it
    from matplotlib.figure import Figure  # noqa: PLC0415

    columns = _plane(data)
    tall = _HEAD + _FOOT + _WIDTH * _slope(data, columns)
    figure = Figure(figsize=(_WIDTH, tall), dpi=_DPI, facecolor="white")
    FigureCanvasAgg(figure)
    _title(figure, data)
    upper = figure.add_axes((0.07, _FOOT / tall, 0.905, 1 - (_HEAD + _FOOT) / tall))
    samples = data.samples if data.samples is not None and len(data.samples.time) > 1 else None
    _draw_plane(upper, data, columns)
    if samples is not None:
        top = _top_feed(data, samples)
        _legend(figure, top)
        _draw_motion(upper, data, samples, columns, top)
        _draw_speed(figure.add_axes((0.07, 0.3 / tall, 0.905, (_FOOT - 1.25) / tall)), samples, top)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", metadata={"Software": "Trochia"})
    write_whole(path, buffer.getvalue())


def _title(figure: Figure, data: ReportData) -> None:
    facts = f"{duration(data.time.total)}  ·  {number(data.feed_length, 1)} mm of feed  ·  on {data.machine}"
    tall = figure.get_figheight()
    figure.text(0.02, 1 - 0.32 / tall, _title_text(data.name), va="center", fontsize=20, fontweight="bold", color=INK)
    figure.text(0.02, 1 - 0.66 / tall, facts, va="center", fontsize=12.5, color=SOFT)


def _title_text(name: str) -> str:
    return name if len(name) <= _TITLE else name[: _TITLE - 1] + "…"


def _slope(data: ReportData, columns: tuple[int, int]) -> float:
    """Return height over width of the plane's panel, near to that of the part."""
    extents = [data.axes[column].extent or (0.0, 1.0) for column in columns]
    across, up = (high - low for low, high in extents)
    return min(0.76, max(0.35, 1.02 * up / across)) if across > 0 else 0.76


def _plane(data: ReportData) -> tuple[int, int]:
    """Return the columns drawn across and up: X and Y where the machine has both, a lathe's Z and X."""
    names = [axis.name for axis in data.axes]
    extents = [axis.extent or (0.0, 0.0) for axis in data.axes]
    size = {name: high - low for name, (low, high) in zip(names, extents, strict=True)}
    linear = [axis.name for axis in data.axes if axis.unit == "mm"]
    if not linear:
        return 0, len(names) - 1
    pairs = [pair for pair in itertools.combinations(linear, 2) if size[pair[0]] > 0 and size[pair[1]] > 0]
    across, up = pairs[0] if pairs else (linear[0], linear[-1])
    if "Y" not in names and (across, up) == ("X", "Z"):
        across, up = up, across
    return names.index(across), names.index(up)


def _draw_plane(axes: Axes, data: ReportData, columns: tuple[int, int]) -> None:
    """Paper, names, travel, and the programmed path under all that follows."""
    _plain(axes)
    axes.set_aspect("equal", adjustable="datalim")
    style: dict[str, Any] = {"xycoords": "axes fraction", "textcoords": "offset points", "fontsize": 12, "color": SOFT}
    across, up = (data.axes[column] for column in columns)
    axes.annotate(f"{across.name} [mm]", (1, 0), (0, -38), ha="right", va="bottom", **style)
    axes.annotate(f"{up.name} [mm]", (0, 1), (-30, 4), ha="left", va="bottom", **style)
    programmed = data.programmed
    if programmed is None or len(programmed.points) < 2:
        return
    points = programmed.points[:, columns]
    steps = np.cumsum(np.linalg.norm(np.diff(points, axis=0, prepend=points[:1]), axis=1))
    kept = simplify(steps, np.column_stack((points, programmed.rapid.astype(np.float64))), _POINTS)
    rapid = programmed.rapid[kept[1:]]
    _draw_runs(axes, points[kept], ~rapid, color=FAINT, linewidth=0.7)
    if data.samples is None:
        _draw_runs(axes, points[kept], rapid, color=RAPID, linewidth=1.2, linestyle=(0, (5, 4)))
        axes.autoscale_view()


def _top_feed(data: ReportData, samples: MotionSamples) -> float:
    """Return the greatest speed outside rapids, so that rapids do not use up the colours."""
    feed = samples.speed[~data.rapid_samples()]
    return float(np.max(feed, initial=0.0) or samples.speed.max() or 1.0)


def _draw_runs(axes: Axes, points: Floats, wanted: NDArray[np.bool_], **style: Any) -> None:  # noqa: ANN401 - matplotlib's
    """Draw the segments that are ``wanted`` (one fewer than points), joined where they follow each other."""
    from matplotlib.collections import LineCollection  # noqa: PLC0415

    edges = np.diff(wanted.astype(np.int8), prepend=0, append=0)
    starts, ends = np.flatnonzero(edges > 0), np.flatnonzero(edges < 0)
    runs = [points[start : end + 1] for start, end in zip(starts, ends, strict=True)]
    axes.add_collection(LineCollection(runs, capstyle="round", joinstyle="round", **style))


def _draw_motion(axes: Axes, data: ReportData, samples: MotionSamples, columns: tuple[int, int], top: float) -> None:
    """Draw the commanded path in the colours of its speed, its rapids dashed, dots at equal times, and its ends."""
    from matplotlib.collections import LineCollection  # noqa: PLC0415

    place = samples.position[:, columns]
    size = float(np.linalg.norm(np.ptp(place, axis=0))) or 1.0
    kept = simplify(samples.time, np.column_stack((place / size, 0.05 * samples.speed / top)), _POINTS)
    points, speed, rapid = place[kept], samples.speed[kept], data.rapid_samples()[kept][1:]
    _draw_runs(axes, points, rapid, color=RAPID, linewidth=1.3, linestyle=(0, (5, 4)), zorder=2)
    segments = np.stack((points[:-1], points[1:]), axis=1)[~rapid]
    mean = 0.5 * (speed[:-1] + speed[1:])[~rapid]
    path = LineCollection(list(segments), array=mean, cmap=_speed_map(), linewidth=2.4, capstyle="round", zorder=3)
    path.set_clim(0, top)
    axes.add_collection(path)
    interval = _dot_interval(samples.time[-1] - samples.time[0])
    ticks = np.arange(samples.time[0], samples.time[-1], interval)
    dots = np.stack([np.interp(ticks, samples.time, column) for column in place.T], axis=1)
    axes.plot(dots[:, 0], dots[:, 1], "o", color=INK, markersize=2.1, markeredgewidth=0, zorder=4)
    for point, marker, name in ((place[0], "o", "start"), (place[-1], "s", "end")):
        axes.plot(*point, marker, color="white", markeredgecolor=INK, markeredgewidth=1.6, markersize=7.5, zorder=5)
        axes.annotate(name, point, (8, 6), textcoords="offset points", fontsize=11.5, fontweight="bold", color=INK,
                      zorder=6, path_effects=_halo())  # fmt: skip
    axes.autoscale_view()
    text = f"dots every {number(interval * 1000, 0)} ms" if interval < 1 else f"dots every {number(interval)} s"
    axes.text(0.995, 0.008, text, transform=axes.transAxes, ha="right", fontsize=11, color=SOFT, path_effects=_halo())


def _legend(figure: Figure, top: float) -> None:
    """Draw the ramp of speeds, named, in the head's right half."""
    from matplotlib.cm import ScalarMappable  # noqa: PLC0415
    from matplotlib.colors import Normalize  # noqa: PLC0415

    tall = figure.get_figheight()
    place = figure.add_axes((0.69, 1 - 0.4 / tall, 0.285, 0.14 / tall))
    bar = figure.colorbar(ScalarMappable(Normalize(0, top), _speed_map()), cax=place, orientation="horizontal")
    bar.outline.set_visible(False)  # pyright: ignore[reportCallIssue] - a Spine; the stubs take it for a list
    place.tick_params(colors=SOFT, length=0, labelsize=11, pad=3)
    figure.text(0.675, 1 - 0.33 / tall, "feed speed [mm/s]", ha="right", va="center", fontsize=11.5, color=SOFT)


def _draw_speed(axes: Axes, samples: MotionSamples, top: float) -> None:
    """Draw the speed along the path over time in the same colours; peaks survive."""
    from matplotlib.collections import LineCollection  # noqa: PLC0415

    time, speed = bucket_times(samples.time, _TIMES), bucket_extremes(samples.speed, _TIMES)
    points = _subdivided(np.column_stack((time, speed)))
    segments = np.stack((points[:-1], points[1:]), axis=1)
    mean = 0.5 * (points[:-1, 1] + points[1:, 1])
    curve = LineCollection(list(segments), array=mean, cmap=_speed_map(), linewidth=1.3, capstyle="round", zorder=3)
    curve.set_clim(0, top)
    high = 1.1 * float(speed.max() or 1.0)
    ramp = np.linspace(0, high, 256)[:, None]
    under = axes.fill_between(time, speed, color="none", linewidth=0)
    shade = axes.imshow(ramp, cmap=_speed_map(), vmin=0, vmax=top, alpha=0.22, aspect="auto", origin="lower",
                        extent=(time[0], time[-1], 0, high), zorder=2)  # fmt: skip
    shade.set_clip_path(under.get_paths()[0], axes.transData)
    axes.add_collection(curve)
    axes.set_xlim(samples.time[0], samples.time[-1])
    axes.set_ylim(0, high)
    _plain(axes)
    axes.spines["bottom"].set(visible=True, color=FAINT)
    axes.grid(visible=False, axis="x")
    axes.set_title("path speed [mm/s]", loc="left", fontsize=11.5, color=SOFT, pad=7)
    axes.set_title("over time [s]", loc="right", fontsize=11.5, color=SOFT, pad=7)


def _subdivided(points: Floats, pieces: int = 8) -> Floats:
    """Return a polyline (n, 2) with every segment cut in equal pieces, so that each can have its own colour."""
    parameter = np.arange(0, (len(points) - 1) * pieces + 1) / pieces
    return np.stack([np.interp(parameter, np.arange(len(points)), column) for column in points.T], axis=1)


def _plain(axes: Axes) -> None:
    """Take away frame and tick marks; leave a pale grid."""
    axes.spines[:].set_visible(False)
    axes.grid(visible=True, color=GRID, linewidth=0.8)
    axes.set_axisbelow(True)
    axes.tick_params(colors=SOFT, length=0, labelsize=11)


def _dot_interval(length: float) -> float:
    """Return the round interval [s] that gives at most some three hundred dots over ``length`` [s]."""
    rough = max(length / _DOTS_WANTED, 1e-3)
    decade = 10.0 ** np.floor(np.log10(rough))
    return float(decade * next(step for step in (1, 2, 5, 10) if step * decade >= rough * (1 - 1e-9)))


def _speed_map() -> Any:  # noqa: ANN401 - a colour map of matplotlib
    import matplotlib as mpl  # noqa: PLC0415
    from matplotlib.colors import ListedColormap  # noqa: PLC0415

    return ListedColormap(mpl.colormaps["viridis"](np.linspace(0, _MAP_END, 256)))


def _halo() -> list[Any]:
    from matplotlib.patheffects import withStroke  # noqa: PLC0415

    return [withStroke(linewidth=3, foreground="white")]
