"""Why the motion is not faster, for the report.  In: an explained plan.  Out: limits by time, and of each sample.

A limit belongs to a group, which is a colour on the path: what a reader can do about it is the same for all of a group.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.planner.binding import ROWS, Kind, word

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from trochia.analysis.explain import Explanation, Share
    from trochia.planner import Trajectory

#: groups in the order of the page's colours (``colour.js``), with what the legend says
GROUPS = {
    "feed": "programmed feed",
    "velocity": "velocity of an axis",
    "acceleration": "acceleration",
    "jerk": "jerk",
    "bend": "bends",
    "stop": "stops",
    "path": "caps on the path",
    "other": "drive, rests",
}
_OF_KIND = {
    Kind.FEED: "feed", Kind.VELOCITY: "velocity", Kind.ACCELERATION: "acceleration", Kind.JERK: "jerk",
    Kind.CURVATURE: "bend", Kind.PATH_VELOCITY: "path", Kind.PATH_ACCELERATION: "path", Kind.PATH_JERK: "path",
}  # fmt: skip
_MANY = 65_536  #: instants asked for in one go
_WORTH = 0.0005  #: a limit that binds for less of the time has no row


@dataclass(frozen=True, slots=True, kw_only=True)
class Reason:
    """One limit that binds: words, group, seconds, share of the whole time, seconds beside stops, part of it used."""

    limit: str
    group: str
    seconds: float
    share: float
    beside_stops: float
    used: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Reasons:
    """Why the motion is not faster.

    Attributes
    ----------
    shares
        Limits by time, the costliest first.
    labels
        Words and group of each label.
    sample
        Label of each of the motion's samples (m,).
    lines
        The limit that costs a source line most of its time, and the part of it.
    """

    shares: tuple[Reason, ...]
    labels: tuple[tuple[str, str], ...]
    sample: NDArray[np.uint8]
    lines: Mapping[int, tuple[str, float]]

    def groups(self) -> list[tuple[str, str, float]]:
        """Return name, words and share of the whole time of each group that binds at all, in the colours' order."""
        parts = dict.fromkeys(GROUPS, 0.0)
        for row in self.shares:
            beside = row.beside_stops / row.seconds if row.seconds else 0.0
            stopping = beside if row.group in {"acceleration", "jerk"} else 0.0
            parts[row.group] += row.share * (1.0 - stopping)
            parts["stop"] += row.share * stopping
        return [(name, GROUPS[name], share) for name, share in parts.items() if share > _WORTH]


def reasons(
    why: Explanation, trajectory: Trajectory, times: NDArray[np.float64], lines: NDArray[np.integer]
) -> Reasons:
    """Return what the report shows of an explained plan; ``times`` [s] are those of its samples.

    Parameters
    ----------
    lines
        Source lines whose costliest limit is wanted.
    """
    codes = np.zeros(len(times), dtype=np.int64)
    for first in range(0, len(times), _MANY):
        part = slice(first, first + _MANY)
        codes[part] = trajectory.binding(times[part]).code
    soft = np.isin(codes // ROWS, (Kind.ACCELERATION, Kind.JERK))
    late = 0.0 if trajectory.shaping is None else trajectory.shaping.mean
    codes += len(Kind) * ROWS * (soft & why.beside_stop(times - late))
    seen, sample = np.unique(codes, return_inverse=True)
    total = trajectory.duration or 1.0
    return Reasons(
        shares=tuple(_reason(share, total) for share in why.shares if share.seconds > _WORTH * total),
        labels=tuple(_label(int(code), why.names) for code in seen),
        sample=sample.astype(np.uint8),
        lines={line: _costliest(why, line) for line in lines.tolist() if why.of_line(line)},
    )


def _reason(share: Share, total: float) -> Reason:
    return Reason(limit=share.limit, group=_OF_KIND.get(share.kind, "other"), seconds=share.seconds,
                  share=share.seconds / total, beside_stops=share.beside_stops, used=share.used)  # fmt: skip


def _label(code: int, names: tuple[str, ...]) -> tuple[str, str]:
    """Return words and group of a code, to which the number of all codes is added beside a stop."""
    stopping, plain = divmod(code, len(Kind) * ROWS)
    words = word(plain, names)
    return (f"{words}, beside a stop", "stop") if stopping else (words, _OF_KIND.get(Kind(plain // ROWS), "other"))


def _costliest(why: Explanation, line: int) -> tuple[str, float]:
    """Return the limit that costs a line most of its time, and which part of it."""
    found = why.of_line(line)
    return found[0][0], found[0][1] / sum(seconds for _, seconds in found)
