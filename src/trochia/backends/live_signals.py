"""What a live machine records: one row a quantity, of every axis, of every joint, or of the whole.

In: ticks of a backend, or its reports where it tells of no ticks.  Out: samples by channel.  Names are those of the
twin's recordings where they mean the same, so that a run can be held against its plan.
"""

from __future__ import annotations

from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.backends.live import Ticks
from trochia.errors import RecordingError
from trochia.recorder import Channel

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from trochia.backends.live import Report
    from trochia.machine.machine import Machine
    from trochia.recorder.channel import Scalar


@dataclass(frozen=True, slots=True, kw_only=True)
class Moment:
    """Ticks with what the controller knows of them: axes by least squares (ticks, axes), state by its number."""

    ticks: Ticks
    inverse: NDArray[np.float64]
    linear: list[int]
    state: int

    def axes(self, joints: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return axes (ticks, axes) of joints (ticks, joints)."""
        return joints @ self.inverse.T


@dataclass(frozen=True, slots=True)
class Signal:
    """A quantity: its name behind the owner's, what takes it (samples, owners), what is added to the owner's unit."""

    quantity: str
    take: Callable[[Moment], NDArray[Any]]
    per: str = ""
    meaning: str = ""


@dataclass(frozen=True, slots=True)
class Whole:
    """A quantity of the machine as a whole (samples,)."""

    name: str
    take: Callable[[Moment], NDArray[Any]]
    unit: str = ""
    dtype: Scalar = "<f8"
    meaning: str = ""


AXIS = (
    Signal("commanded", lambda m: m.axes(m.ticks.commanded), meaning="where it is told to be"),
    Signal("actual", lambda m: m.axes(m.ticks.actual), meaning="where it really is, as far as the backend knows"),
    Signal("error", lambda m: m.axes(_told(m.ticks) - m.ticks.commanded), meaning="following error: what tells its "
           "position (encoders, else the real one) less what was commanded"),
    Signal("velocity", lambda m: m.axes(m.ticks.velocity), "/s", "as commanded"),
)  # fmt: skip
JOINT = (
    Signal("commanded", lambda m: m.ticks.commanded, meaning="where it is told to be"),
    Signal("encoder", lambda m: m.ticks.encoder, meaning="what its encoder says"),
    Signal("actual", lambda m: m.ticks.actual, meaning="where its load really is"),
)
WHOLE = (
    Whole("path.speed", lambda m: np.linalg.norm(m.axes(m.ticks.velocity)[:, m.linear], axis=1), "mm/s",
          meaning="of the linear axes, as commanded"),
    Whole("path.line", lambda m: m.ticks.line, dtype="<u4", meaning="source line executed"),
    Whole("path.time", lambda m: m.ticks.executed, "s", meaning="motion run through since the backend was opened"),
    Whole("state", lambda m: np.full(len(m.ticks), m.state, np.uint8), dtype="|u1", meaning="of the controller"),
    Whole("beam", lambda m: m.ticks.beam, dtype="<f4", meaning="its power, 0 off"),
)  # fmt: skip


def _told(ticks: Ticks) -> NDArray[np.float64]:
    return np.where(np.isnan(ticks.encoder), ticks.actual, ticks.encoder)


class LiveSignals:
    """The channels of a machine, some of them or all.

    Parameters
    ----------
    patterns
        Names of channels, with ``*`` and ``?`` for any; none: all.
    states
        Names of the values of ``state``.

    Raises
    ------
    RecordingError
        For a pattern that fits no channel.
    """

    def __init__(self, machine: Machine, patterns: Sequence[str] = (), states: tuple[str, ...] = ()) -> None:
        matrix = machine.kinematics.matrix
        self._inverse = np.asarray(np.linalg.pinv(matrix), np.float64)
        self._linear = [i for i, axis in enumerate(machine.axes) if not axis.rotary]
        self._takers: list[Callable[[Moment], NDArray[Any]]] = []
        self.channels: tuple[Channel, ...] = ()
        self.meanings: dict[str, str] = {}
        units = ["degree" if axis.rotary else "mm" for axis in machine.axes]
        for signal in AXIS:
            for i, axis in enumerate(machine.axes):
                channel = Channel(name=f"{axis.name}.{signal.quantity}", unit=units[i] + signal.per)
                self._add(channel, _column(signal, i), signal.meaning)
        for signal in JOINT:
            for i, (joint, row) in enumerate(zip(machine.joints, matrix, strict=True)):
                if signal.quantity != "encoder" or joint.encoder is not None:
                    unit = units[int(np.argmax(np.abs(row)))]
                    channel = Channel(name=f"joint.{joint.name}.{signal.quantity}", unit=unit)
                    self._add(channel, _column(signal, i), signal.meaning)
        for whole in WHOLE:
            if whole.name != "beam" or machine.beam is not None:
                values = states if whole.name == "state" else ()
                channel = Channel(name=whole.name, unit=whole.unit, dtype=whole.dtype, values=values)
                self._add(channel, whole.take, whole.meaning)
        if patterns:
            self._keep(patterns)

    def samples(self, ticks: Ticks, state: int) -> dict[str, NDArray[Any]]:
        """Return samples by channel, each (ticks,)."""
        moment = Moment(ticks=ticks, inverse=self._inverse, linear=self._linear, state=state)
        return {channel.name: take(moment) for channel, take in zip(self.channels, self._takers, strict=True)}

    def _add(self, channel: Channel, take: Callable[[Moment], NDArray[Any]], meaning: str) -> None:
        self.channels += (channel,)
        self.meanings[channel.name] = meaning
        self._takers.append(take)

    def _keep(self, patterns: Sequence[str]) -> None:
        """Keep the channels that one of the patterns fits."""
        for pattern in patterns:
            if not any(fnmatchcase(channel.name, pattern) for channel in self.channels):
                raise RecordingError(f"no channel is called {pattern!r}",
                                     hint=f"There are {', '.join(c.name for c in self.channels)}.")  # fmt: skip
        kept = [any(fnmatchcase(channel.name, pattern) for pattern in patterns) for channel in self.channels]
        self._takers = [take for take, keep in zip(self._takers, kept, strict=True) if keep]
        self.channels = tuple(channel for channel, keep in zip(self.channels, kept, strict=True) if keep)


def ticks_of(report: Report, period: float, count: int) -> Ticks:
    """Return a report as so many ticks alike: for a backend that tells of no ticks."""

    def tiled(values: NDArray[np.float64] | None) -> NDArray[np.float64]:
        row = np.full(len(report.commanded), np.nan) if values is None else values
        return np.tile(row, (count, 1))

    return Ticks(
        period=period, executed=np.full(count, report.executed), commanded=tiled(report.commanded),
        velocity=tiled(report.velocity), encoder=tiled(report.encoder), actual=tiled(report.actual),
        beam=np.full(count, report.beam, np.float32), line=np.full(count, report.line, np.uint32),
    )  # fmt: skip


def _column(signal: Signal, i: int) -> Callable[[Moment], NDArray[Any]]:
    return lambda moment: signal.take(moment)[:, i]
