"""What happens between moves.  An action stands *before* the move with index ``at`` (``at == len(moves)``: the end)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar


@dataclass(frozen=True, slots=True, kw_only=True)
class Action:
    """Something that is not motion; ``line`` is its source line.

    ``at_rest`` says whether motion comes to rest before it acts; where it does not, the action takes effect as the
    next move begins.
    """

    at_rest: ClassVar[bool] = True

    at: int
    line: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Dwell(Action):
    """Wait (s)."""

    seconds: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Spindle(Action):
    """Spindle or beam: direction +1 clockwise (M3), -1 counter-clockwise (M4), 0 off (M5); speed as S gave it (rpm).

    It stands where the direction changes; another speed while it turns is the moves' power, and stops nothing.
    """

    direction: int
    speed: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SurfaceSpeed(Action):
    """Constant surface speed (G96): S is the speed of the cut; ``most`` (rpm, None: no bound).  False: S is rpm."""

    at_rest: ClassVar[bool] = False
    on: bool
    most: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Orient(Action):
    """Turn the spindle to an angle (deg) and hold it there (M19).

    ``way``: 0 the shorter way, 1 clockwise, 2 counter-clockwise; ``timeout`` (s), None: do not wait for it.
    """

    angle: float | None
    way: int
    timeout: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Coolant(Action):
    """Coolant as it is from here on: mist (M7) and flood (M8)."""

    mist: bool
    flood: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolChange(Action):
    """Change to a tool (M6)."""

    tool: int


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolNumber(Action):
    """Take note that this tool is in the spindle (M61); nothing moves."""

    at_rest: ClassVar[bool] = False
    tool: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Output(Action):
    """Set a digital (bool) or analogue (float) output, at rest and at once (M64, M65, M68)."""

    index: int
    value: bool | float


@dataclass(frozen=True, slots=True, kw_only=True)
class SynchronisedOutput(Action):
    """Set a digital (bool) or analogue (float) output as the next move begins (M62, M63, M67)."""

    at_rest: ClassVar[bool] = False
    index: int
    value: bool | float


@dataclass(frozen=True, slots=True, kw_only=True)
class WaitInput(Action):
    """Read an input (M66), or wait for it.

    ``wait``: 0 read it now, 1 rise, 2 fall, 3 high, 4 low; ``timeout`` (s).
    """

    index: int
    analogue: bool
    wait: int
    timeout: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Override(Action):
    """Let the operator's override ``kind`` act or not: ``feed``, ``speed``, ``adaptive`` or ``hold`` (M48 to M53)."""

    at_rest: ClassVar[bool] = False
    kind: str
    on: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class UserCode(Action):
    """A code of the user's own (M100 to M199) with its P and Q; None: not given."""

    number: int
    p: float | None
    q: float | None

    def __str__(self) -> str:
        """Return it as a program spells it."""
        given = ((letter, value) for letter, value in (("P", self.p), ("Q", self.q)) if value is not None)
        return " ".join([f"M{self.number}", *(f"{letter}{value:g}" for letter, value in given)])


@dataclass(frozen=True, slots=True, kw_only=True)
class Message(Action):
    """Text for the operator; motion goes on."""

    at_rest: ClassVar[bool] = False

    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Log(Message):
    """A line for the program's log ``file``, told to the operator, too.

    ``opens``: there is no line, the file begins here, or goes on where it ended (``append``).
    """

    file: str
    opens: bool = False
    append: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Pause(Action):
    """Program stop (M0), or optional stop (M1)."""

    optional: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Probe(Action):
    """Probe on the next move: until contact (``toward`` the part) or its loss; an error if it ``must`` and does not."""

    toward: bool
    must: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class SpindleLock(Action):
    """Lock the moves from here on to the spindle, ``pitch`` mm along the way for each turn; 0: free them."""

    pitch: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Unfinished(Action):
    """A code that is taken as far as its moves go (G87, G88); ``why`` says what is missing."""

    code: str
    why: str


@dataclass(frozen=True, slots=True, kw_only=True)
class End(Action):
    """Program end (M2, M30): spindle, beam and coolant off."""
