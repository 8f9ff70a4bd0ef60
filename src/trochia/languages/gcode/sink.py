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
    from trochia.program import PathMode, Plane, TimeLaw, Tool

Position = Sequence[float]


class Sink(Protocol):
    """A receiver of canonical functions.  ``line`` is the source line of the calls that follow."""

    line: int

    def straight_traverse(self, target: Position) -> None:
        """Go straight to the target, as fast as the axes can."""

    def straight_feed(self, target: Position) -> None:
        """Go straight to the target at the feed."""

    def arc_feed(self, target: Position, centre: tuple[float, float], turns: int, plane: Plane) -> None:
        """Go along an arc or helix about the centre, which is on the plane's axes; turns + = counter-clockwise."""

    def nurbs_feed(self, points: Sequence[tuple[float, float, float]], order: int, target: Position) -> None:
        """Go along a curve of control points (x, y, weight) in the XY plane; the target is its end."""

    def set_spline_time(self, per_minute: float) -> None:
        """Let the next curve last 1/per_minute minutes."""

    def start_synchronised(self, pitch: float) -> None:
        """Lock the moves that follow to the spindle: ``pitch`` units along the way for each turn."""

    def stop_synchronised(self) -> None:
        """Free the moves from the spindle."""

    def rigid_tap(self, start: Position, target: Position, faster: float) -> None:
        """Go straight to the target locked to the spindle, turn it about, come back with ``faster`` times its speed."""

    def straight_probe(self, target: Position, *, toward: bool, must: bool) -> None:
        """Go straight to the target until the probe makes contact or loses it; an error if it ``must`` and does not."""

    def unfinished(self, code: str, why: str) -> None:
        """Note that a code is taken as far as its moves go."""

    def moves(self, rows: Rows) -> None:
        """Take a batch of plain moves, feeds and comments, as the fast path has them."""

    def dwell(self, seconds: float) -> None:
        """Wait [s]."""

    def set_feed_mode(self, law: TimeLaw) -> None:
        """Say what the feed rate is measured in."""

    def set_feed_rate(self, rate: float) -> None:
        """Set the feed [units/min, units/rev]."""

    def set_inverse_time(self, per_minute: float, rate: float) -> None:
        """Let the next move last 1/per_minute minutes; rate is the feed that does it [units/min]."""

    def use_length_units(self, *, inch: bool) -> None:
        """Use inches or millimetres from here on."""

    def select_plane(self, plane: Plane) -> None:
        """Choose the plane of arcs."""

    def set_g5x_offset(self, system: int, offset: Position) -> None:
        """Set the origin of the active coordinate system, 1 for G54, in machine coordinates."""

    def set_g92_offset(self, offset: Position) -> None:
        """Set the shift of all coordinate systems."""

    def set_xy_rotation(self, degrees: float) -> None:
        """Set the turn of the active coordinate system about Z."""

    def use_tool_length_offset(self, offset: Position) -> None:
        """Set the offset of the tool's tip."""

    def set_motion_control_mode(self, mode: PathMode, tolerance: float) -> None:
        """Say how exactly the path is followed; the tolerance is that of blending."""

    def set_naivecam_tolerance(self, tolerance: float) -> None:
        """Say by how much points may be left out along the path."""

    def begin_exact_path(self) -> None:
        """Keep to the path while a canned cycle runs."""

    def end_exact_path(self, mode: PathMode, tolerance: float, along: float) -> None:
        """Follow the path again as before :meth:`begin_exact_path`; the numbers are those that were given then."""

    def set_feed_reference(self) -> None:
        """Say that feeds refer to the part."""

    def set_spindle_mode(self, most: float | None, *, on: bool) -> None:
        """Say whether S is the speed of the cut, with the greatest spindle speed [rpm] (None: no bound)."""

    def set_spindle_speed(self, speed: float) -> None:
        """Set the spindle speed [rpm], or power of the beam."""

    def start_spindle(self, direction: int) -> None:
        """Start spindle or beam: +1 clockwise, -1 counter-clockwise."""

    def stop_spindle(self) -> None:
        """Stop spindle or beam."""

    def orient_spindle(self, degrees: float, direction: int) -> None:
        """Turn the spindle to an angle: 0 the shorter way, 1 clockwise, 2 counter-clockwise."""

    def wait_orient(self, seconds: float) -> None:
        """Wait until the spindle has its angle, at most so long [s]."""

    def feed_override(self, *, on: bool) -> None:
        """Let the operator change the feed, or not."""

    def speed_override(self, *, on: bool) -> None:
        """Let the operator change the spindle speed, or not."""

    def adaptive_feed(self, *, on: bool) -> None:
        """Let the machine change the feed, or not."""

    def feed_hold(self, *, on: bool) -> None:
        """Let the feed-hold switch act, or not."""

    def set_output(self, index: int, value: bool | float, *, synchronised: bool) -> None:  # noqa: FBT001 - a value
        """Set a digital (bool) or analogue (float) output, as the next move begins or at once."""

    def wait_input(self, index: int, *, analogue: bool, wait: int, timeout: float) -> None:
        """Read an input (wait 0), or wait for a rise, a fall, high, low (1 to 4), at most so long [s]."""

    def user_code(self, number: int, p: float | None, q: float | None) -> None:
        """Call a code of the machine's own."""

    def mist(self, *, on: bool) -> None:
        """Switch mist coolant."""

    def flood(self, *, on: bool) -> None:
        """Switch flood coolant."""

    def select_tool(self, tool: int) -> None:
        """Make a tool ready."""

    def start_change(self) -> None:
        """Begin a tool change."""

    def change_tool(self, slot: int, tool: int) -> None:
        """Put a tool into the spindle; ``slot`` is its place in the tool table, from 1 (0: no tool)."""

    def change_tool_number(self, slot: int, tool: int) -> None:
        """Take note of the tool in the spindle."""

    def set_tool_table_entry(self, slot: int, tool: Tool) -> None:
        """Set a tool of the table; slot 0 is the tool in the spindle."""

    def reload_tools(self) -> None:
        """Read the tool table anew."""

    def comment(self, text: str) -> None:
        """Pass on a comment of the program, or a remark of the interpreter."""

    def message(self, text: str) -> None:
        """Tell the operator."""

    def say(self, text: str) -> None:
        """Write a line where the program's output goes (PRINT)."""

    def open_log(self, name: str, *, append: bool) -> None:
        """Open a log file, empty or at its end."""

    def log(self, text: str) -> None:
        """Write a line to the log file."""

    def close_log(self) -> None:
        """Close the log file."""

    def program_stop(self, *, optional: bool) -> None:
        """Wait for the operator, always or only if he wants."""

    def pallet_shuttle(self) -> None:
        """Change pallets."""

    def program_end(self) -> None:
        """End the program."""

    def finish(self) -> None:
        """End a text at its ``%``."""

    def on_reset(self) -> None:
        """Note that the interpreter begins, or has ended."""
