"""A recording: evenly spaced samples of named channels, in memory or mapped from its file."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.errors import RecordingError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from trochia.recorder.channel import Channel, Header


@dataclass(frozen=True, slots=True, kw_only=True)
class Recording:
    """Samples of every channel at ``start + k * period``; arrays are read-only.

    Attributes
    ----------
    header
        Period, names and channels.
    channels
        Samples by channel name, each (samples,).
    complete
        False when its writing was cut short; what is here is whole records up to the cut.
    """

    header: Header
    channels: Mapping[str, NDArray[Any]]
    complete: bool = True

    def __post_init__(self) -> None:
        named = [channel.name for channel in self.header.channels]
        if named != list(self.channels):
            raise RecordingError(f"expected samples of {', '.join(named)}, not of {', '.join(self.channels)}")
        if len({samples.shape for samples in self.channels.values()}) > 1:
            raise RecordingError("every channel of a recording has the same number of samples")
        for samples in self.channels.values():
            samples.setflags(write=False)
        object.__setattr__(self, "channels", MappingProxyType(dict(self.channels)))

    def __len__(self) -> int:
        """Return the number of samples."""
        return next((len(samples) for samples in self.channels.values()), 0)

    def __contains__(self, name: str) -> bool:
        return name in self.channels

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return a channel's samples (samples,)."""
        try:
            return self.channels[name]
        except KeyError:
            raise RecordingError(
                f"no channel {name!r} in this recording", hint=f"It has {', '.join(self.channels)}."
            ) from None

    @property
    def period(self) -> float:
        """Time between samples [s]."""
        return self.header.period

    @property
    def start(self) -> float:
        """Time of the first sample [s]."""
        return self.header.start

    @property
    def duration(self) -> float:
        """Length of the recorded motion [s]."""
        return self.header.duration

    @property
    def machine(self) -> str:
        """Name of the machine."""
        return self.header.machine

    @property
    def program(self) -> str:
        """Name of the program."""
        return self.header.program

    @property
    def time(self) -> NDArray[np.float64]:
        """Time of each sample (samples,) [s]."""
        return self.start + self.period * np.arange(len(self), dtype=np.float64)

    @property
    def axes(self) -> tuple[str, ...]:
        """Letters of the axes with a commanded position, in the machine's order."""
        return tuple(owner for owner in self._owners("", ".commanded") if "." not in owner)  # a joint has it too

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints with a motor position, in kinematic order."""
        return self._owners("joint.", ".motor")

    def describe(self, name: str) -> Channel:
        """Return a channel's description."""
        self[name]
        return next(channel for channel in self.header.channels if channel.name == name)

    def select(self, prefix: str) -> dict[str, NDArray[Any]]:
        """Return the channels named ``prefix`` or ``prefix.…``; ``"joint.X"`` gives all of one joint."""
        return {
            name: samples for name, samples in self.channels.items() if name == prefix or name.startswith(f"{prefix}.")
        }

    def _owners(self, prefix: str, suffix: str) -> tuple[str, ...]:
        """Return what stands between prefix and suffix in the channels' names."""
        return tuple(
            name.removeprefix(prefix).removesuffix(suffix)
            for name in self.channels
            if name.startswith(prefix) and name.endswith(suffix)
        )
