"""The modal state of the language: everything one line leaves for the next.

In: a :class:`trochia.program.WorkState` and the machine position where the program starts.  One mutable object, kept
in one place because the fast path reads and writes it too.  Program units (mm or inch as G20/G21 have it, degree) and
program coordinates, except where a field says [mm].
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from trochia.languages.gcode.parameters import Parameters
from trochia.program.modes import PathMode, Plane, TimeLaw
from trochia.program.parameter_file import ACTIVE
from trochia.program.tools import NO_TOOL, Tool

if TYPE_CHECKING:
    from trochia.languages.gcode.answers import Answers
    from trochia.languages.gcode.compensator import Compensator
    from trochia.languages.gcode.cycles.profile import Profile
    from trochia.languages.gcode.groups.saved_modes import Modes
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
    stored_shift, shift_on
        G92 offset that G92.3 brings back [mm], and whether one applies.
    tool_offset
        Of the tool in use, in machine directions (a turned system does not turn it).
    tools
        The tool table, in its order; None: every tool may be called.
    tool, loaded, slot
        Tool of the last T, tool in the spindle, and the place of that in the table, from 1.  Like the reference
        alone, a program begins with slot 1 and no tool.
    in_spindle
        What is known of the tool in the spindle, which G43 without H uses.
    surface_speed, most_speed
        G96, and its D [rev/min]; None: no bound.
    feed_override, speed_override, adaptive_feed, feed_hold
        What the operator and the machine may do to the speed (M48 to M53).
    input_value
        What the last M66 read: 0 or 1, the value of an analogue input, or -1 after its time was over.
    user_codes
        Whether M100 to M199 may be called, or which of them.
    unit
        Length in which variables tell points and offsets [mm].
    parameters
        Variables of the program.
    saved
        Modes kept by M70 and M73, one entry for every call in progress, the program itself first.
    homes
        Points of G28 and G30, machine coordinates [mm].
    compensation
        Moves the tool's centre while G41 or G42 is in force.
    profile
        What a lathe cycle's subroutine draws, while it runs.
    straight_next
        The next move must be straight, because cutter compensation has ended.
    tolerance, tolerance_along
        G64 P and Q as they act, in the unit they were given in.
    diameter
        G7: X words are diameters.
    spline_points, spline_order
        The curve that G5.2 began: control points with their weights, and its order.
    spline_end
        How the last G5 ended: from its second control point to its end.
    retract_to_r
        G99: canned cycles go back to R, not to where the first of them began.
    cycle_words
        Words that stay in force from one hole of a canned cycle to the next, and its initial level.
    answers
        What the machine has answered so far; None: nobody answers.
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
    diameter: bool = False
    spline_points: list[tuple[float, float, float]] = field(default_factory=list[tuple[float, float, float]])
    spline_order: int = 3
    spline_end: tuple[float, float] = (0.0, 0.0)
    retract_to_r: bool = True
    cycle_words: dict[str, float] = field(default_factory=dict[str, float])

    system: int = 1
    origin: list[float] = field(default_factory=_zeros)
    rotation: float = 0.0
    shift: list[float] = field(default_factory=_zeros)
    systems: list[list[float]] = field(default_factory=lambda: [_zeros() for _ in range(9)])
    rotations: list[float] = field(default_factory=_zeros)
    stored_shift: list[float] = field(default_factory=_zeros)
    shift_on: bool = False
    homes: dict[int, list[float]] = field(default_factory=lambda: {28: _zeros(), 30: _zeros()})

    tool_offset: list[float] = field(default_factory=_zeros)
    tools: list[Tool] | None = None
    loaded: int = 0
    slot: int = 1
    in_spindle: Tool = NO_TOOL

    direction: int = 0
    speed: float = 0.0
    surface_speed: bool = False
    most_speed: float | None = None
    tool: int = 0
    feed_override: bool = True
    speed_override: bool = True
    adaptive_feed: bool = False
    feed_hold: bool = True
    input_value: float = 0.0
    user_codes: bool | frozenset[int] = False
    unit: float = 1.0
    parameters: Parameters = field(default_factory=Parameters)
    saved: list[Modes | None] = field(default_factory=lambda: [None])
    mist: bool = False
    flood: bool = False
    ended: bool = False
    compensation: Compensator | None = None
    profile: Profile | None = None
    straight_next: bool = False
    answers: Answers | None = None

    @property
    def scale(self) -> float:
        """Length of a program unit [mm]."""
        return INCH if self.inch else 1.0


def begin(work: WorkState, start: tuple[float, ...]) -> State:
    """Return the state in which a program starts at the machine position ``start`` (9) [mm, degree]."""
    from trochia.languages.gcode.frames import to_program  # noqa: PLC0415 - frames works on states

    numbers = [tool.number for tool in work.tools or ()]
    state = State(
        system=work.active,
        origin=list(work.systems[work.active - 1]),
        rotation=work.rotations[work.active - 1],
        systems=[list(system) for system in work.systems],
        rotations=list(work.rotations),
        stored_shift=list(work.g92),
        shift=list(work.g92) if work.g92_on else _zeros(),
        shift_on=work.g92_on,
        homes={28: list(work.g28), 30: list(work.g30)},
        user_codes=work.user_codes,
        unit=work.unit,
        tool_offset=list(work.tool_offset),
        tools=None if work.tools is None else list(work.tools),
        tool=work.tool,
        loaded=work.tool,
        slot=numbers.index(work.tool) + 1 if work.tool in numbers else 1,
        in_spindle=next((tool for tool in work.tools or () if work.tool and tool.number == work.tool), NO_TOOL),
    )
    state.parameters.numbered[ACTIVE] = float(work.active)
    state.position = to_program(state, start)
    return state


def work_of(state: State, before: WorkState) -> WorkState:
    """Return what a program leaves set up on the machine; ``before`` is what it found, of which G92.3's rest stays."""
    from dataclasses import replace  # noqa: PLC0415 - once a program

    from trochia.languages.gcode.frames import in_mm  # noqa: PLC0415 - frames works on states

    return replace(
        before,
        systems=tuple(tuple(system) for system in state.systems),
        rotations=tuple(state.rotations),
        active=state.system,
        g92=tuple(state.stored_shift),
        g92_on=state.shift_on,
        g28=tuple(state.homes[28]),
        g30=tuple(state.homes[30]),
        tools=None if state.tools is None else tuple(state.tools),
        tool=state.loaded,
        tool_offset=tuple(in_mm(state, state.tool_offset)),
        variables={number: state.parameters.numbered[number] for number in before.variables},
    )
