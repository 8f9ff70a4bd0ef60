"""The sink that prints: canonical functions in the spelling of LinuxCNC's stand-alone interpreter.

In: canonical calls.  Out: bytes, one function a line, as ``rs274 -g`` prints them without its first two columns:
program units and coordinates, four decimals, X Y Z A B C (so ``U V W`` cannot be shown).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.kernels.gcode import COMMENT_ROW, FEED_ROW, SPEED_ROW
from trochia.languages.gcode.frames import scaled
from trochia.languages.gcode.interpreter import interpret
from trochia.languages.gcode.reading import USUAL
from trochia.languages.gcode.state import INCH
from trochia.program.modes import MoveKind, PathMode, Plane, TimeLaw

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path
    from typing import BinaryIO

    from trochia.kernels.gcode import Rows
    from trochia.languages.gcode.reading import Reading
    from trochia.languages.gcode.sink import Position
    from trochia.program import Tool

_SIX = "(%.4f, %.4f, %.4f, %.4f, %.4f, %.4f)\n"
_ARC = "ARC_FEED(%.4f, %.4f, %.4f, %.4f, %d, %.4f, %.4f, %.4f, %.4f)\n"
_PLANES = {Plane.XY: "XY", Plane.YZ: "YZ", Plane.ZX: "XZ"}
_MODES = {
    PathMode.BLEND_DEFAULT: "CONTINUOUS, %f",
    PathMode.BLEND: "CONTINUOUS, %f",
    PathMode.EXACT_PATH: "EXACT_PATH",
    PathMode.EXACT_STOP: "EXACT_STOP",
}
_NO_BOUND = 1e30  # rpm, of a constant surface speed without D
_TOOL_OFFSET = "USE_TOOL_LENGTH_OFFSET(%.4f %.4f %.4f, %.4f %.4f %.4f, %.4f %.4f %.4f)\n"


def print_text(text: bytes, out: BinaryIO, *, name: str, block_delete: bool = False, reading: Reading = USUAL) -> None:
    """Write the canonical functions of a program.

    Raises
    ------
    ProgramError
        At the first line that is wrong; what came before it has been written.
    """
    interpret(text, Canon(out.write), name=name, block_delete=block_delete, reading=reading)


def print_program(path: Path, out: BinaryIO) -> None:
    """Write the canonical functions of a program file; errors are those of :func:`print_text`."""
    print_text(path.read_bytes(), out, name=str(path))


class Canon:
    """Prints canonical functions by ``write``, which takes bytes."""

    def __init__(self, write: Callable[[bytes], object]) -> None:
        self.line = 0
        self._write = write

    def _print(self, text: str) -> None:
        self._write(text.encode("latin-1"))

    def straight_traverse(self, target: Position) -> None:
        """Print a rapid move."""
        self._print("STRAIGHT_TRAVERSE" + _SIX % tuple(target[:6]))

    def straight_feed(self, target: Position) -> None:
        """Print a feed move."""
        self._print("STRAIGHT_FEED" + _SIX % tuple(target[:6]))

    def arc_feed(self, target: Position, centre: tuple[float, float], turns: int, plane: Plane) -> None:
        """Print an arc: end and centre on the plane's axes, turns, height of the end, rotary axes."""
        first, second = plane.axes
        self._print(_ARC % (target[first], target[second], *centre, turns, target[plane.normal], *target[3:6]))

    def nurbs_feed(self, points: Sequence[tuple[float, float, float]], order: int, target: Position) -> None:
        """Print how many control points a curve has."""
        del order, target
        self._print(f"NURBS_FEED({len(points)}, ...)\n")

    def set_spline_time(self, per_minute: float) -> None:
        """Print nothing, as the reference."""

    def start_synchronised(self, pitch: float) -> None:
        """Print the pitch of the moves locked to the spindle."""
        self._print(f"START_SPEED_FEED_SYNC({pitch:f},0)\n")

    def stop_synchronised(self) -> None:
        """Print the end of the moves locked to the spindle."""
        self._print("STOP_SPEED_FEED_SYNCH()\n")

    def rigid_tap(self, start: Position, target: Position, faster: float) -> None:
        """Print a rigid tap."""
        del start, faster
        self._print(f"RIGID_TAP({target[0]:.4f}, {target[1]:.4f}, {target[2]:.4f})\n")

    def straight_probe(self, target: Position, *, toward: bool, must: bool) -> None:
        """Print a probing move."""
        del toward, must
        self._print("TURN_PROBE_ON()\nSTRAIGHT_PROBE" + _SIX % tuple(target[:6]) + "TURN_PROBE_OFF()\n")

    def unfinished(self, code: str, why: str) -> None:
        """Print nothing: the reference takes these codes without a word."""

    def moves(self, rows: Rows) -> None:
        """Print a batch of the fast path."""
        at = 0
        while at < len(rows):
            text, at = rows.canon(at)
            self._write(text)
            if at < len(rows):  # a number too long for the C printer
                self._row(rows, at)
                at += 1

    def _row(self, rows: Rows, at: int) -> None:
        row = rows[at]
        if row.kind == COMMENT_ROW:
            self.comment(rows.comment(at))
        elif row.kind == FEED_ROW:
            self.set_feed_rate(row.rate)
        elif row.kind == SPEED_ROW:
            self.set_spindle_speed(row.rate)
        elif row.kind == MoveKind.ARC:
            self.arc_feed(list(row.target), (row.centre[0], row.centre[1]), row.turns, Plane(row.plane))
        elif row.kind == MoveKind.FEED:
            self.straight_feed(list(row.target))
        else:
            self.straight_traverse(list(row.target))

    def dwell(self, seconds: float) -> None:
        """Print a dwell."""
        self._print(f"DWELL({seconds:.4f})\n")

    def set_feed_mode(self, law: TimeLaw) -> None:
        """Print whether the feed is per revolution."""
        self._print(f"SET_FEED_MODE(0, {int(law == TimeLaw.PER_REV)})\n")

    def set_feed_rate(self, rate: float) -> None:
        """Print the feed."""
        self._print(f"SET_FEED_RATE({rate:.4f})\n")

    def set_inverse_time(self, per_minute: float, rate: float) -> None:
        """Print the feed that makes a move last as long as inverse time asks."""
        del per_minute
        self.set_feed_rate(rate)

    def use_length_units(self, *, inch: bool) -> None:
        """Print the length units."""
        self._print(f"USE_LENGTH_UNITS(CANON_UNITS_{'INCHES' if inch else 'MM'})\n")

    def select_plane(self, plane: Plane) -> None:
        """Print the plane."""
        self._print(f"SELECT_PLANE(CANON_PLANE_{_PLANES[plane]})\n")

    def set_g5x_offset(self, system: int, offset: Position) -> None:
        """Print a coordinate system's origin."""
        self._print(f"SET_G5X_OFFSET({system}, " + (_SIX % tuple(offset[:6]))[1:])

    def set_g92_offset(self, offset: Position) -> None:
        """Print the shift of all coordinate systems."""
        self._print("SET_G92_OFFSET" + _SIX % tuple(offset[:6]))

    def set_xy_rotation(self, degrees: float) -> None:
        """Print the turn of the coordinate system."""
        self._print(f"SET_XY_ROTATION({degrees:.4f})\n")

    def use_tool_length_offset(self, offset: Position) -> None:
        """Print the tool length offset."""
        self._print(_TOOL_OFFSET % tuple(offset))

    def set_motion_control_mode(self, mode: PathMode, tolerance: float) -> None:
        """Print the path mode."""
        text = _MODES[mode]
        self._print(f"SET_MOTION_CONTROL_MODE(CANON_{text % tolerance if '%' in text else text})\n")

    def set_naivecam_tolerance(self, tolerance: float) -> None:
        """Print the tolerance of merging points."""
        self._print(f"SET_NAIVECAM_TOLERANCE({tolerance:.4f})\n")

    def begin_exact_path(self) -> None:
        """Print the path mode of a canned cycle."""
        self.set_motion_control_mode(PathMode.EXACT_PATH, 0.0)

    def end_exact_path(self, mode: PathMode, tolerance: float, along: float) -> None:
        """Print the path mode after a canned cycle."""
        self.set_motion_control_mode(mode, tolerance)
        self.set_naivecam_tolerance(along)

    def set_feed_reference(self) -> None:
        """Print what the feed refers to."""
        self._print("SET_FEED_REFERENCE(CANON_XYZ)\n")

    def set_spindle_mode(self, most: float | None, *, on: bool) -> None:
        """Print what S is: 0, or the greatest spindle speed where it is the speed of the cut."""
        self._print(f"SET_SPINDLE_MODE(0 {(_NO_BOUND if most is None else most) if on else 0.0:.4f})\n")

    def set_spindle_speed(self, speed: float) -> None:
        """Print the spindle speed."""
        self._print(f"SET_SPINDLE_SPEED(0, {speed:.4f})\n")

    def start_spindle(self, direction: int) -> None:
        """Print the spindle's start."""
        self._print(f"START_SPINDLE_{'CLOCKWISE' if direction > 0 else 'COUNTERCLOCKWISE'}(0)\n")

    def stop_spindle(self) -> None:
        """Print the spindle's stop."""
        self._print("STOP_SPINDLE_TURNING(0)\n")

    def orient_spindle(self, degrees: float, direction: int) -> None:
        """Print the spindle's turn to an angle."""
        self._print(f"ORIENT_SPINDLE(0, {degrees:.4f}, {direction})\n")

    def wait_orient(self, seconds: float) -> None:
        """Print the wait for the spindle's angle."""
        self._print(f"SPINDLE.0.WAIT_ORIENT_COMPLETE({seconds:.4f})\n")

    def feed_override(self, *, on: bool) -> None:
        """Print whether the operator may change the feed."""
        self._print(f"{'ENABLE' if on else 'DISABLE'}_FEED_OVERRIDE()\n")

    def speed_override(self, *, on: bool) -> None:
        """Print whether the operator may change the spindle speed."""
        self._print(f"{'ENABLE' if on else 'DISABLE'}_SPEED_OVERRIDE(0)\n")

    def adaptive_feed(self, *, on: bool) -> None:
        """Print whether the machine may change the feed."""
        self._print(f"{'EN' if on else 'DIS'}ABLE_ADAPTIVE_FEED()\n")

    def feed_hold(self, *, on: bool) -> None:
        """Print whether the feed-hold switch acts."""
        self._print(f"{'EN' if on else 'DIS'}ABLE_FEED_HOLD()\n")

    def set_output(self, index: int, value: bool | float, *, synchronised: bool) -> None:  # noqa: FBT001 - a value
        """Print an output."""
        kind = "MOTION" if synchronised else "AUX"
        if isinstance(value, bool):
            self._print(f"{'SET' if value else 'CLEAR'}_{kind}_OUTPUT_BIT({index})\n")
        else:
            self._print(f"SET_{kind}_OUTPUT_VALUE({index},{value:.6f})\n")

    def wait_input(self, index: int, *, analogue: bool, wait: int, timeout: float) -> None:
        """Nothing: the reference does not print it."""

    def user_code(self, number: int, p: float | None, q: float | None) -> None:
        """Print a code of the machine's own: its P and Q, -1 where not given, as the reference hands them over."""
        self._print(f"USER_DEFINED_FUNCTION({number}, {-1 if p is None else p:.4f}, {-1 if q is None else q:.4f})\n")

    def mist(self, *, on: bool) -> None:
        """Print mist coolant."""
        self._print(f"MIST_{'ON' if on else 'OFF'}()\n")

    def flood(self, *, on: bool) -> None:
        """Print flood coolant."""
        self._print(f"FLOOD_{'ON' if on else 'OFF'}()\n")

    def select_tool(self, tool: int) -> None:
        """Print the tool made ready."""
        self._print(f"SELECT_TOOL({tool})\n")

    def start_change(self) -> None:
        """Print the beginning of a tool change."""
        self._print("START_CHANGE()\n")

    def change_tool(self, slot: int, tool: int) -> None:
        """Print the tool change, with the tool's place in the table."""
        del tool
        self._print(f"CHANGE_TOOL({slot})\n")

    def change_tool_number(self, slot: int, tool: int) -> None:
        """Print the tool in the spindle, by its place in the table."""
        del tool
        self._print(f"CHANGE_TOOL_NUMBER({slot})\n")

    def set_tool_table_entry(self, slot: int, tool: Tool) -> None:
        """Print a tool of the table, its offset in inches, as the reference alone keeps it."""
        offset = " ".join(f"{value:.4f}" for value in scaled(tool.offset, 1 / INCH))
        angles = f"{tool.front:.4f}, {tool.back:.4f}, {tool.orientation}"
        self._print(f"SET_TOOL_TABLE_ENTRY({slot}, {tool.number}, {offset}, {angles})\n")

    def reload_tools(self) -> None:
        """Print that the tool table is read anew."""
        self._print("RELOAD_TOOLDATA()\n")

    def comment(self, text: str) -> None:
        """Print a comment."""
        self._print(f'COMMENT("{text}")\n')

    def message(self, text: str) -> None:
        """Print a message."""
        self._print(f'MESSAGE("{text}")\n')

    def say(self, text: str) -> None:
        """Print what the program prints, as it is."""
        self._print(f"{text}\n")

    def open_log(self, name: str, *, append: bool) -> None:
        """Print that a log is opened; nothing is written to it."""
        self._print(f'LOG{"APPEND" if append else "OPEN"}("{name}")\n')

    def log(self, text: str) -> None:
        """Print a line of the log."""
        self._print(f'LOG("{text}")\n')

    def close_log(self) -> None:
        """Print that the log is closed."""
        self._print("LOGCLOSE()\n")

    def program_stop(self, *, optional: bool) -> None:
        """Print a stop."""
        self._print(f"{'OPTIONAL_' if optional else ''}PROGRAM_STOP()\n")

    def pallet_shuttle(self) -> None:
        """Print the change of pallets."""
        self._print("PALLET_SHUTTLE()\n")

    def program_end(self) -> None:
        """Print the end of the program."""
        self._print("PROGRAM_END()\n")

    def finish(self) -> None:
        """Print that the text ended at its ``%``."""
        self._print("FINISH()\n")

    def on_reset(self) -> None:
        """Print a reset."""
        self._print("ON_RESET()\n")
