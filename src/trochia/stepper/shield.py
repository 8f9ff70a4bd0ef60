"""The motor shield: two motors on two H bridges behind one shift register, under the names its users know.

In: revolutions a minute, counts of steps, a way of excitation.  Out: the register's byte and the windings' levels at
every step.  A position counts sixty-fourths of an electrical turn, eight to a sector: one phase is on in even sectors,
both in odd ones, so a step in another way of excitation first falls in with its own sectors.
"""

from __future__ import annotations

from collections import deque
from enum import Enum
from typing import TYPE_CHECKING

from trochia.errors import ConfigError, LimitError
from trochia.pulses.excitation import half_step, table_microstep
from trochia.pulses.latch import BITS, latch_byte
from trochia.stepper import checks

if TYPE_CHECKING:
    from trochia.stepper.outputs import StepOutput
    from trochia.stepper.shield_twin import ShieldTwin
    from trochia.stepper.times import Time

FORWARD, BACKWARD = 1, -1
_TURN, _SECTOR = 64, 8  # positions in an electrical turn and in a sector
_KEPT = 4096  # register bytes that are remembered
_HALF, _MICRO = half_step().levels, table_microstep().levels


class Style(Enum):
    """Ways of excitation: positions from one step to the next, and the first of them in a turn."""

    SINGLE = (16, 0)
    DOUBLE = (16, 8)
    INTERLEAVE = (8, 0)
    MICROSTEP = (1, 0)

    def after(self, position: int, direction: int) -> int:
        """Return the next position of this way, forwards (1) or backwards (-1)."""
        grid, first = self.value
        shifted = position - first
        return first + grid * (shifted // grid + 1 if direction > 0 else -(-shifted // grid) - 1)

    @property
    def division(self) -> int:
        """Steps for a full one."""
        return 16 // self.value[0]


SINGLE, DOUBLE, INTERLEAVE, MICROSTEP = Style


class Shield:
    """The register that both motors share.

    Attributes
    ----------
    image
        Its byte.
    twins
        By port: what the motors make of their steps, where somebody put them there.
    latched
        When it was loaded [s] and with what, the last few thousand times.
    """

    def __init__(self, time: Time) -> None:
        self.time = time
        self.image = 0
        self.twins: dict[int, ShieldTwin] = {}
        self.latched: deque[tuple[float, int]] = deque(maxlen=_KEPT)

    def motor(self, port: int, steps_per_turn: int = 200, output: StepOutput | None = None, *,
              whole_milliseconds: bool = False, work: float = 0.0) -> ShieldMotor:  # fmt: skip
        """Return the motor on port 1 or 2; parameters and errors as of :class:`ShieldMotor`."""
        return ShieldMotor(self, port, steps_per_turn, output, whole_milliseconds=whole_milliseconds, work=work)

    def stepped(self, port: int, moment: float, position: int, direction: int, style: Style) -> None:
        """Have a motor's step made: by its twin, and by a board where the shield is on one."""
        if port in self.twins:
            self.twins[port].excite(moment, position, direction, style)

    def released(self, port: int, moment: float) -> None:
        """Have a motor released."""
        if port in self.twins:
            self.twins[port].release(moment)

    def latch(self, moment: float, byte: int) -> None:
        """Load the register at a moment [s]."""
        self.image = byte
        self.latched.append((moment, byte))


class ShieldMotor:
    """One motor of the shield.

    Parameters
    ----------
    output
        Where its steps go beside the register: a twin, say.
    whole_milliseconds
        Wait whole milliseconds between steps, as the shield's own library does, the rest carried on; else exactly.
    work
        What a step takes beside its wait of whole milliseconds [s]; of that library ``pulses.latch.STEP_WORK``.

    Raises
    ------
    ConfigError
        For another port than 1 or 2, or a turn without steps.
    """

    def __init__(self, shield: Shield, port: int, steps_per_turn: int, output: StepOutput | None, *,
                 whole_milliseconds: bool, work: float = 0.0) -> None:  # fmt: skip
        if port not in BITS or steps_per_turn < 1:
            raise ConfigError(f"the shield has the ports 1 and 2, and a turn has steps; not {port}, {steps_per_turn}")
        self.shield = shield
        self.port = port
        self.steps_per_turn = steps_per_turn
        self.output = output
        self.position = 0  #: in sixty-fourths of an electrical turn
        self.levels = (0.0, 0.0)  #: of its phases, parts of the supply
        self._whole, self._work = whole_milliseconds, work
        self._full_step = 0.0
        self._released = False

    def set_speed(self, rpm: float) -> None:
        """Set the speed of ``step`` [rpm].

        Raises
        ------
        LimitError
            Unless it is above 0.
        """
        turns = checks.positive("speed", rpm, "rpm", checks.TURNS, "To stand still, release().")
        self._full_step = 60.0 / (self.steps_per_turn * turns)

    def step(self, count: int, direction: int = FORWARD, style: Style = SINGLE) -> None:
        """Make steps and wait for the last one's time to pass.

        ``count`` is in full steps, but in half steps for INTERLEAVE; a full step of MICROSTEP is sixteen.

        Raises
        ------
        LimitError
            When no speed was set, for a count that is not whole or below 0, and as ``onestep``.
        """
        if not self._full_step:
            raise LimitError("step() needs a speed", hint="set_speed() first.")
        _check(direction, style)
        if checks.whole("count", count) < 0:
            raise LimitError(f"the count must not be below 0, not {count}", hint="Backwards is step(…, BACKWARD).")
        interval = self._full_step / style.division
        begin = self.shield.time.now
        for done in range(1, int(count) * (style.division if style is MICROSTEP else 1) + 1):
            self.onestep(direction, style)
            passed = done * interval
            if self._whole:
                passed = (done * int(interval * 1e6 + 1e-6) // 1000) / 1000 + done * self._work
            self.shield.time.wait_until(begin + passed)

    def onestep(self, direction: int, style: Style, moment: float | None = None) -> None:
        """Make one step now, or at a moment that is due [s].

        Raises
        ------
        LimitError
            For a direction or a way of excitation that there is not.
        """
        _check(direction, style)
        at = self.shield.time.now if moment is None else moment
        self.position = style.after(self.position, direction) % _TURN
        row = _MICRO[self.position] if style is MICROSTEP else _HALF[self.position // _SECTOR]
        self._drive(at, (float(row[0]), float(row[1])))
        self.shield.stepped(self.port, at, self.position, direction, style)
        if self.output is not None:
            if self._released:  # a step puts the windings on again
                self.output.energise(at, on=True)
            self.output.step(at, direction)
        self._released = False

    def release(self) -> None:
        """Clear the motor's bits: both ends of its windings are low, which shorts them rather than leaves them open."""
        self._drive(self.shield.time.now, (0.0, 0.0))
        self.shield.released(self.port, self.shield.time.now)
        if self.output is not None:
            self.output.energise(self.shield.time.now, on=False)
        self._released = True

    def _drive(self, moment: float, levels: tuple[float, float]) -> None:
        """Put the phases to levels; the other motor's bits stay."""
        self.levels = levels
        self.shield.latch(moment, latch_byte(levels, self.port, self.shield.image))


def _check(direction: object, style: object) -> None:
    """Refuse a direction or a way of excitation that there is not."""
    if direction not in {FORWARD, BACKWARD}:
        raise LimitError(f"a step is FORWARD (1) or BACKWARD (-1), not {direction!r}")
    if not isinstance(style, Style):
        raise LimitError(f"a step is made in {', '.join(Style.__members__)}, not {style!r}")
