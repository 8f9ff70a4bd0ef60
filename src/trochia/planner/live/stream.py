"""Streaming: a program of any length planned as it comes.  In: blocks of a program.  Out: portions of its motion.

Memory is bounded by the window, which is counted in time, never in blocks.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.kernels.layout import PHASE
from trochia.kernels.path import Room
from trochia.planner.live.lookahead import Lookahead
from trochia.planner.live.paving import pave
from trochia.planner.live.portion import Portion
from trochia.planner.live.road import Place, Road
from trochia.planner.live.rows import Reused
from trochia.planner.live.window import Rules, Speeds

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from trochia.machine.machine import Machine
    from trochia.program import Program


WINDOW = 150.0  #: how much a window adds, in worst stopping times: long ones cost less to join


class StreamPlanner:
    """The motion of a program, portion by portion, each final.

    At every instant earlier than a window's end less the settling time (twice the worst stopping time) it is that of
    the whole program planned at once, within 1e-9.

    Parameters
    ----------
    blocks
        The program as an interpreter yields it: each block goes on where the last ended, and counts its moves and
        actions from its own start.
    profile
        As in :func:`trochia.planner.profile_of`.

    Raises
    ------
    LimitError
        When there is no such profile; while iterating also as :func:`trochia.planner.path_of`.
    """

    def __init__(self, blocks: Iterable[Program], machine: Machine, *, profile: str | None = None) -> None:
        self.rules = Rules.of(machine, profile)
        room = Room()
        stretches = pave(blocks, machine, self.rules.profile, room=room)
        self.road = Road("".join(axis.name for axis in machine.axes), stretches, room)

    def __iter__(self) -> Iterator[Portion]:
        """Yield portions without a gap from t = 0 to the program's end."""
        ahead = Lookahead(self.road, self.rules, Place(0, 0.0), 0.0, Speeds(), window=WINDOW, whole=True)
        given, memory = 0, Reused(PHASE)
        while True:
            if ahead.safe > given:
                yield Portion.of(self.road, ahead.phases[given : ahead.safe], memory=memory)
                given = ahead.safe
            given -= ahead.forget(ahead.safe_time)
            if not ahead.extend():
                break
        if ahead.safe > given:
            yield Portion.of(self.road, ahead.phases[given:], memory=memory)
