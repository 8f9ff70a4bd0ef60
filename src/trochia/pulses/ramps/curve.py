"""A pull-out torque curve: torque over speed in straight pieces, from a CSV file or from points.

In: a file whose first line names its two columns with units, as ``speed_rpm,torque_Nm``.  Out: ``TorqueCurve``, speeds
in steps/s.  Below the first point the torque is that of the first; beyond the last nothing is known.
"""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from trochia.errors import ConfigError, Source

if TYPE_CHECKING:
    from pathlib import Path

_MOST = 10_000  # points
#: column -> steps/s for a unit of it, at one step a turn; N·m for a unit of it
_SPEEDS = {"speed_rpm": 1.0 / 60.0, "speed_rad_s": 1.0 / (2.0 * math.pi), "speed_rev_s": 1.0, "speed_steps_s": None}
_TORQUES = {"torque_Nm": 1.0, "torque_mNm": 1e-3, "torque_Ncm": 1e-2}


@dataclass(frozen=True, slots=True, kw_only=True)
class TorqueCurve:
    """Points of a curve: speeds rising [steps/s], torques at least 0 [N·m]."""

    speeds: tuple[float, ...]
    torques: tuple[float, ...]

    def __post_init__(self) -> None:
        if not 1 <= len(self.speeds) == len(self.torques) <= _MOST:
            raise ConfigError(f"a torque curve has 1 to {_MOST} points, each a speed and a torque")
        if not all(0.0 <= value < math.inf for value in (*self.speeds, *self.torques)):
            raise ConfigError("a torque curve's speeds and torques are numbers of at least 0")
        if any(right <= left for left, right in zip(self.speeds, self.speeds[1:], strict=False)):
            raise ConfigError("a torque curve's speeds rise from point to point")
        if self.speeds[-1] == 0.0:
            raise ConfigError("a torque curve needs a point at a speed above 0")

    def torque(self, speed: float) -> float:
        """Return the torque at a speed [N·m]; beyond the last point it is 0, because nothing is known there."""
        if speed > self.speeds[-1]:
            return 0.0
        if speed <= self.speeds[0]:
            return self.torques[0]
        upper = next(i for i, at in enumerate(self.speeds) if at >= speed)
        low, high = self.speeds[upper - 1], self.speeds[upper]
        part = (speed - low) / (high - low)
        return self.torques[upper - 1] * (1.0 - part) + self.torques[upper] * part

    def least(self, speed: float) -> float:
        """Return the least torque from rest up to a speed [N·m]."""
        inside = [torque for at, torque in zip(self.speeds, self.torques, strict=True) if at < speed]
        return min([self.torques[0] if inside else self.torque(speed), *inside, self.torque(speed)])

    def reach(self, load: float) -> float:
        """Return the speed up to which the torque exceeds ``load`` [N·m] (E9's pull-out speed), in steps/s."""
        if self.torques[0] <= load:
            return 0.0
        for i in range(1, len(self.speeds)):
            if self.torques[i] <= load:
                part = (self.torques[i - 1] - load) / (self.torques[i - 1] - self.torques[i])
                return self.speeds[i - 1] + part * (self.speeds[i] - self.speeds[i - 1])
        return self.speeds[-1]


def read_curve(path: Path, steps_per_turn: int) -> TorqueCurve:
    """Return the curve a CSV file holds.

    Raises
    ------
    ConfigError
        With file and line: for a head that names no known columns, a cell that is no number, speeds that do not rise.
    OSError
        When the file cannot be read.
    """
    name = str(path)
    try:
        rows = list(csv.reader(path.read_text(encoding="utf-8-sig").splitlines()))
    except (UnicodeDecodeError, csv.Error):
        raise ConfigError("is no CSV text", source=Source(name, 1)) from None
    head = [cell.strip() for cell in rows[0]] if rows else []
    if len(head) != 2 or head[0] not in _SPEEDS or head[1] not in _TORQUES:
        raise ConfigError(
            f"the first line must name a speed and a torque, like speed_rpm,torque_Nm, not {','.join(head)!r}",
            source=Source(name, 1),
            hint=f"Speeds: {', '.join(_SPEEDS)}; torques: {', '.join(_TORQUES)}",
        )
    per_turn = _SPEEDS[head[0]]
    factor = 1.0 if per_turn is None else per_turn * steps_per_turn
    points: list[tuple[float, float]] = []
    for number, row in enumerate(rows[1:], 2):
        if row:
            speed, torque = _cells(row, Source(name, number))
            if points and speed * factor <= points[-1][0]:
                raise ConfigError(
                    f"the speed {speed:g} does not rise above the line before", source=Source(name, number)
                )
            points.append((speed * factor, torque * _TORQUES[head[1]]))
    if not 1 <= len(points) <= _MOST:
        raise ConfigError(f"must hold 1 to {_MOST} points, not {len(points)}", source=Source(name, len(rows)))
    return TorqueCurve(speeds=tuple(p[0] for p in points), torques=tuple(p[1] for p in points))


def _cells(row: list[str], source: Source) -> tuple[float, float]:
    """Return a line's speed and torque."""
    try:
        speed, torque = (float(cell) for cell in row)
    except ValueError:
        raise ConfigError(f"expected a speed and a torque, not {','.join(row)!r}", source=source) from None
    if not (0.0 <= speed < math.inf and 0.0 <= torque < math.inf):
        raise ConfigError(f"speed and torque must be at least 0, not {','.join(row)!r}", source=source)
    return speed, torque
