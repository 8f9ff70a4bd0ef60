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
_NONE = (
    "M100 to M199 are the machine's own: its file allows them by allow_user_m_codes = true, or names the folder of "
    "their programs by user_m_codes."
)


def _call(number: int) -> Handler:
    def call(block: Block, state: State, sink: Sink) -> None:
        known = state.user_codes
        if not (known if isinstance(known, bool) else number in known):
            hint = (
                _NONE if known is False else f"The folder that user_m_codes names has no program M{number} to execute."
            )
            raise block.fault(UnknownCodeError, f"M{number} is not known", f"M{number}", hint=hint)
        sink.user_code(number, block.values.get("p"), block.values.get("q"))

    return call


M_CODES = table(
    *(
        Code(name=f"M{number}", about="code of the machine's own", group="user code", step="user code",
             run=_call(number), words="pq")
        for number in NUMBERS
    )
)  # fmt: skip
