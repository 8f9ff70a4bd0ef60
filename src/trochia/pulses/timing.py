r"""What a driver asks of its step and direction inputs, held against the steps it is to get.

In: step blocks in order, a machine (each joint's ``PulseTiming`` and ``pulse_rate``).
Out: for each joint the direction edges, put into the free gap; the first demand that is not met; the highest step rate.

``  step  __/length\\__space____________/length\\____``
``  direction ________________/edge``      hold counts from the step before to the edge, set-up from there to the next
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.joints import Joint
    from trochia.machine.machine import Machine
    from trochia.pulses.steps import StepBlock


@dataclass(frozen=True, slots=True, kw_only=True)
class Demand:
    """A driver's demands in whole ticks, each rounded up."""

    length: int
    space: int
    setup: int
    hold: int
    interval: int  #: least from step to step the same way
    turn: int  #: least from step to step when the direction changes between

    @classmethod
    def of(cls, joint: Joint, clock: int) -> Demand:
        """Return what the joint's driver asks at ``clock`` [Hz]."""

        def whole(seconds: float) -> int:
            return math.ceil(seconds * clock * (1 - 1e-12))

        asked = joint.pulses
        length, space, setup, hold = map(whole, (asked.length, asked.space, asked.setup, asked.hold))
        interval = max(length + space, whole(1 / joint.pulse_rate) if joint.pulse_rate else 0, 1)
        return cls(length=length, space=space, setup=setup, hold=hold, interval=interval,
                   turn=max(interval, hold + setup))  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class Violation:
    """A step that comes too soon after the one before it.

    Attributes
    ----------
    gap, needed
        What lies between the two steps and what the driver asks [ticks].
    turn
        Whether the direction changes between them.
    move
        Row of the program's move the step belongs to.
    """

    joint: str
    tick: int
    clock: int
    gap: int
    needed: int
    turn: bool
    move: int

    def __str__(self) -> str:
        what = "the direction set-up and hold" if self.turn else "the pulse length and space"
        had, needed = (1e6 * ticks / self.clock for ticks in (self.gap, self.needed))
        return (
            f"joint {self.joint} at {self.tick / self.clock:.6f} s: {had:.3f} µs between two steps, "
            f"where {what} of its driver take {needed:.3f} µs"
        )


@dataclass(slots=True)
class _JointState:
    """A joint between two blocks."""

    demand: Demand
    last: int | None = None
    direction: int = 0
    steps: int = 0
    shortest: int | None = None

    def note(self, ticks: NDArray[np.int64], ways: NDArray[np.int8], gaps: NDArray[np.int64]) -> None:
        """Take a block's steps in; the gap before the very first step is none."""
        between = gaps if self.steps else gaps[1:]
        if between.size:
            shortest = int(between.min())
            self.shortest = shortest if self.shortest is None else min(self.shortest, shortest)
        self.last, self.direction, self.steps = int(ticks[-1]), int(ways[-1]), self.steps + ticks.size


@dataclass(slots=True)
class PulseCheck:
    """Holds step blocks, in order, against the drivers of a machine.

    Parameters
    ----------
    machine
        Whose joints.
    segments
        SEGMENT rows of the path, to name the move.
    clock
        Ticks a second [Hz].

    Attributes
    ----------
    first
        The violation that comes first, None while there is none.
    violations
        How many steps came too soon.
    """

    machine: Machine
    segments: NDArray[np.void]
    clock: int
    first: Violation | None = None
    violations: int = 0
    _joints: list[_JointState] = field(init=False)

    def __post_init__(self) -> None:
        self._joints = [_JointState(Demand.of(joint, self.clock)) for joint in self.machine.joints]

    def add(self, block: StepBlock) -> tuple[tuple[NDArray[np.int64], NDArray[np.int8]], ...]:
        """Check a block; return for each joint its direction edges: when (edges,) [ticks] and to which way.

        The first edge of all comes at least one set-up before the first step, so it may lie before tick 0.
        """
        found = [self._joint(number, block) for number in range(len(self._joints))]
        earliest = min((row[2] for row in found if row[2]), key=lambda violation: violation.tick, default=None)
        self.first = self.first or earliest
        return tuple((edges, ways) for edges, ways, _ in found)

    def highest_rates(self) -> dict[str, float]:
        """Return the highest step rate of each joint so far [1/s]; 0 where it made fewer than two steps."""
        return {
            joint.name: self.clock / max(state.shortest, 1) if state.shortest is not None else 0.0
            for joint, state in zip(self.machine.joints, self._joints, strict=True)
        }

    def steps(self) -> dict[str, int]:
        """Return how many steps each joint made so far."""
        return {joint.name: state.steps for joint, state in zip(self.machine.joints, self._joints, strict=True)}

    def _joint(self, number: int, block: StepBlock) -> tuple[NDArray[np.int64], NDArray[np.int8], Violation | None]:
        """Check one joint's steps of a block; return its edges and the first step that comes too soon."""
        state, ticks, ways = self._joints[number], block.ticks[number], block.directions[number]
        if not ticks.size:
            return ticks, ways, None
        demand = state.demand
        before = np.concatenate(([ticks[0] - demand.turn if state.last is None else state.last], ticks[:-1]))
        turned = ways != np.concatenate(([state.direction], ways[:-1]))
        gaps = ticks - before
        needed = np.where(turned, demand.turn, demand.interval)
        state.note(ticks, ways, gaps)
        free = np.maximum(gaps - demand.hold - demand.setup, 0)
        edges = (before + demand.hold + free // 2)[turned]
        late = np.flatnonzero(gaps < needed)
        self.violations += late.size
        if not late.size:
            return edges, ways[turned], None
        at = int(late[0])
        violation = Violation(
            joint=self.machine.joints[number].name,
            tick=int(ticks[at]),
            clock=self.clock,
            gap=int(gaps[at]),
            needed=int(needed[at]),
            turn=bool(turned[at]),
            move=self._move(block, int(ticks[at])),
        )
        return edges, ways[turned], violation

    def _move(self, block: StepBlock, tick: int) -> int:
        """Return the row of the move at work at a tick of the block."""
        phase = max(0, int(np.searchsorted(block.phases["t"], tick / self.clock, side="right")) - 1)
        return int(self.segments["move"][block.phases["segment"][phase]])
