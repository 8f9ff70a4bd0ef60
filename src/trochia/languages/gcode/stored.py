"""Numbered variables that are part of the modal state: points, offsets, the tool in the spindle.

In: the modal state.  Out: entries of ``computed`` of a :class:`~trochia.languages.gcode.parameters.Parameters`.  Those
of G28 to G59.3 can be set, and act when their code comes next; those of the tool are only read.  Lengths count in the
machine's unit, whatever G20 or G21 says.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.parameters import Computed
from trochia.program.modes import AXES
from trochia.program.parameter_file import ACTIVE, FIRST_SYSTEM, G28, G30, ROTATION, SHIFT, SHIFT_ON, STEP
from trochia.program.work import SYSTEMS

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from trochia.languages.gcode.parameters import Parameters
    from trochia.languages.gcode.state import State

    Point = Callable[[], list[float]]

INPUT, TOOL, TOOL_OFFSET, DIAMETER, FRONT, BACK, ORIENTATION = 5399, 5400, 5401, 5410, 5411, 5412, 5413
_ROTARY = frozenset("ABC")


def define(parameters: Parameters, state: State) -> None:
    """Let the parameters read and set the state."""
    computed = parameters.computed
    _point(computed, state, G28, lambda: state.homes[28])
    _point(computed, state, G30, lambda: state.homes[30])
    _point(computed, state, SHIFT, lambda: state.stored_shift)
    computed[SHIFT_ON] = Computed(lambda: float(state.shift_on), _shift_writer(state))
    computed[ACTIVE] = Computed(lambda: float(state.system))
    for system in range(len(SYSTEMS)):
        first = FIRST_SYSTEM + STEP * system
        _point(computed, state, first, _origin(state, system))
        computed[first + ROTATION] = _rotation(state, system)
    _tool(computed, state)


def define_settings(parameters: Parameters, ini: Mapping[tuple[str, str], str]) -> None:
    """Let ``#<_ini[section]name>`` be the numbers of an ini file."""
    for (section, name), text in ini.items():
        try:
            value = float(text)
        except ValueError:
            continue
        parameters.predefined[f"_ini[{section}]{name}".lower()] = _constant(value)


def _constant(value: float) -> Computed:
    return Computed(lambda: value)


def _shift_writer(state: State) -> Callable[[float], None]:
    def write(value: float) -> None:
        state.shift_on = value != 0

    return write


def _input_writer(state: State) -> Callable[[float], None]:
    def write(value: float) -> None:
        state.input_value = value

    return write


def _origin(state: State, system: int) -> Point:
    return lambda: state.systems[system]


def _rotation(state: State, system: int) -> Computed:
    def write(value: float) -> None:
        state.rotations[system] = value

    return Computed(lambda: state.rotations[system], write)


def _point(computed: dict[int, Computed], state: State, first: int, point: Point) -> None:
    """Define the nine variables of a point that the state keeps in mm and degree."""
    for axis, letter in enumerate(AXES):
        computed[first + axis] = _axis(point, axis, 1.0 if letter in _ROTARY else state.unit)


def _axis(point: Point, axis: int, unit: float) -> Computed:
    def write(value: float) -> None:
        point()[axis] = value * unit

    return Computed(lambda: point()[axis] / unit, write)


def _tool(computed: dict[int, Computed], state: State) -> None:
    """Define what is known of the tool in the spindle, and what M66 read."""
    computed[INPUT] = Computed(lambda: state.input_value, _input_writer(state))
    computed[TOOL] = Computed(lambda: float(state.loaded))
    for axis, letter in enumerate(AXES):
        computed[TOOL_OFFSET + axis] = _tool_axis(state, axis, 1.0 if letter in _ROTARY else state.unit)
    computed[DIAMETER] = Computed(lambda: state.in_spindle.diameter / state.unit)
    computed[FRONT] = Computed(lambda: state.in_spindle.front)
    computed[BACK] = Computed(lambda: state.in_spindle.back)
    computed[ORIENTATION] = Computed(lambda: float(state.in_spindle.orientation))


def _tool_axis(state: State, axis: int, unit: float) -> Computed:
    return Computed(lambda: state.in_spindle.offset[axis] / unit)
