"""Face of ``core/shared/pid.h``: the integer PID a small chip runs, by the very same code."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.kernels.layout import ffi, lib, pointer

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

COLUMNS = ("p", "i", "d", "raw", "output")


class IntegerPid:
    """A controller with gains in 32nds.

    Parameters
    ----------
    p, i, d
        32 Kp, 32 Ki T, 32 Kd / T, each 0 to 65535.
    most
        Greatest output: 1023 of a PWM of 10 bits.
    mended
        Whether the derivative saturates and the output may be negative; else as the electronic leadscrew had it.
    """

    def __init__(self, p: int, i: int, d: int, *, most: int = 1023, mended: bool = False) -> None:
        for name, value in (("p", p), ("i", i), ("d", d)):
            if not 0 <= value < 1 << 16:
                raise ValueError(f"{name} is 0 to 65535 in 32nds, not {value}")
        if not 0 < most < 1 << 15:
            raise ValueError(f"most is 1 to 32767, not {most}")
        self._state = ffi.new("trochia_pid16 *", {"p": p, "i": i, "d": d, "most": most, "mended": int(mended)})

    @property
    def sum(self) -> int:
        """The integral's sum of errors."""
        return int(self._state.sum)

    def run(self, errors: ArrayLike) -> NDArray[np.int32]:
        """Return a row a tick of :data:`COLUMNS` for errors (ticks,), which go through as 16-bit numbers.

        Raises
        ------
        ValueError
            When an error does not fit.
        """
        given = np.atleast_1d(np.asarray(errors))
        if len(given) and (given.min() < -(1 << 15) or given.max() >= 1 << 15):
            raise ValueError("errors are 16-bit numbers, -32768 to 32767")
        taken = np.ascontiguousarray(given, np.int16)
        out = np.empty((len(taken), len(COLUMNS)), np.int32)
        lib.trochia_pid16_run(self._state, pointer(taken, "const int16_t *"), len(taken), pointer(out, "int32_t *"))
        return out
