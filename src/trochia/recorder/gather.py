"""Blocks of samples gathered into a recording in memory."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.recorder.recording import Recording
from trochia.recorder.writer import pack

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

    from trochia.recorder.channel import Header


def gather(header: Header, blocks: Iterable[Mapping[str, NDArray[Any]]]) -> Recording:
    """Return a recording that holds all blocks; for long ones, :func:`trochia.recorder.write` keeps memory free."""
    packed = [pack(header, block) for block in blocks]
    records = np.concatenate(packed) if packed else np.empty(0, header.record)
    return Recording(header=header, channels={channel.name: records[channel.name] for channel in header.channels})
