"""What an experiment asks of an axis, and what it may not exceed.

In: nothing.  Out: :class:`AxisUnderTest`, which the twin implements and any machine may; :class:`Bounds`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from trochia.errors import ConfigError, LimitError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.kernels.servo import ServoSamples
    from trochia.servo.axis import Loop

    Array = NDArray[np.float64]


class AxisUnderTest(Protocol):
    """One servo axis that runs in blocks of ticks.

    Attributes
    ----------
    period
        Of a tick [s].
    torque
        Of the motor for a unit of command [N·m or N], as its catalogue says.
    counts
        Of the encoder, a unit of motion; None: exact.
    """

    period: float
    torque: float
    counts: float | None

    @property
    def position(self) -> float:
        """Where the encoder says the axis is."""
        ...

    @property
    def limit_closed(self) -> bool:
        """Whether the limit switch is closed."""
        ...

    def enable(self, loop: Loop) -> None:
        """Power the motor under a loop that begins anew; a loop without controllers passes the command on."""
        ...

    def advance(self, wanted: Array, injected: Array | None = None) -> ServoSamples:
        """Go on for as many ticks as there are set-points (ticks, 3), with values added to the command (ticks,)."""
        ...

    def off(self) -> None:
        """Take the power from the motor; never fails, and may be called at any time."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Bounds:
    """What an experiment may not exceed.

    Attributes
    ----------
    low, high
        Travel, in the axis' own positions [rad or m].
    speed
        [rad/s or m/s].
    command
        Of the amplifier's input, either sign.
    current
        [A].
    """

    low: float
    high: float
    speed: float = math.inf
    command: float = math.inf
    current: float = math.inf

    def __post_init__(self) -> None:
        if not self.low < self.high:
            raise ConfigError(f"the travel ends at {self.high:g}, before it begins at {self.low:g}", key="travel")
        for name in ("speed", "command", "current"):
            if not getattr(self, name) > 0.0:
                raise ConfigError(f"must be above zero, not {getattr(self, name)!r}", key=name)

    def refuse(self, wanted: Array, injected: Array | None) -> None:
        """Refuse what would leave the bounds, before anything moves.

        Raises
        ------
        LimitError
            Naming what would be exceeded, and by how much.
        """
        low, high, speed = wanted[:, 0].min(), wanted[:, 0].max(), float(np.abs(wanted[:, 1]).max())
        if low < self.low or high > self.high:
            raise LimitError(
                f"the experiment would go from {low:.4g} to {high:.4g}; travel is {self.low:.4g} to {self.high:.4g}",
                hint="Nothing has moved.  Start elsewhere, or ask for a shorter or a slower experiment.",
            )
        if speed > self.speed:
            raise LimitError(f"the experiment would run at {speed:.4g}; {self.speed:.4g} is allowed",
                             hint="Nothing has moved.  Ask for a slower one.")  # fmt: skip
        most = 0.0 if injected is None or not len(injected) else float(np.abs(injected).max())
        if most > self.command:
            raise LimitError(f"the experiment would command {most:.4g}; {self.command:.4g} is allowed",
                             hint="Nothing has moved.  Ask for a smaller amplitude.")  # fmt: skip

    def watch(self, samples: ServoSamples) -> None:
        """Refuse to go on where samples left the bounds.

        Raises
        ------
        LimitError
            Naming what was exceeded.
        """
        where = samples.measured
        for name, worst, bad in (
            ("travel", float(where[np.argmax(np.maximum(self.low - where, where - self.high))]),
             bool((where < self.low).any() or (where > self.high).any())),
            ("current", float(np.abs(samples.current).max()), bool((np.abs(samples.current) > self.current).any())),
            ("command", float(np.abs(samples.command).max()),
             bool((np.abs(samples.command) > self.command * (1 + 1e-9)).any())),
        ):  # fmt: skip
            if bad:
                raise LimitError(f"stopped: {name} was exceeded ({worst:.4g}); the motor is off",
                                 hint="Lower gains or amplitude, or widen the bounds.")  # fmt: skip
