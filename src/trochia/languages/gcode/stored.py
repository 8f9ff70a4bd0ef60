"""Numbered variables that are part of the modal state: points, offsets, the tool in the spindle.

In: the modal state.  Out: entries of ``computed`` of a :class:`~trochia.languages.gcode.parameters.Parameters`.  Those
of G28 to G59.3 can be set, and act when their code comes next; those of the tool are only read.  Lengths count in the
machine's unit, whatever G20 or G21 says.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.computed import Computed
from trochia.program.modes import AXES
from trochia.program.parameter_file import FIRST_SYSTEM, G28, G30, ROTATION, SHIFT, SHIFT_ON, STEP
from trochia.program.work import SYSTEMS

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from trochia.languages.gcode.parameters import Parameters
    from trochia.languages.gcode.state import State

    Point = Callable[[State], list[float]]
    Maker = Callable[[State], Computed]

INPUT, TOOL, TOOL_OFFSET, DIAMETER, FRONT, BACK, ORIENTATION = 5399, 5400, 5401, 5410, 5411, 5412, 5413
_ROTARY = frozenset("ABC")


def define(parameters: Parameters, state: State) -> None:
    """Let the parameters read and set the state."""
    parameters.computed.offer(_BY_NUMBER, state)


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


def _shift_on(state: State) -> Computed:
    def write(value: float) -> None:
        state.shift_on = value != 0

    return Computed(lambda: float(state.shift_on), write)


def _input(state: State) -> Computed:
    def write(value: float) -> None:
        state.input_value = value

    return Computed(lambda: state.input_value, write)


def _rotation(system: int) -> Maker:
    def make(state: State) -> Computed:
        def write(value: float) -> None:
            state.rotations[system] = value

        return Computed(lambda: state.rotations[system], write)

    return make


def _axis(point: Point, axis: int) -> Maker:
    """Return how to make one variable of a point that the state keeps in mm and degree."""

    def make(state: State) -> Computed:
        unit = _unit(state, axis)

        def write(value: float) -> None:
            point(state)[axis] = value * unit

        return Computed(lambda: point(state)[axis] / unit, write)

    return make


def _tool_axis(axis: int) -> Maker:
    def make(state: State) -> Computed:
        unit = _unit(state, axis)
        return Computed(lambda: state.in_spindle.offset[axis] / unit)

    return make


def _unit(state: State, axis: int) -> float:
    return 1.0 if AXES[axis] in _ROTARY else state.unit


def _points() -> dict[int, Maker]:
    """Return the makers of all stored points, nine variables each, and of the turns of the coordinate systems."""
    points: dict[int, Point] = {
        G28: lambda state: state.homes[28], G30: lambda state: state.homes[30], SHIFT: lambda state: state.stored_shift,
        **{FIRST_SYSTEM + STEP * system: _origin(system) for system in range(len(SYSTEMS))},
    }  # fmt: skip
    axes = {first + axis: _axis(point, axis) for first, point in points.items() for axis in range(len(AXES))}
    turns = {FIRST_SYSTEM + STEP * system + ROTATION: _rotation(system) for system in range(len(SYSTEMS))}
    return axes | turns


def _origin(system: int) -> Point:
    return lambda state: state.systems[system]


_BY_NUMBER: dict[int, Maker] = {
    **_points(),
    SHIFT_ON: _shift_on,
    INPUT: _input,
    TOOL: lambda state: Computed(lambda: float(state.loaded)),
    **{TOOL_OFFSET + axis: _tool_axis(axis) for axis in range(len(AXES))},
    DIAMETER: lambda state: Computed(lambda: state.in_spindle.diameter / state.unit),
    FRONT: lambda state: Computed(lambda: state.in_spindle.front),
    BACK: lambda state: Computed(lambda: state.in_spindle.back),
    ORIENTATION: lambda state: Computed(lambda: float(state.in_spindle.orientation)),
}
