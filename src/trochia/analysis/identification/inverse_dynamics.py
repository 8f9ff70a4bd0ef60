"""Mass and friction from motion and force, by linear least squares.

    force = M a + Fv v + Fc sign(v) + offset

(the inverse-dynamics model of robot identification: Gautier, Janot).  Velocity and acceleration come from the measured
position by central differences after a low-pass of zero phase, and the force goes through the same low-pass.  Samples
near standstill are left out: there friction has any value up to its level.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.identification.estimate import Estimate, least_squares
from trochia.errors import RecordingError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

ROTARY = (("inertia", "kg·m²"), ("viscous", "N·m·s/rad"), ("coulomb", "N·m"), ("offset", "N·m"))
LINEAR = (("mass", "kg"), ("viscous", "N·s/m"), ("coulomb", "N"), ("offset", "N"))


def inverse_dynamics(
    position: Array, force: Array, period: float, *, rotary: bool = True, cutoff: float | None = None,
    standstill: float | None = None,
) -> Estimate:  # fmt: skip
    """Return inertia and friction.

    Parameters
    ----------
    position, force
        Measured (samples,): the force (or torque) held over the period after each sample.
    period
        Between samples [s].
    cutoff
        Of the low-pass [Hz]; None: a twentieth of the sampling rate.
    standstill
        Speed below which samples are left out; None: a fiftieth of the greatest.

    Raises
    ------
    RecordingError
        When the motion does not excite what is asked for.
    """
    from scipy.signal import butter, sosfiltfilt  # noqa: PLC0415 - scipy is slow to import

    position, force = np.asarray(position, np.float64), np.asarray(force, np.float64)
    if position.shape != force.shape or len(position) < 100:
        raise RecordingError(f"at least 100 samples of position and force are needed, not {len(position)}")
    cut = 0.05 / period if cutoff is None else cutoff
    sections = butter(4, 2.0 * cut * period, output="sos")
    smooth = sosfiltfilt(sections, position)
    # a force held from sample to sample acts half a period late: its mean with the one before belongs to the sample
    drive = sosfiltfilt(sections, 0.5 * (force + np.roll(force, 1)))
    velocity = np.gradient(smooth, period)
    acceleration = np.gradient(velocity, period)
    least = 0.02 * float(np.abs(velocity).max()) if standstill is None else standstill
    edge = round(1.0 / (cut * period))
    used = np.abs(velocity) > least
    used[:edge] = used[-edge:] = False
    for name, signal in (("speed up and slow down", acceleration), ("move both ways", np.sign(velocity))):
        if used.sum() < 50 or np.ptp(signal[used]) == 0.0:
            raise RecordingError(f"the motion must {name} for this", hint="Run a few moves out and back.")
    columns = np.stack([acceleration, velocity, np.sign(velocity), np.ones(len(velocity))], axis=1)[used]
    return least_squares(columns, drive[used], ROTARY if rotary else LINEAR, "inverse-dynamics")
