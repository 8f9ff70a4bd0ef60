"""The modal state of the language: everything one line leaves for the next.

In: a :class:`trochia.program.WorkState` and the machine position where the program starts.  One mutable object, kept
in one place because the fast path reads and writes it too.  Program units (mm or inch as G20/G21 have it, degree) and
program coordinates, except where a field says [mm].
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from trochia.program.modes import PathMode, Plane, TimeLaw

if TYPE_CHECKING:
    from trochia.program.work import WorkState

INCH = 25.4  # mm
NO_MOTION = -1  #: :attr:`State.motion` after G80: axis words need a code of their own


def _zeros() -> list[float]:
    return [0.0] * 9


@dataclass(slots=True, kw_only=True)
class State:
    """Modal state.

    Attributes
    ----------
    motion
        Modal motion code in tenths, as the tables have it (10 is G1), or :data:`NO_MOTION`.
    position
        Current point, nine axes, program coordinates.
    feed
        F word in force [units/min, units/rev]; 0: none.
    origin, rotation
        The active coordinate system: its origin in machine coordinates, and its turn about Z [degree].
    shift
        G92 offset that applies now.
    systems, rotations
        G54 to G59.3 as stored [mm], [degree]; ``system`` counts from 1.
    stored_shift
        G92 offset that G92.3 brings back [mm].
    homes
        Points of G28 and G30, machine coordinates [mm].
    tolerance, tolerance_along
        G64 P and Q as they act, in the unit they were given in.
    retract_to_r
        G99: canned cycles go back to R, not to where the first of them began.
    cycle_words
        Words that stay in force from one hole of a canned cycle to the next, and its initial level.
    """

    motion: int = NO_MOTION
    plane: Plane = Plane.XY
    absolute: bool = True
    arc_absolute: bool = False
    inch: bool = False
    law: TimeLaw = TimeLaw.PER_SECOND
    feed: float = 0.0
    position: list[float] = field(default_factory=_zeros)
    path_mode: PathMode = PathMode.BLEND_DEFAULT
    tolerance: float = 0.0
    tolerance_along: float = 0.0
    retract_to_r: bool = True
    cycle_words: dict[str, float] = field(default_factory=dict[str, float])

    system: int = 1
    origin: list[float] = field(default_factory=_zeros)
    rotation: float = 0.0
    shift: list[float] = field(default_factory=_zeros)
    systems: list[list[float]] = field(default_factory=lambda: [_zeros() for _ in range(9)])
    rotations: list[float] = field(default_factory=_zeros)
    stored_shift: list[float] = field(default_factory=_zeros)
    homes: dict[int, list[float]] = field(default_factory=lambda: {28: _zeros(), 30: _zeros()})

    direction: int = 0
    speed: float = 0.0
    tool: int = 0
    mist: bool = False
    flood: bool = False
    ended: bool = False

    @property
    def scale(self) -> float:
        """Length of a program unit [mm]."""
        return INCH if self.inch else 1.0


def begin(work: WorkState, start: tuple[float, ...]) -> State:
    """Return the state in which a program starts at the machine position ``start`` (9) [mm, degree]."""
    from trochia.languages.gcode.frames import to_program  # noqa: PLC0415 - frames works on states

    state = State(
        system=work.active,
        origin=list(work.systems[work.active - 1]),
        rotation=work.rotations[work.active - 1],
        systems=[list(system) for system in work.systems],
        rotations=list(work.rotations),
        stored_shift=list(work.g92),
        shift=list(work.g92) if work.g92_on else _zeros(),
        homes={28: list(work.g28), 30: list(work.g30)},
    )
    state.position = to_program(state, start)
    return state
