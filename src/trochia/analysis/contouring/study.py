"""How well a recorded motion was followed, all figures together: of any recording, of a machine or of its twin.

In: a recording.  Out: :class:`Study`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.analysis.contouring.circle import CircleTest, circle_test
from trochia.analysis.contouring.repeatability import Visits, repeatability, reversal
from trochia.analysis.contouring.reversals import Turn, turns
from trochia.analysis.contouring.spectrum import LEAST, Spectrum, spectrum
from trochia.analysis.errors import contour_error, following_error
from trochia.errors import LimitError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.recorder import Figures, Recording

PEAKS = 3  #: of a spectrum that are told
_LEAST_STEP = 1e-9  # of a position, below which it is rounding


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisStudy:
    """One axis; lengths in its unit.

    Attributes
    ----------
    spectrum
        Of its error; None of a recording that is too short.
    visits
        Of places it rested at twice or more from the same side.
    reversal
        Greatest difference between a place reached from one side and from the other; None where there is none.
    resolution
        The smallest step of what was measured; None where it is not in steps.
    """

    unit: str
    following: Figures
    spectrum: Spectrum | None
    turns: tuple[Turn, ...]
    visits: tuple[Visits, ...]
    reversal: float | None
    resolution: float | None

    @property
    def spread(self) -> float | None:
        """Repeatability: the greatest three standard deviations of its places; None where none was visited twice."""
        return max((visit.spread for visit in self.visits), default=None)

    @property
    def spike(self) -> Turn | None:
        """The greatest of its turns."""
        return max(self.turns, key=lambda turn: abs(turn.height), default=None)

    def figures(self) -> dict[str, Any]:
        """Return it as plain data."""
        peaks = [] if self.spectrum is None else self.spectrum.peaks(PEAKS)
        spike = self.spike
        return {
            "unit": self.unit, "peak": self.following.peak, "rms": self.following.rms,
            "spectrum": [{"frequency_Hz": f, "amplitude": a} for f, a in peaks],
            "reversals": len(self.turns),
            "reversal_spike": None if spike is None else {"height": spike.height, "time_s": spike.time,
                                                          "line": spike.line},
            "repeatability_3sigma": self.spread, "reversal_error": self.reversal, "resolution": self.resolution,
        }  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """All axes, the contour error [mm], and the circle test where there is a circle of X and Y."""

    axes: dict[str, AxisStudy]
    contour: Figures
    circle: CircleTest | None

    def figures(self) -> dict[str, Any]:
        """Return it as plain data."""
        return {
            "axes": {name: axis.figures() for name, axis in self.axes.items()},
            "contour_error_mm": {"peak": self.contour.peak, "rms": self.contour.rms},
            "circle": None if self.circle is None else self.circle.figures(),
        }


def study(recording: Recording) -> Study:
    """Return how well a motion was followed.

    Raises
    ------
    LimitError
        When the recording has no axis with both command and actual position.
    """
    names = [a for a in recording.axes if f"{a}.actual" in recording and f"{a}.commanded" in recording]
    if not names or not len(recording):
        raise LimitError("there is no axis in this recording with both its command and where it was",
                         hint="Record X.commanded and X.actual, as trochia simulate does.")  # fmt: skip
    following = following_error(recording)
    try:
        circle = circle_test(recording) if {"X", "Y"} <= set(names) else None
    except LimitError:
        circle = None
    return Study(axes={name: _axis(recording, name, following[name]) for name in names},
                 contour=contour_error(recording), circle=circle)  # fmt: skip


def _axis(recording: Recording, name: str, following: Figures) -> AxisStudy:
    error = recording[f"{name}.actual"][:] - recording[f"{name}.commanded"][:]
    visits = repeatability(recording, name)
    found = reversal(visits)
    return AxisStudy(
        unit=recording.describe(f"{name}.actual").unit, following=following,
        spectrum=spectrum(np.asarray(error, np.float64), recording.period) if len(error) >= LEAST else None,
        turns=turns(recording, name), visits=tuple(visit for visit in visits if len(visit.errors) > 1),
        reversal=max(found.values(), key=abs, default=None), resolution=_resolution(recording, name),
    )  # fmt: skip


def _resolution(recording: Recording, axis: str) -> float | None:
    """Return the smallest step of an encoder's position, where that is recorded and goes in whole steps of it."""
    name = f"joint.{axis}.measured"
    if name not in recording:
        return None
    steps = np.abs(np.diff(np.asarray(recording[name][:], np.float64)))
    steps = steps[steps > _LEAST_STEP]
    return _quantum(steps) if len(steps) else None


def _quantum(steps: NDArray[np.float64]) -> float | None:
    least = float(steps.min())
    whole = np.abs(steps / least - np.rint(steps / least))
    return least if bool((whole < 1e-3 * np.maximum(steps / least, 1.0)).all()) else None
