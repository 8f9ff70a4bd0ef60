"""Face of ``core/host/servo_law.h``: a servo axis whose loop computes in whole numbers.

In: the numbers of plant and law, positions wanted.  Out: what was measured, where things are, commands and currents.
The state is carried from block to block, so any cut into blocks gives the same samples.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.errors import LimitError
from trochia.kernels.layout import ffi, lib, pointer
from trochia.kernels.servo import COLUMNS, EncoderCount, ServoSamples

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

PMAC, THIRTY_SECONDS = 0, 1  #: enum trochia_law_kind
LIMIT = 2.0**40  #: counts below this cannot overflow the law's whole numbers


class LawKernel:
    """One axis at rest.

    Parameters
    ----------
    plant, law, pid
        Members of ``trochia_plant``, ``trochia_law`` and ``trochia_pid16`` by name; what is not given is 0.
    position
        Where motor and load are.
    seed
        Of what the encoder draws.
    """

    def __init__(
        self,
        plant: Mapping[str, Any],
        law: Mapping[str, Any],
        *,
        pid: Mapping[str, Any] | None = None,
        position: float = 0.0,
        seed: int = 0,
    ) -> None:
        self._plant = ffi.new("trochia_plant *", dict(plant))
        self._law = ffi.new("trochia_law *", dict(law))
        self._state = ffi.new("trochia_law_state *", {} if pid is None else {"pid": dict(pid)})
        self._state.plant.motor = self._state.plant.load = position
        self._state.plant.encoder.random = seed

    @property
    def encoder(self) -> EncoderCount:
        """What its encoder has passed and counted so far; zeros where its edges are not looked at."""
        return EncoderCount.of(self._state.plant.encoder)

    def run(self, wanted: NDArray[np.float64], *, disturbance: NDArray[np.float64] | None = None) -> ServoSamples:
        """Go on for some ticks, following positions wanted at each (ticks,).

        Raises
        ------
        LimitError
            When a position cannot be counted, or the loop has run away to no number.
        """
        wanted = np.ascontiguousarray(wanted, np.float64)
        if wanted.ndim != 1:
            raise ValueError(f"expected positions of shape (ticks,), not {wanted.shape}")
        greatest = float(np.abs(wanted).max(initial=0.0)) * float(self._law.counts)
        if not greatest < LIMIT:  # NaN comes through and is refused
            raise LimitError(f"a position of {greatest:g} counts is beyond what the loop can count")
        if disturbance is not None and disturbance.shape != wanted.shape:
            raise ValueError(f"expected one force a tick {wanted.shape}, not {disturbance.shape}")
        force = None if disturbance is None else np.ascontiguousarray(disturbance, np.float64)
        out = np.empty((len(wanted), COLUMNS))
        lib.trochia_law_run(
            self._plant, self._law, self._state, pointer(wanted, "const double *"),
            ffi.NULL if force is None else pointer(force, "const double *"), len(wanted), pointer(out, "double *"),
        )  # fmt: skip
        if len(wanted) and not np.isfinite(out[-1]).all():
            raise LimitError("the loop has run away", hint="It is unstable: lower its gains.")
        return ServoSamples.of(out)


def pmac_bits(law: Mapping[str, Any], commanded: NDArray[np.int64], actual: NDArray[np.int64]) -> NDArray[np.int32]:
    """Return the output of the PMAC law [bits] for command and feedback a cycle [1/32 count] (cycles,), from rest."""
    if commanded.shape != actual.shape or commanded.ndim != 1:
        raise ValueError(f"expected as many commands as positions, not {commanded.shape} and {actual.shape}")
    rows = [np.ascontiguousarray(values, np.int64) for values in (commanded, actual)]
    out = np.empty(len(commanded), np.int32)
    lib.trochia_law_bits(
        ffi.new("trochia_law *", dict(law)), ffi.new("trochia_law_state *"), pointer(rows[0], "const int64_t *"),
        pointer(rows[1], "const int64_t *"), len(out), pointer(out, "int32_t *"),
    )  # fmt: skip
    return out
