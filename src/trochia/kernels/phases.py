"""Phases and states out of C, which every schedule is read by.

In: a function of C with all of its arguments but the last.  Out: blocks of phases; states at times (``PHASE``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.kernels.layout import PHASE, pointer

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray


def blocks(
    fill: Callable[[Any, int], int], size: int, memory: Callable[[int], NDArray[np.void]] | None
) -> Iterator[NDArray[np.void]]:
    """Yield phases in order, at most ``size`` a block (PHASE,), until there are none; ``memory`` gives that of a block.

    Parameters
    ----------
    fill
        Writes phases to a pointer with room for so many, and returns how many it has written.
    """
    while True:
        block = np.empty(size, dtype=PHASE) if memory is None else memory(size)[:size]
        made = fill(pointer(block, "trochia_phase *"), size)
        if not made:
            return
        yield block[:made]


def states(fill: Callable[[Any, int, Any], None], times: NDArray[np.float64]) -> NDArray[np.void]:
    """Return the state at each time [s] (times,) of PHASE.

    Parameters
    ----------
    fill
        Reads so many times from a pointer, and writes their states to another.
    """
    held = np.ascontiguousarray(times, dtype=np.float64)
    out = np.empty(held.shape, dtype=PHASE)
    fill(pointer(held, "double *"), held.size, pointer(out, "trochia_phase *"))
    return out
