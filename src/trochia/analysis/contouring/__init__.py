"""How well a contour was followed: circle test, repeatability, spectra, of any recording."""

from trochia.analysis.contouring.circle import CircleTest, Spike, circle_test
from trochia.analysis.contouring.repeatability import Visits, repeatability
from trochia.analysis.contouring.reversals import Turn, turns
from trochia.analysis.contouring.spectrum import Spectrum, spectrum
from trochia.analysis.contouring.study import AxisStudy, Study, study

__all__ = [
    "AxisStudy",
    "CircleTest",
    "Spectrum",
    "Spike",
    "Study",
    "Turn",
    "Visits",
    "circle_test",
    "repeatability",
    "spectrum",
    "study",
    "turns",
]
