"""M62 to M68: digital and analogue outputs, and waiting for inputs.

In: P or E (which), Q (value or time), L (what to wait for).  Out: set_output, wait_input.  M62, M63 and M67 act as the
next move begins, the others at once, with the machine at rest.
"""

from __future__ import annotations

from math import floor
from typing import TYPE_CHECKING

from trochia.errors import ModalConflictError, ParseError
from trochia.languages.gcode.answers import Read, stop_reading
from trochia.languages.gcode.codes import Code, Handler, table

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State

_NOT_GIVEN = -1.0
WAITS = 4  #: greatest L of M66: 0 read now, 1 rise, 2 fall, 3 high, 4 low


def _digital(*, on: bool, synchronised: bool) -> Handler:
    def write(block: Block, state: State, sink: Sink) -> None:
        del state
        code = block.groups["output"].name
        if "p" not in block.values:
            raise block.fault(ParseError, f"{code} needs the output as P", code, hint=f"Write it like {code} P1.")
        sink.set_output(floor(block.values["p"] + 0.5), on, synchronised=synchronised)

    return write


def _analogue(*, synchronised: bool) -> Handler:
    def write(block: Block, state: State, sink: Sink) -> None:
        del state
        code = block.groups["output"].name
        index = floor(block.values.get("e", _NOT_GIVEN) + 0.5)
        if index < 0:
            raise block.fault(ParseError, f"{code} needs the output as E", "e" if "e" in block.values else code,
                              hint=f"Write it like {code} E0 Q2.5.")  # fmt: skip
        sink.set_output(index, block.values.get("q", _NOT_GIVEN), synchronised=synchronised)

    return write


def wait(block: Block, state: State, sink: Sink) -> None:
    """M66: read an input, or wait for it; #5399 gets what it was, 0 where nobody answers."""
    values = block.values
    if "p" in values and "e" in values:
        raise block.fault(ModalConflictError, "M66 takes a digital (P) or an analogue input (E), not both", "e",
                          hint="Read the other one on a line of its own.")  # fmt: skip
    analogue = values.get("p", _NOT_GIVEN) < 0
    index = floor(values.get("e" if analogue else "p", _NOT_GIVEN) + 0.5)
    if index < 0:
        raise block.fault(ParseError, "M66 needs an input: P (digital) or E (analogue)", "M66",
                          hint="Write it like M66 P0 L3 Q5: wait until input 0 is high, at most 5 s.")  # fmt: skip
    way, timeout = int(values.get("l", 0.0)), values.get("q", 0.0)
    if way and analogue:
        raise block.fault(ModalConflictError, "an analogue input can only be read at once (L0)", "l",
                          hint="Leave L out.")  # fmt: skip
    if way and timeout <= 0:
        raise block.fault(ParseError, f"M66 L{way} needs a time, or it would wait for ever", "l",
                          hint="Write the longest time to wait as Q, in seconds.")  # fmt: skip
    sink.wait_input(index, analogue=analogue, wait=way, timeout=timeout)
    answer = state.answers.take() if state.answers is not None else None
    if state.answers is not None and answer is None:
        stop_reading(block, state)
    state.input_value = answer.value if isinstance(answer, Read) else 0.0


_GROUP = "output"
M_CODES = table(
    Code(name="M62", about="output P on, with the next move", group=_GROUP, step=_GROUP, words="p",
         run=_digital(on=True, synchronised=True)),
    Code(name="M63", about="output P off, with the next move", group=_GROUP, step=_GROUP, words="p",
         run=_digital(on=False, synchronised=True)),
    Code(name="M64", about="output P on, now", group=_GROUP, step=_GROUP, words="p",
         run=_digital(on=True, synchronised=False)),
    Code(name="M65", about="output P off, now", group=_GROUP, step=_GROUP, words="p",
         run=_digital(on=False, synchronised=False)),
    Code(name="M66", about="read or await input P or E", group=_GROUP, step=_GROUP, words="pelq", run=wait),
    Code(name="M67", about="output E to Q, with the next move", group=_GROUP, step=_GROUP, words="eq",
         run=_analogue(synchronised=True)),
    Code(name="M68", about="output E to Q, now", group=_GROUP, step=_GROUP, words="eq",
         run=_analogue(synchronised=False)),
)  # fmt: skip
