"""Face of ``core/host/follower.h``: the electronic leadscrew's chip and its motor, pulse by pulse."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.kernels.layout import ffi, lib, pointer

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray


class FollowerKernel:
    """A leadscrew at rest, error 0.

    Parameters
    ----------
    follower, pid
        Members of ``trochia_follower`` and ``trochia_pid16`` by name.
    """

    def __init__(self, follower: Mapping[str, Any], pid: Mapping[str, Any], *, error: int = 0) -> None:
        self._follower = ffi.new("trochia_follower *", dict(follower))
        self._state = ffi.new("trochia_follower_state *", {"pid": dict(pid), "error": error})

    def run(self, pulses: int) -> NDArray[np.float64]:
        """Go on for some spindle pulses; return time [s], error [pulses], duty and position [pulses] (pulses, 4)."""
        out = np.empty((pulses, 4))
        lib.trochia_follower_run(self._follower, self._state, pulses, pointer(out, "double *"))
        return out
