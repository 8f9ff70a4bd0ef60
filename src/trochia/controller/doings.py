"""What a program's actions do to outputs, and its S to the beam.

In: actions, portions of motion.  Out: outputs by name, beam power.  What waits for somebody is the job's business;
what the live controller cannot do is refused before anything moves.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.backends.live import BUILT_IN
from trochia.errors import LocalProtocolError
from trochia.program import (
    Action,
    Coolant,
    End,
    Message,
    Output,
    Probe,
    Spindle,
    SpindleLock,
    SynchronisedOutput,
    Unfinished,
    WaitInput,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from numpy.typing import NDArray

    from trochia.machine.machine import Machine
    from trochia.planner.live import Portion
    from trochia.program import Program

OUTPUTS_OFF: Mapping[str, float] = dict[str, float].fromkeys(BUILT_IN, 0.0)  #: spindle and coolant off

#: actions that need more than this controller has, and what they are called
CANNOT: dict[type[Action], str] = {
    SpindleLock: "motion locked to the spindle",
    Unfinished: "a cycle that is not complete",
}


class Doings:
    """The outputs of one program on one machine.

    Parameters
    ----------
    dark
        Whether beam and spindle stay off.
    after
        Of the part of the program that was run before this.

    Attributes
    ----------
    spindle
        Override of its speed, as a fraction.
    speed
        Signed spindle speed the program asked for last, before the override [rpm].
    told
        What the program has said to its operator, and to its log, so far.
    dynamic
        Whether M4 was the last to turn spindle or beam on, at the program's end.

    Raises
    ------
    LocalProtocolError
        As :func:`check`.
    """

    def __init__(
        self, program: Program, machine: Machine, *, dark: bool, spindle: float = 1.0, after: Doings | None = None
    ) -> None:
        self.spindle, self.speed = spindle, 0.0 if after is None else after.speed
        self.told: list[Message] = [] if after is None else after.told
        self._once: set[int] = {id(action) for action in self.told}
        self._machine, self._dark = machine, dark
        before = after is not None and after.dynamic
        self._dynamic = dynamic_moves(program, begin=before)
        turns = [action.direction for action in program.actions if isinstance(action, Spindle)]
        self.dynamic = turns[-1] < 0 if turns else before
        check(program, machine)

    def sets(self, action: Action) -> Iterator[tuple[str, float]]:
        """Yield the outputs an action sets, by name."""
        match action:
            case Spindle(direction=direction, speed=speed):
                self.speed = direction * speed
                yield from self.turning()
            case Coolant(mist=mist, flood=flood):
                yield from (("mist", float(mist)), ("flood", float(flood)))
            case End():
                self.speed = 0.0
                yield from (("spindle", 0.0), ("mist", 0.0), ("flood", 0.0))
            case Output() | SynchronisedOutput():
                yield _output(self._machine, action), float(action.value)
            case Message() if id(action) not in self._once:  # after a hold what was sent is sent again
                self._once.add(id(action))
                self.told.append(action)
            case _:
                pass

    @property
    def last_words(self) -> str:
        """Return what the program has said last; nothing if it has not yet."""
        return next((told.text.strip() for told in reversed(self.told) if told.text), "")

    def turning(self) -> Iterator[tuple[str, float]]:
        """Yield the spindle's output: nothing where S means the beam."""
        if self._machine.spindle is None and self._machine.beam is not None:
            return
        speed = 0.0 if self._dark else self.speed * self.spindle
        if self._machine.spindle is not None:
            most = self._machine.spindle.maximum
            speed = min(max(speed, -most), most)
        yield "spindle", speed

    def power(self, part: Portion, times: NDArray[np.float64]) -> NDArray[np.float32]:
        """Return the factor (times,) by which the beam's power follows the path speed where M4 asks for it."""
        beam = self._machine.beam
        if beam is None or beam.kind != "power" or not self._dynamic.any():
            return np.ones(len(times), np.float32)
        states = part.states(times)
        rows = states["segment"]
        moves = np.minimum(part.segments["move"][rows], len(self._dynamic) - 1)
        with np.errstate(divide="ignore", invalid="ignore"):
            most = beam.full_power / np.maximum(part.power[rows], 1e-9)
            factor = np.minimum(states["v"] / part.segments["speed_limit"][rows], most)
        return np.where(self._dynamic[moves], factor, 1.0).astype(np.float32)


def check(program: Program, machine: Machine) -> None:
    """Refuse what cannot be run on this machine.

    Raises
    ------
    LocalProtocolError
        When the program has an action of :data:`CANNOT`, or uses an output, an input or a probe that is not there.
    """
    for action in program.actions:
        if type(action) in CANNOT:
            raise LocalProtocolError(f"line {action.line}: {CANNOT[type(action)]} cannot be run live yet")
        match action:
            case Output() | SynchronisedOutput():
                _output(machine, action)
            case WaitInput():
                input_of(machine, action)
            case Probe() if machine.probe is None:
                raise LocalProtocolError(f"line {action.line}: the machine has no probe",
                                         hint="Name its input in the machine file, under [probe].")  # fmt: skip
            case _:
                pass


def input_of(machine: Machine, action: WaitInput) -> str:
    """Return the name of the input that M66 calls by number: the machine file's inputs of that kind, in its order.

    Raises
    ------
    LocalProtocolError
        When there is none.
    """
    kind = "analog-input" if action.analogue else "input"
    names = [channel.name for channel in machine.io if channel.kind == kind]
    if action.index < len(names):
        return names[action.index]
    raise _missing(action, "input", analogue=action.analogue)


def _output(machine: Machine, action: Output | SynchronisedOutput) -> str:
    analogue = not isinstance(action.value, bool)
    name = output_name(machine, action.index, analogue=analogue)
    if name is None:
        raise _missing(action, "output", analogue=analogue)
    return name


def _missing(action: Output | SynchronisedOutput | WaitInput, what: str, *, analogue: bool) -> LocalProtocolError:
    return LocalProtocolError(
        f"line {action.line}: the machine has no {'analogue' if analogue else 'digital'} {what} number {action.index}",
        hint=f"{what.title()}s are counted from 0 in the order of [io] in the machine file.",
    )


def dynamic_moves(program: Program, *, begin: bool = False) -> NDArray[np.bool_]:
    """Return for each move (moves,) whether M4 was the last to turn spindle or beam on before it.

    ``begin`` says whether it was before the first.
    """
    found = np.full(len(program.moves), begin)
    for action in program.actions:
        if isinstance(action, Spindle):
            found[action.at :] = action.direction < 0
    return found


def output_name(machine: Machine, index: int, *, analogue: bool) -> str | None:
    """Return the output that M62 to M68 call by number: the machine file's outputs of that kind, in its order."""
    kinds = {"analog-output"} if analogue else {"latched", "timed", "train"}
    names = [channel.name for channel in machine.io if channel.kind in kinds]
    return names[index] if index < len(names) else None
