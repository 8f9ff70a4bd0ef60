"""What a twin's machine errs: screws that are not even, axes that are not square.

In: loads as screws of the right lead would have them.  Out: where they really are.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.machine.crossing import leaning

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from trochia.machine.machine import Machine


def with_errors(machine: Machine, loads: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return loads (samples, joints) with their machine's errors; the same array where it has none."""
    tables = [(i, joint.screw_error) for i, joint in enumerate(machine.joints) if joint.screw_error is not None]
    lean = leaning(machine, machine.squareness_error, correct=False)
    if not tables and lean is None:
        return loads
    real = loads.copy()
    for i, table in tables:
        real[:, i] += table.at(loads[:, i])
    return real if lean is None else real @ lean.T
