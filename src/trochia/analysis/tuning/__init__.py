"""From a model to gains: rules, pole placement, loop shaping, search; and what the gains are worth."""

from trochia.analysis.tuning.margins import Margins, loop_margins, margins_of
from trochia.analysis.tuning.models import Fopdt, Gains, Integrating, Ultimate
from trochia.analysis.tuning.moves import Judged, Moves, judge
from trochia.analysis.tuning.optimise import Robustness, optimise
from trochia.analysis.tuning.shaping import Shaped, shape

#: name -> rule from a model of an axis to a cascade
AXIS_RULES = {"shaping": shape, "optimise": optimise}

__all__ = [
    "AXIS_RULES",
    "Fopdt",
    "Gains",
    "Integrating",
    "Judged",
    "Margins",
    "Moves",
    "Robustness",
    "Shaped",
    "Ultimate",
    "judge",
    "loop_margins",
    "margins_of",
    "optimise",
    "shape",
]
