"""Whether a plan stays inside the machine's travel, and where it would.

In: a plan.  Out: the error that names the first line that leaves it, or None.  Both paths are held to the travel, the
programmed and the commanded one.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import OutOfTravelError, Source
from trochia.toolpath import first_outside, fitting_shift

if TYPE_CHECKING:
    from trochia.analysis.plan import Plan


def travel_error(plan: Plan) -> OutOfTravelError | None:
    """Return the error of the first move that leaves the travel; None when all stay inside."""
    axes = plan.machine.axes
    inside = fitting_shift(plan.size.extents, axes)
    for path in (plan.path,) if inside is not None and not inside.any() else (plan.programmed(), plan.path):
        out = first_outside(path, axes)
        if out is not None:
            axis = next(a for a in axes if a.name == out.axis)
            unit = "mm" if axis.kind.value == "linear" else "degree"
            move = plan.program.moves[path.segments["move"][out.segment]]
            return OutOfTravelError(
                f"{out.axis} would go to {out.position:.3f} {unit}, {abs(out.excess):.3f} {unit} beyond its travel of "
                f"{axis.minimum:g} to {axis.maximum:g}",
                source=Source(plan.program.name, int(move["line"])),
            )
    return None


def shift_that_fits(plan: Plan) -> dict[str, float] | None:
    """Return the smallest shift of the part, {axis: mm or degree}, that brings it into the travel; None: none can.

    The way from where the machine stands to the part does not count: it is straight, and travel is a box.
    """
    path = plan.path
    part = np.arange(len(path)) > 0 if len(path) > 1 else None
    shift = fitting_shift(path.extents(part), plan.machine.axes)
    if shift is None:
        return None
    return {letter: _outward(float(value)) for letter, value in zip(path.axes, shift, strict=True) if value}


def _outward(value: float) -> float:
    """Return a shift rounded to 0.001 away from zero, so that it is short to type and still enough."""
    return math.copysign(math.ceil(abs(value) * 1000 - 1e-9) / 1000, value)
