"""Face of ``core/host/twin.h``: one joint of the digital twin, first level.

In: commanded travel of the joint in blocks.  Out: motor position, travel of motor and load, encoder counts.  The state
is carried from block to block, so any cut into blocks gives the same samples.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import ConfigError, LimitError
from trochia.kernels.layout import ffi, lib, pointer

if TYPE_CHECKING:
    from fractions import Fraction

    from numpy.typing import NDArray


LIMIT = 2**31  #: motor positions and terms of a gearing below this cannot overflow 64 bits when multiplied


@dataclass(frozen=True, slots=True, kw_only=True)
class TwinBlock:
    """What a joint did over a block, each (samples,); integers where the joint counts them, else None.

    ``load_angle`` [electrical degree] and ``lost`` [full steps] are a physical stepper's, ``current`` [A] is the length
    of its phases' currents; ``measured`` [mm or degree], ``command`` [V], ``current`` and ``torque`` [N·m] are a
    physical servo's.
    """

    position: NDArray[np.int64] | None
    motor: NDArray[np.float64]
    counts: NDArray[np.int64] | None
    load: NDArray[np.float64]
    load_angle: NDArray[np.float64] | None = None
    lost: NDArray[np.int64] | None = None
    measured: NDArray[np.float64] | None = None
    command: NDArray[np.float64] | None = None
    current: NDArray[np.float64] | None = None
    torque: NDArray[np.float64] | None = None


class TwinJoint:
    """One joint at rest at ``command``, ready to follow.

    Parameters
    ----------
    command
        Commanded travel at the start [mm or degree].
    name
        What errors call it.
    steps_per_unit
        Of a stepper: it stands on the last step passed [1/mm or 1/degree].
    counts_per_unit
        Of an encoder; a joint with an encoder but no steps is a servo and stands on the nearest count.  A joint
        with neither follows exactly.
    on_load
        Whether the encoder reads the load rather than the motor.
    backlash
        Width of the dead zone between motor and load [mm or degree].
    slack
        Where the load lies in it at the start, -1 to 1: 0 centred, -1 as after moving forwards.

    Raises
    ------
    ConfigError
        When the encoder's gearing to the motor cannot be counted in 64 bits, or backlash is below zero.
    LimitError
        When the start cannot be counted.
    """

    def __init__(
        self,
        command: float,
        *,
        name: str = "joint",
        steps_per_unit: Fraction | None = None,
        counts_per_unit: Fraction | None = None,
        on_load: bool = False,
        backlash: float = 0.0,
        slack: float = 0.0,
    ) -> None:
        if not 0 <= backlash < np.inf:
            raise ConfigError(f"joints.{name}.backlash must not be below zero, not {backlash!r}")
        self.name = name
        state = ffi.new("trochia_twin_joint *")
        self._state = state
        self.counted = steps_per_unit is not None or counts_per_unit is not None
        self.encoder = counts_per_unit is not None
        if self.counted:
            per_unit = steps_per_unit if steps_per_unit is not None else counts_per_unit
            assert per_unit is not None
            state.motor = lib.TROCHIA_TWIN_COUNTS if steps_per_unit is None else lib.TROCHIA_TWIN_STEPS
            state.per_unit = float(per_unit)
            self._read_by(counts_per_unit, per_unit, on_load=on_load)
        state.backlash = backlash
        self._refuse(np.array([command]))
        lib.trochia_twin_start(state, command, slack)

    def _read_by(self, counts: Fraction | None, per_unit: Fraction, *, on_load: bool) -> None:
        """Give the joint its encoder: the gearing from motor positions to counts is exact."""
        if counts is None:
            return
        gearing = counts / per_unit
        if abs(gearing.numerator) >= LIMIT or gearing.denominator >= LIMIT:
            raise ConfigError(f"joints.{self.name}.encoder: counts a step must be a fraction of terms below 2**31")
        self._state.encoder = lib.TROCHIA_TWIN_ON_LOAD if on_load else lib.TROCHIA_TWIN_ON_MOTOR
        self._state.counts_per_unit = float(counts)
        self._state.numerator, self._state.denominator = gearing.numerator, gearing.denominator

    def _refuse(self, command: NDArray[np.float64]) -> None:
        """Refuse commands that are no number or beyond what the joint can count."""
        scale = max(abs(self._state.per_unit), abs(self._state.counts_per_unit), 1.0)
        greatest = float(np.abs(command).max())  # NaN comes through and is refused
        if not greatest * scale < LIMIT:
            raise LimitError(f"joint {self.name} counts to less than 2**31; a command of {greatest!r} is beyond it")

    def run(self, command: NDArray[np.float64]) -> TwinBlock:
        """Follow a block of commands (samples,) [mm or degree].

        Raises
        ------
        LimitError
            When a command is no number or beyond 2**31 steps or counts.
        """
        command = np.ascontiguousarray(command, np.float64)
        n = len(command)
        if n:
            self._refuse(command)
        motor, load = np.empty(n), np.empty(n)
        position = np.empty(n, np.int64) if self.counted else None
        counts = np.empty(n, np.int64) if self.encoder else None
        lib.trochia_twin_run(
            self._state,
            pointer(command, "const double *"),
            n,
            ffi.NULL if position is None else pointer(position, "int64_t *"),
            pointer(motor, "double *"),
            ffi.NULL if counts is None else pointer(counts, "int64_t *"),
            pointer(load, "double *"),
        )
        return TwinBlock(position=position, motor=motor, counts=counts, load=load)
