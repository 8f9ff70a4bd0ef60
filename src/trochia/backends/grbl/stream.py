"""Lines to a GRBL board by character counting, and which of them it has executed.

In: lines to send, answers, free planner blocks as the board reports them.  Out: bytes, never more than its receive
buffer holds, and the source line up to which motion has been executed: what was sent counts for nothing.
"""

from __future__ import annotations

import re
from collections import deque
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from trochia.languages.gcode.write import Line

RECEIVE = 128  #: bytes of GRBL's receive buffer, unless $I says otherwise
BLOCKS = 15  #: moves of its planner, likewise
HOMING = 60.0  #: that homing may take [s]

_DWELL = re.compile(r"G0?4P([\d.]+)")


class Stream:
    """What waits, what was sent, what is in the board's planner.

    Attributes
    ----------
    line
        Source line up to which everything has been executed.
    """

    def __init__(self) -> None:
        self.receive, self.blocks = RECEIVE, BLOCKS
        self.waiting: deque[Line] = deque()
        self.sent: deque[Line] = deque()
        self.line = 0
        self._taken: deque[tuple[int, bool]] = deque()  # source lines taken and perhaps not executed; which move
        self._moves = 0  # how many of them do
        self._bytes = 0
        self._idle = False

    @property
    def done(self) -> bool:
        """Whether nothing waits, and everything sent has been executed."""
        return not (self.waiting or self.sent or self._taken)

    @property
    def homing(self) -> bool:
        """Whether the board is searching its switches: it answers nobody then."""
        return bool(self.sent) and self.sent[0].text == "$H"

    @property
    def dwell(self) -> float:
        """How long the first line without an answer may take by itself [s]: a dwell, a search for the switches."""
        if self.homing:
            return HOMING
        match = _DWELL.match(self.sent[0].text) if self.sent else None
        return float(match[1]) if match else 0.0

    def add(self, lines: Iterable[Line]) -> None:
        """Queue lines."""
        self.waiting.extend(lines)

    def more(self) -> bytes:
        """Return the next bytes to send: whole lines, as many as the board has room for."""
        data = bytearray()
        while self.waiting and self._bytes + len(self.waiting[0].text) + 1 < self.receive:
            line = self.waiting.popleft()
            self.sent.append(line)
            self._bytes += len(line.text) + 1
            data += line.text.encode("ascii") + b"\n"
        return bytes(data)

    def answered(self, *, taken: bool) -> Line | None:
        """Note an answer to the oldest line sent; return that line, or None where none was sent."""
        if not self.sent:
            return None
        line = self.sent.popleft()
        self._bytes -= len(line.text) + 1
        self._idle = False
        moves = any(letter in line.text for letter in "XYZ") and (line.text[0] != "$" or line.text.startswith("$J"))
        if taken:
            self._taken.append((line.source, moves))
            self._moves += moves
            self._settle(self._moves)
        return line

    def reported(self, free: int | None, *, idle: bool) -> None:
        """Take a status report: free planner blocks, or None where the board does not say.

        Moves that can no longer be in the planner have been executed; the one under way is still in it.  Without the
        figure as many as the planner can hold count as not executed, until the board has been idle in two reports
        with no answer between them.
        """
        held = self.blocks if free is None else max(self.blocks - free, 0)
        if free is None and idle and self._idle and not self.sent:
            held = 0
        self._idle = idle
        self._settle(held)

    def clear(self) -> None:
        """Forget all lines: the board has, too."""
        self.waiting.clear()
        self.sent.clear()
        self._taken.clear()
        self._bytes = self._moves = 0

    def _settle(self, held: int) -> None:
        """Count lines as executed until so many moves are left, and none that waits for nothing stands first."""
        while self._taken and (self._moves > held or not self._taken[0][1]):
            source, moves = self._taken.popleft()
            self._moves -= moves
            self.line = max(self.line, source)
