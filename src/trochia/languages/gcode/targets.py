"""What the boards that G-code is written for can do: a row a dialect.

In: nothing.  Out: the table :data:`TARGETS`, which the writer asks before it spells a move or an action.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """One dialect, as far as it is written.

    Attributes
    ----------
    name
        As in ``trochia.languages.gcode.dialects``.
    axes
        The letters it moves, in the order of a move's columns.
    decimals
        Of every length [mm].
    width
        Characters of a line, at most.
    radii
        By how much the radii at the two ends of an arc may differ [mm]; others are written as chords.
    chord
        Greatest distance between a curve and the chords that stand for it [mm].
    preamble
        The first line: the modes everything after it counts on.
    """

    name: str
    axes: str
    decimals: int
    width: int
    radii: float
    chord: float
    preamble: str


GRBL = Target(
    name="grbl", axes="XYZ", decimals=4, width=79, radii=0.004, chord=0.002, preamble="G21G90G91.1G94G17G40G49G80"
)

#: name -> target
TARGETS: Mapping[str, Target] = MappingProxyType({target.name: target for target in (GRBL,)})
