"""Gains one after the other: what stood before can be had again, and both be compared.

In: loops.  Out: the one in use, and the ones before it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.errors import LimitError

if TYPE_CHECKING:
    from trochia.servo.axis import Loop


class Session:
    """Loops in the order in which they were taken, the first the one found."""

    def __init__(self, found: Loop) -> None:
        self._loops = [found]

    @property
    def loop(self) -> Loop:
        """The one in use."""
        return self._loops[-1]

    @property
    def before(self) -> Loop | None:
        """The one in use before; None at the start."""
        return self._loops[-2] if len(self._loops) > 1 else None

    def take(self, loop: Loop) -> Loop:
        """Use another loop, and return it."""
        self._loops.append(loop)
        return loop

    def undo(self) -> Loop:
        """Use the one before again, and return it.

        Raises
        ------
        LimitError
            When there is none before.
        """
        if len(self._loops) == 1:
            raise LimitError("these are the gains that were found: there is nothing to undo")
        self._loops.pop()
        return self.loop
