"""The part of the program builder that takes what is told to the machine besides moves: actions, in their order.

In: canonical calls.  Out: actions of :class:`~trochia.languages.gcode.builder.Builder`, which inherits this.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.program import (
    Coolant,
    Dwell,
    End,
    Log,
    Message,
    Orient,
    Output,
    Override,
    Pause,
    Spindle,
    SurfaceSpeed,
    SynchronisedOutput,
    ToolChange,
    ToolNumber,
    UserCode,
    WaitInput,
)

if TYPE_CHECKING:
    from trochia.program import Action, Tool


class ToldActions:
    """Dwells, spindle, overrides, outputs, inputs, coolant, tools, messages, stops.

    An action stands only where it changes something.
    """

    line: int
    _actions: list[Action]
    _direction: int
    _speed: float | None
    _surface: bool
    _mist: bool
    _flood: bool
    _log: str | None = None  # the log that is open

    @property
    def _at(self) -> int:
        """Return the index of the next move."""
        raise NotImplementedError

    def dwell(self, seconds: float) -> None:
        """Wait."""
        self._actions.append(Dwell(at=self._at, line=self.line, seconds=seconds))

    def set_spindle_mode(self, most: float | None, *, on: bool) -> None:
        """Let S mean something else; no action where it goes on to mean the same."""
        if on or self._surface:
            self._actions.append(SurfaceSpeed(at=self._at, line=self.line, on=on, most=most))
        self._surface = on

    def set_spindle_speed(self, speed: float) -> None:
        """Use another speed or power, which the moves carry."""
        self._speed = speed

    def start_spindle(self, direction: int) -> None:
        """Start the spindle or beam."""
        self._turn_spindle(direction)

    def stop_spindle(self) -> None:
        """Stop the spindle or beam."""
        self._turn_spindle(0)

    def _turn_spindle(self, direction: int) -> None:
        """Keep the direction; an action stands only where it changes."""
        if direction != self._direction:
            act = Spindle(at=self._at, line=self.line, direction=direction, speed=self._speed or 0.0)
            self._actions.append(act)
        self._direction = direction

    def wait_orient(self, seconds: float) -> None:
        """Wait for the angle that was asked last."""
        self._actions.append(Orient(at=self._at, line=self.line, angle=None, way=0, timeout=seconds))

    def adaptive_feed(self, *, on: bool) -> None:
        """Let the machine change the feed, or not."""
        self._override("adaptive", on=on)

    def feed_hold(self, *, on: bool) -> None:
        """Let the feed-hold switch act, or not."""
        self._override("hold", on=on)

    def _override(self, kind: str, *, on: bool) -> None:
        self._actions.append(Override(at=self._at, line=self.line, kind=kind, on=on))

    def set_output(self, index: int, value: bool | float, *, synchronised: bool) -> None:  # noqa: FBT001 - a value
        """Set an output."""
        kind = SynchronisedOutput if synchronised else Output
        self._actions.append(kind(at=self._at, line=self.line, index=index, value=value))

    def wait_input(self, index: int, *, analogue: bool, wait: int, timeout: float) -> None:
        """Wait for an input."""
        act = WaitInput(at=self._at, line=self.line, index=index, analogue=analogue, wait=wait, timeout=timeout)
        self._actions.append(act)

    def user_code(self, number: int, p: float | None, q: float | None) -> None:
        """Call a code of the machine's own."""
        self._actions.append(UserCode(at=self._at, line=self.line, number=number, p=p, q=q))

    def orient_spindle(self, degrees: float, direction: int) -> None:
        """Turn the spindle to an angle, where it stays."""
        self._direction = 0
        way = min(direction, 2)  # 3 is G87's own number for counter-clockwise
        self._actions.append(Orient(at=self._at, line=self.line, angle=degrees, way=way, timeout=None))

    def feed_override(self, *, on: bool) -> None:
        """Let the operator change the feed, or not."""
        self._override("feed", on=on)

    def speed_override(self, *, on: bool) -> None:
        """Let the operator change the spindle speed, or not."""
        self._override("speed", on=on)

    def mist(self, *, on: bool) -> None:
        """Switch mist."""
        self._cool(mist=on, flood=self._flood)

    def flood(self, *, on: bool) -> None:
        """Switch flood."""
        self._cool(mist=self._mist, flood=on)

    def _cool(self, *, mist: bool, flood: bool) -> None:
        if (mist, flood) != (self._mist, self._flood):
            self._actions.append(Coolant(at=self._at, line=self.line, mist=mist, flood=flood))
        self._mist, self._flood = mist, flood

    def select_tool(self, tool: int) -> None:
        """Nothing: the change is what counts."""

    def start_change(self) -> None:
        """Nothing: the change follows."""

    def change_tool_number(self, slot: int, tool: int) -> None:
        """Take note of the tool in the spindle."""
        del slot
        self._actions.append(ToolNumber(at=self._at, line=self.line, tool=tool))

    def set_tool_table_entry(self, slot: int, tool: Tool) -> None:
        """Nothing: moves are made with the offset in force."""

    def reload_tools(self) -> None:
        """Nothing: the table is what it was when the program began."""

    def change_tool(self, slot: int, tool: int) -> None:
        """Change the tool."""
        del slot
        self._actions.append(ToolChange(at=self._at, line=self.line, tool=tool))

    def comment(self, text: str) -> None:
        """Nothing: a comment is no action."""

    def message(self, text: str) -> None:
        """Tell the operator."""
        self._actions.append(Message(at=self._at, line=self.line, text=text))

    def say(self, text: str) -> None:
        """Tell the operator."""
        self.message(text)

    def open_log(self, name: str, *, append: bool) -> None:
        """Begin a log; who runs the program writes it."""
        self._log = name.strip()
        self._actions.append(Log(at=self._at, line=self.line, text="", file=self._log, opens=True, append=append))

    def log(self, text: str) -> None:
        """Tell the operator, and the log that is open."""
        if self._log is None:
            self.message(text)
        else:
            self._actions.append(Log(at=self._at, line=self.line, text=text, file=self._log))

    def close_log(self) -> None:
        """Close the log."""
        self._log = None

    def program_stop(self, *, optional: bool) -> None:
        """Wait for the operator."""
        self._actions.append(Pause(at=self._at, line=self.line, optional=optional))

    def pallet_shuttle(self) -> None:
        """Nothing: no machine here has pallets."""

    def program_end(self) -> None:
        """End the program."""
        self._actions.append(End(at=self._at, line=self.line))

    def finish(self) -> None:
        """Nothing: the text ended without an end code."""

    def on_reset(self) -> None:
        """Nothing: no state of the interpreter reaches the program."""
