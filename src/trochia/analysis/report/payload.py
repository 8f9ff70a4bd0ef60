"""What the report's page draws from: one JSON object, arrays as little-endian bytes in base64, bounded in size.

In: :class:`ReportData` of any length.  Out: a dictionary for :func:`json.dumps`; ``data.js`` reads it back.
"""

from __future__ import annotations

import base64
import itertools
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.analysis.report.decimate import bucket_extremes, bucket_times, simplify
from trochia.analysis.report.deviation import deviation

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from trochia.analysis.report.data import MotionSamples, ProgrammedPath, ReportData
    from trochia.analysis.report.reasons import Reasons

    Payload = dict[str, Any]

#: Changes when a field changes its meaning; ``data.js`` refuses another.
FORMAT = 1
PROGRAMMED_POINTS = 25_000
PATH_POINTS = 30_000
SAMPLES = 20_000
#: Four-byte numbers that path and channels may each take together; many axes get fewer points (1.9 MB in base64).
_NUMBERS = 350_000
#: Characters of source text that are embedded; lines beyond show their number only.
_TEXT_BUDGET = 400_000
_TEXT_WIDTH = 100


def payload(data: ReportData, keep_lines: Iterable[int] = ()) -> Payload:
    """Return everything the page draws; ``keep_lines`` are source lines whose text must be there."""
    programmed, samples = data.programmed, data.samples
    corners = None if programmed is None else _choose_corners(programmed)
    instants = None if samples is None else _choose_instants(samples)
    shown = [part.line[kept] for part, kept in ((programmed, corners), (samples, instants)) if part is not None]
    why = data.reasons
    return {
        "format": FORMAT,
        "axes": [
            {"name": axis.name, "unit": axis.unit, "travel": list(axis.travel), "velocity": axis.velocity,
             "acceleration": axis.acceleration} for axis in data.axes
        ],
        "caps": {"velocity": data.path_velocity, "acceleration": data.path_acceleration},
        "programmed": None if programmed is None or corners is None else _programmed(programmed, corners),
        "path": None if samples is None or instants is None else _path(samples, data.rapid_samples(), instants, why),
        "limits": None if why is None else [{"text": text, "group": group} for text, group in why.labels],
        "channels": None if samples is None else _channels(samples),
        "lines": _texts(data, shown, keep_lines),
    }  # fmt: skip


def pack(values: NDArray[Any], kind: str) -> Payload:
    """Return an array as ``{"type", "data"}``; ``kind`` is a numpy type of known size, like ``"f4"``."""
    raw = np.ascontiguousarray(values, dtype=f"<{kind}").tobytes()
    return {"type": kind, "data": base64.b64encode(raw).decode("ascii")}


def _columns(table: NDArray[np.float64]) -> list[Payload]:
    return [pack(column, "f4") for column in table.T]


def _choose_corners(path: ProgrammedPath) -> NDArray[np.int64]:
    """Return the points of the programmed path that are drawn."""
    points = path.points
    steps = np.linalg.norm(np.diff(points, axis=0, prepend=points[:1]), axis=1)
    # a change between feed and rapid counts as a step of a thousandth of the part, so that it outlives flat points
    features: NDArray[Any] = np.column_stack((points / _size(points), 1e-3 * path.rapid))
    return simplify(np.cumsum(steps), features, PROGRAMMED_POINTS)


def _programmed(path: ProgrammedPath, kept: NDArray[np.int64]) -> Payload:
    return {
        "position": _columns(path.points[kept]),
        "line": pack(path.line[kept], "i4"),
        "rapid": pack(path.rapid[kept], "u1"),
    }


def _choose_instants(samples: MotionSamples) -> NDArray[np.int64]:
    """Return the samples that draw the path: commanded and actual in the right place, in the right colour."""
    error, size = samples.following_error, _size(samples.position)
    top = np.max(samples.speed, initial=0.0) or 1.0
    # colour may be wrong by twenty times what place may be: both show, but place matters more
    features: list[NDArray[Any]] = [samples.position / size, 0.05 * samples.speed[:, None] / top]
    if error is not None:
        features.append(error / size)
    width = samples.position.shape[1] * (1 if error is None else 3) + 5
    return simplify(samples.time, np.concatenate(features, axis=1), min(PATH_POINTS, _NUMBERS // width))


def _path(samples: MotionSamples, rapid: NDArray[np.bool_], kept: NDArray[np.int64], why: Reasons | None) -> Payload:
    """Return the path at the instants ``kept``: position, errors, speed, line, rapid or not, and what binds."""
    error = samples.following_error
    return {
        "time": pack(samples.time[kept], "f8"),
        "position": _columns(samples.position[kept]),
        "error": None if error is None else _columns(-error[kept]),
        "deviation": None if samples.actual is None else _columns(deviation(samples.position, samples.actual, kept)),
        "speed": pack(samples.speed[kept], "f4"),
        "line": pack(samples.line[kept], "i4"),
        "rapid": pack(rapid[kept], "u1"),
        "limit": None if why is None else pack(why.sample[kept], "u1"),
        "of": len(samples.time),
    }


def _channels(samples: MotionSamples) -> Payload:
    """Return every plotted quantity over a common time, peaks kept."""
    error, contour = samples.following_error, samples.contour_error
    tables = {"position": samples.position, "velocity": samples.velocity, "acceleration": samples.acceleration}
    if error is not None:
        tables["following"] = error
    width = (
        sum(table.shape[1] for table in tables.values()) + 4 + len(samples.load_joints) + len(samples.current_joints)
    )
    limit = min(SAMPLES, _NUMBERS // width)

    def column(values: NDArray[np.float64]) -> Payload:
        return pack(bucket_extremes(values, limit), "f4")

    packed: Payload = {name: [column(values) for values in table.T] for name, table in tables.items()}
    packed["speed"] = column(samples.speed)
    packed["contour"] = None if contour is None else column(contour)
    for key, joints, table in (("load", samples.load_joints, samples.load_angle),
                               ("current", samples.current_joints, samples.current)):  # fmt: skip
        packed[key] = None if table is None else [
            {"name": name, "axis": axis, "values": column(values)}
            for (name, axis), values in zip(joints, table.T, strict=True)
        ]  # fmt: skip
    packed["time"] = pack(bucket_times(samples.time, limit), "f8")
    return packed


def _size(points: NDArray[np.float64]) -> float:
    """Return the diagonal of the points' box, or 1 where there is none."""
    return float(np.linalg.norm(np.ptp(points, axis=0))) or 1.0 if len(points) else 1.0


def _texts(data: ReportData, shown: list[NDArray[np.int64]], keep: Iterable[int]) -> dict[int, str]:
    """Return source texts by line: those to keep, then of those shown as many as the budget allows, evenly spread."""
    used = np.zeros(len(data.source) + 1, np.bool_)
    for lines in shown:
        used[lines[(lines >= 1) & (lines <= len(data.source))]] = True
    texts = {line: data.text(line)[:_TEXT_WIDTH] for line in np.flatnonzero(used).tolist()}
    stride = max(1, math.ceil(sum(12 + len(text) for text in texts.values()) / _TEXT_BUDGET))
    chosen = dict(itertools.islice(texts.items(), 0, None, stride))
    return chosen | {line: data.text(line)[:_TEXT_WIDTH] for line in keep}
