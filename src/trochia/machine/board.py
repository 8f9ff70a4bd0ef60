"""The board that makes a machine's steps: which it is, and how fast its line is."""

from __future__ import annotations

from dataclasses import dataclass, field

from trochia.machine.codecs import Text, Whole
from trochia.machine.schema import Bound, check_bounds, key

#: boards that Trochia has an image for; ``trochia.backends.avr.wiring`` says what each has
BOARD_NAMES = ("uno-stepdir", "mega-stepdir", "uno-l293d")


@dataclass(frozen=True, slots=True, kw_only=True)
class BoardLink:
    """A board with Trochia's image.

    Attributes
    ----------
    kind
        A name of :data:`BOARD_NAMES`.
    baud
        Of its line, as its image was flashed.
    """

    kind: str = field(metadata=key(Text(BOARD_NAMES), "which board it is, as `trochia flash` names it"))
    baud: int = field(default=115_200, metadata=key(Whole(), "baud rate of the image that was flashed", Bound.POSITIVE))

    def __post_init__(self) -> None:
        check_bounds(self, path="board")
