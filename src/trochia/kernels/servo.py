"""Face of ``core/host/servo.h``: a servo axis run from tick to tick, and its plant alone.

In: the numbers of plant and loops, set-points.  Out: what was measured, where things are, commands and currents.  The
state is carried from block to block, so any cut into blocks gives the same samples.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from trochia.errors import LimitError
from trochia.kernels.layout import ffi, lib, pointer

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

COLUMNS = 7


@dataclass(frozen=True, slots=True, kw_only=True)
class ServoSamples:
    """One row a tick, as things stood at its start, each (ticks,).

    ``measured`` and ``speed`` are what the encoder tells; ``motor`` and ``load`` are where they are.
    """

    measured: NDArray[np.float64]
    motor: NDArray[np.float64]
    load: NDArray[np.float64]
    speed: NDArray[np.float64]
    command: NDArray[np.float64]
    current: NDArray[np.float64]
    force: NDArray[np.float64]

    @classmethod
    def of(cls, rows: NDArray[np.float64]) -> ServoSamples:
        """Return the columns of rows (ticks, 7)."""
        measured, motor, load, speed, command, current, force = rows.T
        return cls(measured=measured, motor=motor, load=load, speed=speed, command=command, current=current,
                   force=force)  # fmt: skip


class EncoderCount(NamedTuple):
    """Where an encoder whose edges are looked at one by one is.

    ``passed`` and ``told`` are edges passed and counts; ``missed`` of the edges were not counted; ``off`` is by how
    many counts the last of ``pulses`` index pulses came elsewhere than the first.
    """

    passed: int
    told: int
    missed: int
    pulses: int
    off: int

    @classmethod
    def of(cls, state: Any) -> EncoderCount:  # noqa: ANN401 - cffi's struct
        """Return that of a ``trochia_encoder_state``."""
        return cls(int(state.place), int(state.told), int(state.missed), int(state.pulses), int(state.off))


class ServoKernel:
    """One axis at rest.

    Parameters
    ----------
    plant, loop
        Members of ``trochia_plant`` and ``trochia_loop`` by name; what is not given is 0.  Structs in them are dicts.
    position
        Where motor and load are.
    seed
        Of what the encoder draws.
    """

    def __init__(
        self, plant: Mapping[str, Any], loop: Mapping[str, Any] | None = None, *, position: float = 0.0, seed: int = 0
    ) -> None:
        self._plant = ffi.new("trochia_plant *", dict(plant))
        self._loop = ffi.new("trochia_loop *", {} if loop is None else dict(loop))
        self._state = ffi.new("trochia_servo_state *")
        self._state.plant.motor = self._state.plant.load = position
        self._state.plant.encoder.random = seed

    @property
    def encoder(self) -> EncoderCount:
        """What its encoder has passed and counted so far; zeros where its edges are not looked at."""
        return EncoderCount.of(self._state.plant.encoder)

    @property
    def ticks(self) -> int:
        """Periods run so far."""
        return int(self._state.ticks)

    def set_plant(self, plant: Mapping[str, Any]) -> None:
        """Change the plant's members from here on, as its amplifier's power; motor and load stay as they move."""
        self._plant = ffi.new("trochia_plant *", dict(plant))

    def set_loop(self, loop: Mapping[str, Any]) -> None:
        """Change the loops from here on; what they remember stays."""
        self._loop = ffi.new("trochia_loop *", dict(loop))

    def forget(self) -> None:
        """Let the loops begin anew; motor and load stay as they move."""
        fresh = ffi.new("trochia_servo_state *")
        fresh.plant = self._state.plant
        self._state = fresh

    def run(
        self,
        wanted: NDArray[np.float64],
        *,
        disturbance: NDArray[np.float64] | None = None,
        injected: NDArray[np.float64] | None = None,
    ) -> ServoSamples:
        """Go on for some ticks.

        Parameters
        ----------
        wanted
            Position, speed and acceleration at each tick (ticks, 3).
        disturbance, injected
            Added to the load's force, and to the command, at each tick (ticks,).

        Raises
        ------
        LimitError
            When the loop has run away to no number.
        """
        wanted = np.ascontiguousarray(wanted, np.float64)
        ticks = len(wanted)
        if wanted.shape != (ticks, 3):
            raise ValueError(f"expected set-points of shape (ticks, 3), not {wanted.shape}")
        extra = [self._extra(values, ticks) for values in (disturbance, injected)]
        out = np.empty((ticks, COLUMNS))
        lib.trochia_servo_run(
            self._plant, self._loop, self._state, pointer(wanted, "const double *"),
            *(ffi.NULL if values is None else pointer(values, "const double *") for values in extra),
            ticks, pointer(out, "double *"),
        )  # fmt: skip
        if ticks and not np.isfinite(out[-1]).all():
            raise LimitError("the loop has run away", hint="It is unstable: lower its gains, or its time step.")
        return ServoSamples.of(out)

    def drive(self, commands: NDArray[np.float64], *, steps: int) -> ServoSamples:
        """Hold each command for some time steps, without any loop."""
        commands = np.ascontiguousarray(commands, np.float64)
        out = np.empty((len(commands), COLUMNS))
        lib.trochia_plant_run(
            self._plant, ffi.addressof(self._state, "plant"), pointer(commands, "const double *"), len(commands),
            steps, pointer(out, "double *"),
        )  # fmt: skip
        return ServoSamples.of(out)

    @staticmethod
    def _extra(values: NDArray[np.float64] | None, ticks: int) -> NDArray[np.float64] | None:
        if values is None:
            return None
        if np.shape(values) != (ticks,):
            raise ValueError(f"expected one value a tick ({ticks},), not {np.shape(values)}")
        return np.ascontiguousarray(values, np.float64)
