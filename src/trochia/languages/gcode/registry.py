"""The tables of the language: every code and word, and the order in which they act.

To add a code, write its row and its function in the file of its modal group; a new group is named here once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.cycles import bore, drill, tap, thread, turning
from trochia.languages.gcode.groups import (
    arcs,
    compensation,
    coolant,
    coordinates,
    diameter,
    distance,
    dwell,
    feed,
    homes,
    length_units,
    motion,
    outputs,
    overrides,
    path_control,
    plane,
    probing,
    retract,
    saved_modes,
    set_data,
    shift,
    spindle,
    splines,
    stopping,
    synchronised,
    tool,
    tool_length,
    user_codes,
)

if TYPE_CHECKING:
    from trochia.languages.gcode.codes import Code, WordCode

#: The order in which the parts of one line act, whatever their place on it.
ORDER = (
    "spindle mode",
    "feed mode",
    "feed",
    "speed",
    "tool",
    "saved modes",
    "output",
    "tool change",
    "spindle",
    "coolant",
    "override",
    "user code",
    "dwell",
    "plane",
    "length units",
    "diameter mode",
    "compensation",
    "tool length",
    "coordinate system",
    "path control",
    "distance",
    "arc distance",
    "retract",
    "non-modal",
    "shift",
    "motion",
    "stop",
)
RANK = {step: rank for rank, step in enumerate(ORDER)}

#: number in tenths -> code
G_CODES: dict[int, Code] = {
    **motion.G_CODES,
    **arcs.G_CODES,
    **dwell.G_CODES,
    **plane.G_CODES,
    **length_units.G_CODES,
    **homes.G_CODES,
    **compensation.G_CODES,
    **tool_length.G_CODES,
    **set_data.G_CODES,
    **coordinates.G_CODES,
    **path_control.G_CODES,
    **distance.G_CODES,
    **shift.G_CODES,
    **feed.G_CODES,
    **spindle.G_CODES,
    **retract.G_CODES,
    **drill.G_CODES,
    **tap.G_CODES,
    **bore.G_CODES,
    **thread.G_CODES,
    **turning.G_CODES,
    **synchronised.G_CODES,
    **probing.G_CODES,
    **diameter.G_CODES,
    **splines.G_CODES,
}

#: number in tenths -> code
M_CODES: dict[int, Code] = {
    **stopping.M_CODES,
    **spindle.M_CODES,
    **tool.M_CODES,
    **coolant.M_CODES,
    **outputs.M_CODES,
    **overrides.M_CODES,
    **saved_modes.M_CODES,
    **user_codes.M_CODES,
}

#: letter -> word that acts by itself
WORDS: dict[str, WordCode] = {word.letter: word for word in (feed.F, spindle.S, tool.T)}

MOST_M_CODES = 4  #: M codes one line may have
G_TENTH = 1e-3  #: tenths by which a G number may miss a code
