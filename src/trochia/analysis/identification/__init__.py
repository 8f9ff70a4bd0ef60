"""From measured motion to a model, each number with its uncertainty."""

from trochia.analysis.identification.estimate import Estimate, Number, fitted, least_squares
from trochia.analysis.identification.intel_hex import Dump, read_hex
from trochia.analysis.identification.inverse_dynamics import inverse_dynamics
from trochia.analysis.identification.step import fit_step

__all__ = [
    "Dump",
    "Estimate",
    "Number",
    "fit_step",
    "fitted",
    "inverse_dynamics",
    "least_squares",
    "read_hex",
]
