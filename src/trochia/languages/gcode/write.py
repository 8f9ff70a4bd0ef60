"""The post-processor: a program's canonical moves as plain G-code for a board that plans by itself.

In: a :class:`~trochia.program.Program`, in machine coordinates.  Out: lines that need no cycles, no expressions, no
O-words, no splines and no compensation, each with the source line it comes from.  Read back, they are the same moves.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from trochia.errors import LimitError, ProgramError, Source
from trochia.languages.gcode.targets import TARGETS
from trochia.languages.gcode.written_actions import number, probe_word, words_of
from trochia.languages.gcode.written_curves import arc_chords, cubic_chords, turn_of, whole_turns
from trochia.program import AXES, MoveKind, Plane, Probe, Spindle, TimeLaw

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from trochia.languages.gcode.targets import Target
    from trochia.languages.gcode.written_curves import Turn
    from trochia.program import Action, Program

_PLANES = {Plane.XY: "G17", Plane.ZX: "G18", Plane.YZ: "G19"}
_OFFSETS = {Plane.XY: "IJ", Plane.ZX: "KI", Plane.YZ: "JK"}
_FLAT = 1e-3  #: an arc of less than so many rad is its chord


class Line(NamedTuple):
    """A line without its end, and the source line it comes from; 0: of none."""

    text: str
    source: int


def write(program: Program, target: Target = TARGETS["grbl"], *, beam: bool = False) -> str:
    """Return a program as text; see :func:`lines`."""
    return "".join(f"{line.text}\n" for line in lines(program, target, beam=beam))


def lines(
    program: Program,
    target: Target = TARGETS["grbl"],
    *,
    origin: Sequence[float] = (0.0,) * len(AXES),
    beam: bool = False,
    shutter: float | None = None,
) -> Iterator[Line]:
    """Yield the lines of a program, for a board that stands at its start.

    Parameters
    ----------
    origin
        Where the board's program zero lies in machine coordinates (9,) [mm]; it is taken off every position.
    beam
        The tool is a beam, see :func:`~trochia.languages.gcode.written_actions.words_of`.
    shutter
        S of a beam that is only on or off, whatever the program's S; None: S as programmed.

    Raises
    ------
    ProgramError
        For actions the target has not.
    LimitError
        For moves of axes it has not.
    """
    return _Writer(program, target, np.asarray(origin, float), beam=beam, shutter=shutter).lines()


class _Writer:
    """The modes as they stand after the last line."""

    def __init__(
        self, program: Program, target: Target, origin: NDArray[np.float64], *, beam: bool, shutter: float | None
    ) -> None:
        self._program, self._target, self._origin = program, target, origin
        self._beam, self._shutter = beam, shutter
        self._columns = [AXES.index(letter) for letter in target.axes]
        self._others = [at for at in range(len(AXES)) if at not in self._columns]
        self._at = program.start.astype(np.float64)
        self._written = {letter: number(self._at[column] - self._origin[column], target.decimals)
                         for letter, column in zip(target.axes, self._columns, strict=True)}  # fmt: skip
        self._motion = self._feed = self._power = ""
        self._plane = Plane.XY
        self._turning = self._speed = 0.0
        self._probe: Probe | None = None

    def lines(self) -> Iterator[Line]:
        yield Line(self._target.preamble, 0)
        actions = self._program.actions
        done = 0
        for index, move in enumerate(self._program.moves):
            while done < len(actions) and actions[done].at <= index:
                yield from self._act(actions[done])
                done += 1
            source = int(move["line"])
            self._check(move["target"], source)
            yield from (Line(text, source) for text in self._move(move) if text)
            self._at = move["target"].astype(np.float64)
        for action in actions[done:]:
            yield from self._act(action)

    def _act(self, action: Action) -> Iterator[Line]:
        if isinstance(action, Probe):
            self._probe = action
        if isinstance(action, Spindle):
            if self._shutter is not None:
                action = replace(action, speed=self._shutter)
            self._turning, self._speed = float(action.direction), action.speed
            self._power = number(action.speed, 3)
        for text in words_of(action, self._program.name, beam=self._beam):
            yield Line(text, action.line)

    def _check(self, target: NDArray[np.float64], line: int) -> None:
        """Refuse axes the target has not."""
        if np.abs(target[self._others] - self._at[self._others]).max(initial=0.0) > 0.0:
            letters = [AXES[at] for at in self._others if target[at] != self._at[at]]
            raise LimitError(f"{' '.join(letters)} moves, and the board has only {' '.join(self._target.axes)}",
                             source=Source(self._program.name, line),
                             hint="Run it on a machine whose controller has the axis.")  # fmt: skip

    def _move(self, move: Any) -> Iterator[str]:  # noqa: ANN401 - a row of the structured array
        target = move["target"].astype(np.float64)
        kind = MoveKind(int(move["kind"]))
        if self._probe is not None:
            word, self._probe = probe_word(self._probe), None
            yield self._straight(word, target, self._feed_of(move, target))
            self._motion = ""  # probing is said again each time
        elif kind is MoveKind.ARC:
            yield from self._arc(move, target)
        elif kind is MoveKind.SPLINE:
            points = self._program.splines[int(move["turns"])]
            length = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
            feed = self._feed_of(move, target, length)
            for end in cubic_chords(points, self._at, target, self._target.chord):
                yield self._straight("G1", end, feed, self._power_of(move))
        elif kind is MoveKind.FEED:
            yield self._straight("G1", target, self._feed_of(move, target), self._power_of(move))
        else:
            yield self._straight("G0", target)

    def _straight(self, word: str, target: NDArray[np.float64], feed: str = "", power: str = "") -> str:
        """Return a straight move, or nothing where it leads nowhere."""
        axes = self._axes(target)
        if not axes:
            return ""
        text = ("" if word == self._motion else word) + axes + self._new(feed, power)
        self._motion = word
        return text

    def _arc(self, move: Any, target: NDArray[np.float64]) -> Iterator[str]:  # noqa: ANN401 - a row, as above
        plane = Plane(int(move["plane"]))
        columns = (*plane.axes, plane.normal)
        turn = turn_of(
            self._at, target, (float(move["centre"][0]), float(move["centre"][1])), int(move["turns"]), columns
        )
        climb = target[columns[2]] - self._at[columns[2]]
        feed = self._feed_of(move, target, float(np.hypot(turn.angle * sum(turn.radii) / 2, climb)))
        power = self._power_of(move)
        if abs(turn.radii[0] - turn.radii[1]) > self._target.radii or abs(turn.angle) < _FLAT:
            for end in arc_chords(turn, self._at, target, self._target.chord):
                yield self._straight("G1", end, feed, power)
            return
        if plane is not self._plane:
            yield _PLANES[plane]
            self._plane = plane
        for end, angle in whole_turns(turn, self._at, target):
            yield self._turn(turn, plane, end, angle) + self._new(feed, power)

    def _turn(self, turn: Turn, plane: Plane, end: NDArray[np.float64], angle: float) -> str:
        """Return one arc's words: its centre counts from the start as it was written."""
        decimals = self._target.decimals
        offsets = ""
        for letter, column, centre in zip(_OFFSETS[plane], turn.columns[:2], turn.centre, strict=True):
            begin = float(self._written[AXES[column]])
            offsets += letter + number(centre - self._origin[column] - begin, decimals)
        axes = self._axes(end, always={AXES[column] for column in turn.columns[:2]})
        word = "G3" if angle > 0.0 else "G2"
        text = ("" if word == self._motion else word) + axes + offsets
        self._motion = word
        return text

    def _axes(self, target: NDArray[np.float64], always: set[str] | frozenset[str] = frozenset()) -> str:
        """Return the axis words that change, and those that must stand."""
        text = ""
        for letter, column in zip(self._target.axes, self._columns, strict=True):
            word = number(target[column] - self._origin[column], self._target.decimals)
            if word != self._written[letter] or letter in always:
                text += letter + word
                self._written[letter] = word
        return text

    def _new(self, feed: str, power: str) -> str:
        """Return F and S where they change."""
        text = ""
        if feed and feed != self._feed:
            text, self._feed = f"F{feed}", feed
        if power and power != self._power:
            text, self._power = f"{text}S{power}", power
        return text

    def _power_of(self, move: Any) -> str:  # noqa: ANN401 - a row, as above
        power = float(move["power"]) if self._shutter is None else self._shutter
        return number(power, 3) if self._turning else ""

    def _feed_of(self, move: Any, target: NDArray[np.float64], length: float | None = None) -> str:  # noqa: ANN401
        """Return F [mm/min] of a move, whatever its law."""
        rate, law = float(move["rate"]), TimeLaw(int(move["law"]))
        if law is TimeLaw.INVERSE:
            way = float(np.linalg.norm(target - self._at)) if length is None else length
            rate *= way
        elif law is TimeLaw.PER_REV:
            if not self._turning or not self._speed:
                raise ProgramError("a feed per revolution needs a spindle that turns",
                                   source=Source(self._program.name, int(move["line"])),
                                   hint="Start it with S before the move.")  # fmt: skip
            rate *= self._speed / 60.0
        return number(max(60.0 * rate, 0.001), 3)
