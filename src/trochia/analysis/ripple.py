"""How far the phases' field runs ahead of and behind even motion within a step: coarse steps, chopping, detent.

In: a motor behind its driver.  Out: the mean of that angle over any stretch of steps, by a table of its integral.

The field stands at the angle of its row's currents until the next step: a saw tooth as high as a step.  A chopper
leaves half its ripple off each current, which turns the field a little towards the phase that carries more; the detent
torque draws the rotor on from there.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.drivers import Fed

    Floats = NDArray[np.float64]

PLACES = 16  #: of a step at which the field's angle is taken


class Ripple:
    """The table of one motor; ``at`` is in steps from an electrical turn's first row, anywhere."""

    def __init__(self, made: Fed) -> None:
        excitation = made.excitation
        rows = len(excitation.levels)
        at = (np.arange(rows * PLACES) + 0.5) / PLACES
        stands = np.repeat(_field(made), PLACES)
        even = excitation.first_angle + at * excitation.step_angle
        ahead = np.angle(np.exp(1j * (stands - even)))
        self._ahead = ahead - ahead.mean()
        self._rows = rows
        self._edges = np.arange(rows * PLACES + 1) / PLACES
        self._sum = np.concatenate([[0.0], np.cumsum(self._ahead) / PLACES])

    @property
    def greatest(self) -> float:
        """Greatest angle either way [electrical rad]."""
        return float(np.abs(self._ahead).max())

    def mean(self, at: Floats) -> Floats:
        """Return the mean angle ahead of even motion between places in steps and the next (n + 1,), in (n,) [rad]."""
        here = at % self._rows
        whole = np.interp(here, self._edges, self._sum)
        gone = np.diff(at)
        still = np.abs(gone) < 1e-9
        stands = self._ahead[np.minimum((here[:-1] * PLACES).astype(np.intp), len(self._ahead) - 1)]
        return np.where(still, stands, np.diff(whole) / np.where(still, 1.0, gone))


def _field(made: Fed) -> Floats:
    """Return where the rotor rests without load in each row of the excitation (rows,) [electrical rad]."""
    levels, chopper = made.excitation.levels, made.chopper
    if chopper is not None:
        falling = made.motor.resistance * made.current + chopper.fast_part * chopper.supply
        left_off = 0.5 * chopper.off_time / made.motor.inductance * falling / made.current
        levels = np.sign(levels) * np.maximum(np.abs(levels) - left_off, 0.0)
    size = np.hypot(levels[:, 0], levels[:, 1])
    if not (size > 0).all():  # a ripple as great as the current: the table as it is
        levels, size = made.excitation.levels, np.hypot(*made.excitation.levels.T)
    angle = np.arctan2(levels[:, 1], levels[:, 0])
    drawn = made.motor.detent / (made.motor.torque_constant * made.current * size)
    turned = angle
    for _ in range(20):  # sin(angle - turned) = drawn sin(4 turned), for less detent than torque
        turned = angle - np.arcsin(np.clip(drawn * np.sin(4 * turned), -0.9, 0.9))
    return turned if math.isfinite(float(turned.sum())) else angle
