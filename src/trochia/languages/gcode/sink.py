"""What the interpreter drives: the canonical functions, in the vocabulary of the RS274/NGC report.

Everything is in program units and program coordinates, as the language has it at that moment; a sink that wants
machine coordinates (:mod:`trochia.languages.gcode.builder`) follows units, offsets and rotation by the same calls.
Positions are lists of nine numbers in the order of :data:`trochia.program.AXES`, never kept or changed by the sink.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from trochia.kernels.gcode import Rows
    from trochia.program import PathMode, Plane, TimeLaw

Position = Sequence[float]


class Sink(Protocol):
    """A receiver of canonical functions.  ``line`` is the source line of the calls that follow."""

    line: int

    def straight_traverse(self, target: Position) -> None: ...  # noqa: D102
    def straight_feed(self, target: Position) -> None: ...  # noqa: D102
    def arc_feed(self, target: Position, centre: tuple[float, float], turns: int, plane: Plane) -> None: ...  # noqa: D102
    def moves(self, rows: Rows) -> None: ...  # noqa: D102

    def dwell(self, seconds: float) -> None: ...  # noqa: D102
    def set_feed_mode(self, law: TimeLaw) -> None: ...  # noqa: D102
    def set_feed_rate(self, rate: float) -> None: ...  # noqa: D102
    def set_inverse_time(self, per_minute: float, rate: float) -> None: ...  # noqa: D102

    def use_length_units(self, *, inch: bool) -> None: ...  # noqa: D102
    def select_plane(self, plane: Plane) -> None: ...  # noqa: D102
    def set_g5x_offset(self, system: int, offset: Position) -> None: ...  # noqa: D102
    def set_g92_offset(self, offset: Position) -> None: ...  # noqa: D102
    def set_xy_rotation(self, degrees: float) -> None: ...  # noqa: D102
    def use_tool_length_offset(self, offset: Position) -> None: ...  # noqa: D102
    def set_motion_control_mode(self, mode: PathMode, tolerance: float) -> None: ...  # noqa: D102
    def set_naivecam_tolerance(self, tolerance: float) -> None: ...  # noqa: D102
    def set_feed_reference(self) -> None: ...  # noqa: D102

    def set_spindle_mode(self) -> None: ...  # noqa: D102
    def set_spindle_speed(self, speed: float) -> None: ...  # noqa: D102
    def start_spindle(self, direction: int) -> None: ...  # noqa: D102
    def stop_spindle(self) -> None: ...  # noqa: D102
    def mist(self, *, on: bool) -> None: ...  # noqa: D102
    def flood(self, *, on: bool) -> None: ...  # noqa: D102
    def select_tool(self, tool: int) -> None: ...  # noqa: D102
    def start_change(self) -> None: ...  # noqa: D102
    def change_tool(self, tool: int) -> None: ...  # noqa: D102

    def comment(self, text: str) -> None: ...  # noqa: D102
    def message(self, text: str) -> None: ...  # noqa: D102
    def program_stop(self, *, optional: bool) -> None: ...  # noqa: D102
    def pallet_shuttle(self) -> None: ...  # noqa: D102
    def program_end(self) -> None: ...  # noqa: D102
    def finish(self) -> None: ...  # noqa: D102
    def on_reset(self) -> None: ...  # noqa: D102
