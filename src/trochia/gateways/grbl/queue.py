"""What a sender has asked for and the machine has not done yet.  In: lines, jogs, homing.  Out: what to do next.

The controller plans whole texts, GRBL's senders hand over line by line: lines are gathered, and what has gathered when
the machine is free runs as one text.  Motion rests between two such texts.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

MOST = 20_000  #: lines that may wait; then answers wait
GATHER, QUIET = 0.25, 0.03  #: a text begins when nothing has come for QUIET, or GATHER after its first line [s]
MOST_CHARACTERS = 4_000  #: of a text that runs without a reference
_ENDS = frozenset({"M2", "M30"})


@dataclass(slots=True)
class Jog:
    """A jog: where it ends in machine coordinates, {axis: mm}, and its speed [mm/s]."""

    end: dict[str, float]
    speed: float


@dataclass(slots=True)
class Home:
    """A search for the reference; its answer is still owed."""


@dataclass(slots=True)
class Words:
    """A line in plain words, how it ends a program, and the modes before it, as lines."""

    text: str
    stop: str
    preamble: list[str]
    number: int = 0


@dataclass(slots=True)
class Text:
    """Lines that run as one program; ``first`` is the number of lines before the first of the sender's."""

    text: str
    first: int
    lines: list[Words] = field(default_factory=list[Words])

    def done(self, line: int) -> int:
        """Return how many of the sender's lines are behind the line under way."""
        return min(max(line - self.first - 1, 0), len(self.lines))


@dataclass(slots=True)
class Queue:
    """Jogs, homing and lines, in order."""

    items: deque[Jog | Home | Words] = field(default_factory=deque[Jog | Home | Words])
    began: float = 0.0  # when the first of the lines that wait came
    latest: float = 0.0

    def add(self, item: Jog | Home | Words, now: float) -> None:
        """Queue something."""
        if not self.items:
            self.began = now
        self.latest = now
        self.items.append(item)

    @property
    def full(self) -> bool:
        """Whether no more is to be taken."""
        return len(self.items) >= MOST

    def ready(self, now: float) -> bool:
        """Whether what waits may begin."""
        if not self.items:
            return False
        return not isinstance(self.items[0], Words) or now - self.latest >= QUIET or now - self.began >= GATHER

    def next(self, *, bounded: bool) -> Jog | Home | Text:
        """Return what is to be done next, and have it no longer; lines as many as go together.

        Parameters
        ----------
        bounded
            A text has a bounded number of characters.
        """
        first = self.items[0]
        if not isinstance(first, Words):
            self.items.popleft()
            return first
        lines: list[Words] = []
        size = 0
        while self.items and isinstance(line := self.items[0], Words):
            size += len(line.text) + 1
            if bounded and lines and size > MOST_CHARACTERS - 200:
                break
            lines.append(line)
            self.items.popleft()
            if line.stop in _ENDS:
                break
        # a closing % ends it as the sender left it; M2 would put the spindle out between two texts
        head = ["%", *first.preamble]
        body = [line.text.replace("\n", " ") for line in lines]
        return Text("\n".join([*head, *body, "%", ""]), len(head), lines)
