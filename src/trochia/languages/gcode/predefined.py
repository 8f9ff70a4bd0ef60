"""The variables a program may ask the interpreter for: ``#<_x>``, ``#<_feed>``, ``#5420`` and their like.

In: the modal state.  Out: entries of ``computed`` and ``predefined`` of a
:class:`~trochia.languages.gcode.parameters.Parameters`.  They are read-only.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.computed import Computed
from trochia.languages.gcode.frames import to_machine
from trochia.languages.gcode.state import NO_MOTION
from trochia.program.modes import Plane, TimeLaw

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.languages.gcode.parameters import Parameters
    from trochia.languages.gcode.state import State

    Reading = Callable[["State"], float]
    Maker = Callable[["State"], Computed]

VERSION = (2.9, 0.0)  #: of the language: that of the reference
_PLANES = {Plane.XY: 170.0, Plane.ZX: 180.0, Plane.YZ: 190.0}
_G80 = 800.0
_FIRST_POSITION = 5420
_FAULTS = (5600, 5601)  # tool changer: there is none here, so there is no fault


def _compensation_code(state: State) -> float:
    """Return 400, 410 or 420, for G40 to G42."""
    if state.compensation is None:
        return 400.0
    return 410.0 if state.compensation.side > 0 else 420.0


#: name -> what it is, worked out from the modal state; codes are ten times their number
NAMES: dict[str, tuple[str, Reading]] = {
    "_vmajor": ("version of the language", lambda _: VERSION[0]),
    "_vminor": ("its second part", lambda _: VERSION[1]),
    "_motion_mode": ("modal motion code", lambda state: _G80 if state.motion == NO_MOTION else float(state.motion)),
    "_plane": ("plane code", lambda state: _PLANES[state.plane]),
    "_metric": ("1 with G21", lambda state: float(not state.inch)),
    "_imperial": ("1 with G20", lambda state: float(state.inch)),
    "_absolute": ("1 with G90", lambda state: float(state.absolute)),
    "_incremental": ("1 with G91", lambda state: float(not state.absolute)),
    "_inverse_time": ("1 with G93", lambda state: float(state.law == TimeLaw.INVERSE)),
    "_units_per_minute": ("1 with G94", lambda state: float(state.law == TimeLaw.PER_SECOND)),
    "_units_per_rev": ("1 with G95", lambda state: float(state.law == TimeLaw.PER_REV)),
    "_coord_system": ("code of the coordinate system", lambda state: _coordinate_code(state.system)),
    "_ccomp": ("code of cutter compensation", _compensation_code),
    "_tool_offset": ("1 where a tool offset is in force", lambda state: float(any(state.tool_offset))),
    "_retract_r_plane": ("1 with G99", lambda state: float(state.retract_to_r)),
    "_retract_old_z": ("1 with G98", lambda state: float(not state.retract_to_r)),
    "_spindle_rpm_mode": ("1 with G97", lambda state: float(not state.surface_speed)),
    "_spindle_css_mode": ("1 with G96", lambda state: float(state.surface_speed)),
    "_ijk_absolute_mode": ("1 with G90.1", lambda state: float(state.arc_absolute)),
    "_spindle_on": ("1 while the spindle turns", lambda state: float(state.direction != 0)),
    "_spindle_cw": ("1 after M3", lambda state: float(state.direction > 0)),
    "_mist": ("1 after M7", lambda state: float(state.mist)),
    "_flood": ("1 after M8", lambda state: float(state.flood)),
    "_speed_override": ("1 where it may act", lambda state: float(state.speed_override)),
    "_feed_override": ("1 where it may act", lambda state: float(state.feed_override)),
    "_adaptive_feed": ("1 where it may act", lambda state: float(state.adaptive_feed)),
    "_feed_hold": ("1 where it may act", lambda state: float(state.feed_hold)),
    "_feed": ("F in force", lambda state: state.feed),
    "_rpm": ("S in force", lambda state: state.speed),
    "_current_tool": ("tool in the spindle", lambda state: float(state.loaded)),
    "_current_pocket": ("its place in the tool table", lambda state: float(state.slot)),
    "_selected_tool": ("tool of the last T", lambda state: float(state.tool)),
    "_lathe_diameter_mode": ("1 with G7", lambda state: float(state.diameter)),
    "_lathe_radius_mode": ("1 with G8", lambda state: float(not state.diameter)),
    "_task": ("0: the program is read, not run", lambda _: 0.0),
    "_remap_level": ("0: no code is remapped here", lambda _: 0.0),
}


def define(parameters: Parameters, state: State) -> None:
    """Let the parameters answer from the state."""
    parameters.predefined.offer(_BY_NAME, state)
    parameters.computed.offer(_BY_NUMBER, state)


def _of(reading: Reading) -> Maker:
    return lambda state: Computed(lambda: reading(state))


def _coordinate(axis: int) -> Maker:
    return lambda state: Computed(lambda: state.position[axis])


def _machine_coordinate(axis: int) -> Maker:
    """Return how to read a machine coordinate, in program units."""
    linear = axis < 3
    return lambda state: Computed(lambda: to_machine(state, state.position)[axis] / (state.scale if linear else 1.0))


def _fault(state: State) -> Computed:
    del state
    return Computed(lambda: 0.0, _ignore)


def _coordinate_code(system: int) -> float:
    """Return ten times the code of a coordinate system: 540 for G54, 593 for G59.3."""
    last = 6  # G59
    return 530.0 + 10.0 * system if system <= last else 590.0 + system - last


def _ignore(value: float) -> None:
    """Do nothing: the interpreter sets it anew at once."""
    del value


_BY_NAME: dict[str, Maker] = {
    **{name: _of(reading) for name, (_, reading) in NAMES.items()},
    **{f"_{letter}": _coordinate(axis) for axis, letter in enumerate("xyzabcuvw")},
    **{f"_abs_{letter}": _machine_coordinate(axis) for axis, letter in enumerate("xyzabc")},
}
_BY_NUMBER: dict[int, Maker] = {
    **{_FIRST_POSITION + axis: _coordinate(axis) for axis in range(9)},
    **dict.fromkeys(_FAULTS, _fault),
}
