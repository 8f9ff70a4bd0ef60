"""How well a contour was followed: circle test, repeatability, spectra, of any recording."""

from trochia.analysis.contouring.circle import CircleTest, Spike, circle_test
from trochia.analysis.contouring.repeatability import Visits, repeatability
from trochia.analysis.contouring.spectrum import Spectrum, spectrum

__all__ = ["CircleTest", "Spectrum", "Spike", "Visits", "circle_test", "repeatability", "spectrum"]
