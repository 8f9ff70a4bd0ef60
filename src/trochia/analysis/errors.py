"""How well motion followed its command: following error, contour error, lost steps.

In: a recording with ``X.commanded`` and ``X.actual`` of every axis.  Out: figures [mm or degree], or the errors
themselves over time.  Following error asks *when*, contour error asks *where*: an axis that is late but on the path has
the first and not the second.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from trochia.kernels.contour import contour_distance
from trochia.recorder import Figures, figures

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from trochia.machine.machine import Machine
    from trochia.recorder import Recording

MARGIN = 16_384  #: samples of path on either side of a stretch in which a point's place is looked for
SNAP = 1e-6  #: a step within this of being reached counts as reached, as in ``core/host/twin.h``


def following_error(recording: Recording) -> dict[str, Figures]:
    """Return figures of ``actual - commanded`` of every axis [mm or degree]."""
    return {axis: figures(len(recording), _Following(recording, axis)) for axis in recording.axes}


def contour_error(recording: Recording, axes: Iterable[str] | None = None) -> Figures:
    """Return figures of the distance between the actual position and the commanded path [mm].

    Parameters
    ----------
    recording
        Its commanded samples are the path, with a cubic between them.
    axes
        Letters of the axes of the space in which distance is measured; all linear ones where None.
    """
    return figures(len(recording), _Contour(recording, axes))


def contour_distances(recording: Recording, axes: Iterable[str] | None = None) -> NDArray[np.float64]:
    """Return the distance between the actual position and the commanded path at every sample (samples,) [mm]."""
    return _Contour(recording, axes)(slice(0, len(recording)))


def lost_steps(recording: Recording, machine: Machine) -> dict[str, int]:
    """Return for every stepper joint how many whole steps its motor's last position is behind the last command.

    A joint that stands on the last step passed is less than a step from its command and has lost none.  A stepper that
    was physics has lost what its rotor slipped: full steps, a multiple of four.
    """
    command = machine.kinematics.matrix @ [recording[f"{axis.name}.commanded"][-1] for axis in machine.axes]
    behind = {
        joint.name: (at - recording[f"joint.{joint.name}.motor"][-1]) * float(joint.steps_per_unit)
        for joint, at in zip(machine.joints, command, strict=True)
        if joint.steps_per_unit is not None
    }
    lost = {name: int(steps + math.copysign(SNAP, steps)) for name, steps in behind.items()}
    slipped = {name: f"joint.{name}.lost_steps" for name in lost}
    return lost | {name: int(recording[at][-1]) for name, at in slipped.items() if at in recording}


class _Following:
    """Following error of one axis over any span."""

    def __init__(self, recording: Recording, axis: str) -> None:
        self.actual = recording[f"{axis}.actual"]
        self.commanded = recording[f"{axis}.commanded"]

    def __call__(self, span: slice) -> NDArray[np.float64]:
        return self.actual[span] - self.commanded[span]


class _Contour:
    """Distance from the path over any span; the path is seen a margin further than the span."""

    def __init__(self, recording: Recording, axes: Iterable[str] | None) -> None:
        if axes is None:
            axes = [axis for axis in recording.axes if recording.describe(f"{axis}.commanded").unit == "mm"]
        self.actual = [recording[f"{axis}.actual"] for axis in axes]
        self.commanded = [recording[f"{axis}.commanded"] for axis in axes]

    def __call__(self, span: slice) -> NDArray[np.float64]:
        if not self.actual:
            return np.zeros(span.stop - span.start)
        seen = slice(max(span.start - MARGIN, 0), span.stop + MARGIN)
        skipped = span.start - seen.start
        distances = contour_distance(
            np.stack([samples[seen] for samples in self.commanded], axis=1),
            np.stack([samples[seen] for samples in self.actual], axis=1),
        )
        return distances[skipped : skipped + span.stop - span.start]
