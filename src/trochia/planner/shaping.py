"""Input shaping: planned motion as a few delayed copies of itself whose swings cancel.

In: resonances of the axes, their limits.  Out: impulses for each axis, and what is left of a swing.

A shaper is a train of impulses A at times t, A > 0 and summing to 1; shaped motion is sum A x(time - t).  As a mean of
the planned motion at other instants it never exceeds a limit the planned one keeps: the limits are convex sets.  That
needs one train for all axes that a limit couples (a joint that moves with two axes, a cap on the vector): such axes get
the trains of all of them, one after the other.  All trains have one mean, so at even speed no axis is late.
Legend: w frequency [rad/s], z damping ratio, T = 2 pi / (w sqrt(1 - z²)), K = exp(-z pi / sqrt(1 - z²)).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from numpy.typing import ArrayLike, NDArray

    from trochia.machine.machine import Machine
    from trochia.machine.resonance import Resonance
    from trochia.planner.limits import Limits

    Floats = NDArray[np.float64]

EI_LEFT = 0.05  #: part of a swing that the shaper ei leaves at its own frequency, to leave little beside it
_SAME = 1e-12  #: impulses closer than this are one [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Train:
    """Impulses: times from 0 on, rising [s], and amplitudes (n,), above 0 and summing to 1."""

    times: tuple[float, ...]
    amplitudes: tuple[float, ...]

    @property
    def mean(self) -> float:
        """By how much it delays an even motion [s]."""
        return sum(t * a for t, a in zip(self.times, self.amplitudes, strict=True))

    def then(self, other: Train) -> Train:
        """Return both one after the other, in either order: their convolution."""
        pairs = sorted((t + u, a * b) for t, a in zip(self.times, self.amplitudes, strict=True)
                       for u, b in zip(other.times, other.amplitudes, strict=True))  # fmt: skip
        merged: list[list[float]] = []
        for time, amplitude in pairs:
            if merged and time - merged[-1][0] < _SAME:
                merged[-1][1] += amplitude
            else:
                merged.append([time, amplitude])
        return Train(times=tuple(t for t, _ in merged), amplitudes=tuple(a for _, a in merged))

    def later(self, delay: float) -> Train:
        """Return it delayed [s]."""
        return Train(times=tuple(t + delay for t in self.times), amplitudes=self.amplitudes)

    def residual(self, frequency: ArrayLike, damping: float) -> Floats:
        """Return the part of a swing that is left after the last impulse, 1 without a shaper (frequencies,).

        exp(-z w tn) |sum A exp(z w t) exp(i wd t)| (Singer and Seering, 1990, eq. 3).
        """
        w = 2.0 * math.pi * np.atleast_1d(np.asarray(frequency, dtype=np.float64))[:, None]
        times = np.array(self.times)
        turned = np.exp((damping * w + 1j * w * math.sqrt(1.0 - damping**2)) * (times - times[-1]))
        return np.abs(turned @ np.array(self.amplitudes))


NONE = Train(times=(0.0,), amplitudes=(1.0,))


def _train(amplitudes: Sequence[float], step: float) -> Train:
    total = sum(amplitudes)
    return Train(times=tuple(i * step for i in range(len(amplitudes))), amplitudes=tuple(a / total for a in amplitudes))


def _zv(period: float, k: float) -> Train:
    """Two impulses: no swing at its frequency (Smith, 1957; Singer and Seering, 1990)."""
    return _train((1.0, k), period / 2)


def _zvd(period: float, k: float) -> Train:
    """Three: the swing's derivative by frequency is 0 too (Singer and Seering, 1990)."""
    return _train((1.0, 2.0 * k, k * k), period / 2)


def _mzv(period: float, k: float) -> Train:
    """Three in three quarters of a period; between zv and zvd in delay and in width."""
    less = k**0.75
    return _train(
        (1.0 - math.sqrt(0.5), (math.sqrt(2.0) - 1.0) * less, (1.0 - math.sqrt(0.5)) * less * less), 0.375 * period
    )


def _ei(period: float, k: float) -> Train:
    """Three as zvd, but a little swing is left in the middle for more width (Singhose, Seering and Singer, 1994)."""
    return _train((1.0 + EI_LEFT, 2.0 * (1.0 - EI_LEFT) * k, (1.0 + EI_LEFT) * k * k), period / 2)


#: every shaper by its name: from T and K to impulses
SHAPERS: dict[str, Callable[[float, float], Train]] = {"zv": _zv, "zvd": _zvd, "mzv": _mzv, "ei": _ei}


def train(resonance: Resonance) -> Train:
    """Return the impulses of an axis' shaper; one at 0 where it has none."""
    if resonance.shaper is None:
        return NONE
    root = math.sqrt(1.0 - resonance.damping**2)
    return SHAPERS[resonance.shaper](1.0 / (resonance.frequency * root), math.exp(-resonance.damping * math.pi / root))


@dataclass(frozen=True, slots=True, kw_only=True)
class Shaping:
    """The trains of all axes, in their order.

    Attributes
    ----------
    trains
        Of each axis (n,), all of one mean.
    """

    trains: tuple[Train, ...]

    @classmethod
    def of(cls, machine: Machine, limits: Limits) -> Shaping | None:
        """Return what a machine's axes ask for, or None where none is shaped."""
        own = [NONE if axis.resonance is None else train(axis.resonance) for axis in machine.axes]
        if all(one is NONE for one in own):
            return None
        together = list(own)
        for group in _coupled(limits):
            joint = NONE
            for one in dict.fromkeys(own[column] for column in group):
                joint = joint.then(one)
            for column in group:
                together[column] = joint
        mean = max(one.mean for one in together)
        return cls(trains=tuple(one.later(mean - one.mean) for one in together))

    @property
    def delay(self) -> float:
        """By how much motion ends later [s]."""
        return max(one.times[-1] for one in self.trains)

    @property
    def mean(self) -> float:
        """By how much an even motion is late [s]."""
        return self.trains[0].mean

    def apply(self, at: Callable[[Floats], Floats], times: Floats) -> Floats:
        """Return the shaped motion at times (times, n), given the planned one at any (times,) -> (times, n)."""
        shaped: Floats | None = None
        for delay in sorted({t for one in self.trains for t in one.times}):
            weights = np.array([sum(a for t, a in zip(one.times, one.amplitudes, strict=True) if t == delay)
                                for one in self.trains])  # fmt: skip
            part = at(times - delay) * weights
            shaped = part if shaped is None else shaped + part
        assert shaped is not None
        return shaped


def _coupled(limits: Limits) -> Iterable[list[int]]:
    """Return the columns of axes that share limits, in groups."""
    axes = limits.matrix.shape[1]
    rows = [np.flatnonzero(row).tolist() for row in limits.matrix[axes:]]
    if np.isfinite([limits.path_velocity, limits.path_acceleration, limits.path_jerk]).any():
        rows.append(list(range(limits.linear)))
    group = list(range(axes))
    for row in rows:
        joined = {group[column] for column in row}
        group = [min(joined) if number in joined else number for number in group]
    return [[column for column in range(axes) if group[column] == number] for number in sorted(set(group))]
