"""Machine coordinates to program coordinates and back.

machine = turn(program + shift) + origin + tool, where ``turn`` turns X and Y about Z by the system's rotation, and
``tool`` is the tool offset, which is not turned.  Program side in program units, machine side in mm; rotary axes in
degrees on both.
"""

from __future__ import annotations

from math import cos, radians, sin
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from trochia.languages.gcode.state import State

LINEAR = (0, 1, 2, 6, 7, 8)  #: columns of the linear axes; the others are rotary and know no length unit


def in_program_units(state: State, offsets: Sequence[float]) -> list[float]:
    """Return offsets (9) given in mm and degree, in program units."""
    return scaled(offsets, 1 / state.scale)


def in_mm(state: State, offsets: Sequence[float]) -> list[float]:
    """Return offsets (9) given in program units, in mm and degree."""
    return scaled(offsets, state.scale)


def scaled(offsets: Sequence[float], factor: float) -> list[float]:
    """Return the linear axes times ``factor``, the rotary axes as they are."""
    values = list(offsets)
    for axis in LINEAR:
        values[axis] *= factor
    return values


def turned(values: list[float], degrees: float) -> list[float]:
    """Return the point (9) turned about Z."""
    if degrees:
        c, s = cos(radians(degrees)), sin(radians(degrees))
        x, y = values[0], values[1]
        values = [c * x - s * y, s * x + c * y, *values[2:]]
    return values


def base_of(state: State) -> list[float]:
    """Return where the turned program coordinates begin (9), machine coordinates in program units."""
    return [origin + tool for origin, tool in zip(state.origin, state.tool_offset, strict=True)]


def to_program(state: State, machine: Sequence[float]) -> list[float]:
    """Return the program coordinates of a machine point (9) [mm, degree]."""
    point = in_program_units(state, machine)
    point = turned([value - base for value, base in zip(point, base_of(state), strict=True)], -state.rotation)
    return [value - shift for value, shift in zip(point, state.shift, strict=True)]


def to_machine(state: State, point: Sequence[float]) -> list[float]:
    """Return the machine coordinates [mm, degree] of a program point (9)."""
    values = turned([value + shift for value, shift in zip(point, state.shift, strict=True)], state.rotation)
    return in_mm(state, [value + base for value, base in zip(values, base_of(state), strict=True)])
