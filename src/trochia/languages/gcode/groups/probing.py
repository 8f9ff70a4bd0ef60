"""G38.2 to G38.5: probing.  In: axis words, how far to go at most.  Out: straight_probe.

Run without a machine the probe is taken to switch just short of the target, as LinuxCNC's stand-alone interpreter has
it: the point of the program lies that far back on the way, #5061 to #5069 tell the target, #5070 is 0.  A machine that
answers says where it was (:mod:`trochia.languages.gcode.answers`).
"""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING

from trochia.errors import ModalConflictError, ParseError
from trochia.languages.gcode.answers import PROBED, Probed, note_probed, stop_reading
from trochia.languages.gcode.codes import Code, Handler, table
from trochia.languages.gcode.groups.motion import target_of
from trochia.program.modes import TimeLaw

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State

SHORT = (0.254, 0.01)  #: how far before the target the probe switches in a dry run [mm], [inch]
_LINEAR = 3


def _probe(number: float, *, toward: bool, must: bool) -> Handler:
    """Return the probing code that waits for contact or its loss, and must find it or may."""

    def probe(block: Block, state: State, sink: Sink) -> None:
        if state.feed == 0.0:
            raise block.fault(ModalConflictError, "this probing move has no feed", block.mover,
                              hint="Write F, like F100, on this line or before it.")  # fmt: skip
        if state.law == TimeLaw.PER_REV:
            raise block.fault(ModalConflictError, "a probing move cannot use feed per revolution (G95)", block.mover,
                              hint="Write G94 before it, and F.")  # fmt: skip
        end = target_of(block, state)
        if end == state.position:
            raise block.fault(ModalConflictError, "the probing move goes nowhere", block.mover,
                              hint="Its end must differ from the point it starts at.")  # fmt: skip
        state.motion = round(number * 10)
        if state.answers is None:
            sink.straight_probe(end, toward=toward, must=must)
            state.parameters.fill(PROBED, [*end, 0.0])
            state.position = _contact(state, end)
            return
        answer = state.answers.take()
        if isinstance(answer, Probed):
            note_probed(state, answer)
            sink.straight_probe(state.position, toward=toward, must=must)
        else:
            sink.straight_probe(end, toward=toward, must=must)
            stop_reading(block, state)

    return probe


def _contact(state: State, end: list[float]) -> list[float]:
    """Return the point at which the probe switches in a dry run."""
    way = [b - a for a, b in zip(state.position[:_LINEAR], end[:_LINEAR], strict=True)]
    length = sqrt(sum(step * step for step in way))
    if length == 0.0:
        return end
    share = SHORT[state.inch] / length
    return [b - step * share for b, step in zip(end, way, strict=False)] + end[_LINEAR:]


def _check(block: Block, state: State) -> None:
    """Check the words before anything acts."""
    del state
    assert block.motion is not None
    if not block.has_target:
        raise block.fault(ParseError, f"{block.motion.name} has no axis word", block.motion.name,
                          hint="Write how far to probe, like Z-10.")  # fmt: skip


def _code(number: float, about: str, *, toward: bool, must: bool) -> Code:
    return Code(name=f"G{number}", about=about, group="motion", step="motion",
                run=_probe(number, toward=toward, must=must), check=_check)  # fmt: skip


G_CODES = table(
    _code(38.2, "probe toward the part, contact must be found", toward=True, must=True),
    _code(38.3, "probe toward the part", toward=True, must=False),
    _code(38.4, "probe away from the part, contact must be lost", toward=False, must=True),
    _code(38.5, "probe away from the part", toward=False, must=False),
)
