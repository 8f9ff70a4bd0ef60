"""M100 to M199: codes of the user's own, off unless the machine allows them.  In: P, Q.  Out: user_code."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.errors import UnknownCodeError
from trochia.languages.gcode.codes import Code, Handler, table

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State

NUMBERS = range(100, 200)


def _call(number: int) -> Handler:
    def call(block: Block, state: State, sink: Sink) -> None:
        if not state.user_codes:
            raise block.fault(UnknownCodeError, f"M{number} is not known", f"M{number}",
                              hint="M100 to M199 are the machine's own: set allow_user_m_codes = true in its file "
                              "where it has this one.")  # fmt: skip
        sink.user_code(number, block.values.get("p"), block.values.get("q"))

    return call


M_CODES = table(
    *(
        Code(name=f"M{number}", about="code of the machine's own", group="user code", step="user code",
             run=_call(number), words="pq")
        for number in NUMBERS
    )
)  # fmt: skip
