"""Where step pulses go: kept for looking at, or into the twin of a motor.

In: steps, each at its moment.  Out: what the motor made of them.  A driver for a real board has the same two calls.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.backends.stepper_twin import StepperRun, StepperTwin

KEPT = 50  #: time steps from one kept sample to the next: a millisecond
_BLOCK = 256  # steps handed to the twin at once


class StepOutput(Protocol):
    """What a motor asks of where its pulses go."""

    def step(self, moment: float, direction: int) -> None:
        """Make a step at a moment [s], 1 or -1."""
        ...

    def energise(self, moment: float, *, on: bool) -> None:
        """Switch the windings' current on or off from a moment [s] on."""
        ...


class Kept:
    """Keeps every step.

    Attributes
    ----------
    moments, directions
        Of the steps [s], 1 or -1.
    switched
        When the windings were switched, and whether on.
    """

    def __init__(self) -> None:
        self.moments: list[float] = []
        self.directions: list[int] = []
        self.switched: list[tuple[float, bool]] = []

    def step(self, moment: float, direction: int) -> None:
        """Keep a step."""
        self.moments.append(moment)
        self.directions.append(direction)

    def energise(self, moment: float, *, on: bool) -> None:
        """Keep when the windings were switched."""
        self.switched.append((moment, on))


class Calls:
    """Calls one function for a step forwards, another for one backwards; swapped, they reverse the motor."""

    def __init__(self, forward: Callable[[], object], backward: Callable[[], object]) -> None:
        self._forward = forward
        self._backward = backward

    def step(self, moment: float, direction: int) -> None:  # noqa: ARG002 - the functions know what time it is
        """Call the function of the direction."""
        (self._forward if direction > 0 else self._backward)()

    def energise(self, moment: float, *, on: bool) -> None:
        """Do nothing: the functions only step."""


class TwinOutput:
    """The twin of a motor: its physics follow the steps, and lose some where the real motor would.

    Parameters
    ----------
    keep
        Keep what the motor does every millisecond, for a picture.

    Attributes
    ----------
    kept
        What was kept, in pieces.
    """

    def __init__(self, twin: StepperTwin, *, keep: bool = False) -> None:
        self.twin = twin
        self.kept: list[StepperRun] = []
        self._keep = keep
        self._moments: list[float] = []
        self._directions: list[int] = []

    def step(self, moment: float, direction: int) -> None:
        """Hand a step to the twin."""
        if self._directions and self._directions[-1] != direction:
            self._hand_over()
        self._moments.append(moment)
        self._directions.append(direction)
        if len(self._moments) == _BLOCK:
            self._hand_over()
            self._go_on(moment)

    def energise(self, moment: float, *, on: bool) -> None:
        """Switch the windings on or off, as the driver does it."""
        self._hand_over()
        self._go_on(moment)
        self.twin.set_enabled(on)

    def settle(self, moment: float, *, every: int = 1) -> StepperRun:
        """Let the twin go on to a moment [s], and return what it did since it was last looked at."""
        self._hand_over()
        run = self.twin.run(max(moment - self.twin.now, 0.0), every=KEPT if self._keep else every)
        if self._keep and run.time.size:
            self.kept.append(run)
        return run

    def lost_steps(self, moment: float) -> int:
        """Return the full steps lost so far, the rotor given a quarter second of rest after ``moment`` [s]."""
        self.settle(moment + 0.25)
        return int(self.twin.run_ticks(1).lost_steps[-1])

    def _go_on(self, moment: float) -> None:
        """Let the twin go on to a moment, if it is still to come."""
        if moment > self.twin.now:
            self.settle(moment, every=1_000_000)

    def _hand_over(self) -> None:
        """Queue what is waiting."""
        if self._moments:
            # the twin's clock is rounded to its time steps, so it may stand a hair past a moment
            self.twin.queue(np.maximum(self._moments, self.twin.now), self._directions[0])
            self._moments.clear()
            self._directions.clear()
