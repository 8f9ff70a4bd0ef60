"""The classic rules on an axis: one PID from command to position, by Ziegler and Nichols.

In: a plant.  Out: its ultimate gain by the frequency response, and the loop of the rule.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, cast

import numpy as np

from trochia.analysis.tuning.models import Gains, Ultimate
from trochia.errors import LimitError
from trochia.servo.axis import Loop
from trochia.servo.pid import Pid
from trochia.servo.sampled import plant_response

if TYPE_CHECKING:
    from trochia.machine.servo_plant import ServoPlant


def ultimate(plant: ServoPlant, period: float) -> Ultimate:
    """Return gain and period with which proportional control of position swings for ever.

    Raises
    ------
    LimitError
        When its phase does not cross -180 degrees.
    """
    from scipy.optimize import brentq  # noqa: PLC0415 - scipy is slow to import

    def imaginary(logarithm: float) -> float:
        return float(plant_response(plant, np.exp(np.array([logarithm])), period)[0].imag)

    grid = np.linspace(math.log(1e-4 / period), math.log(0.499 / period), 2000)
    values = plant_response(plant, np.exp(grid), period)
    crossing = np.nonzero((np.diff(np.sign(values.imag)) != 0) & (values.real[:-1] < 0.0))[0]
    if not len(crossing):
        raise LimitError("the phase of this axis does not cross -180 degrees: it has no ultimate gain",
                         hint="Take loop shaping or pole placement.")  # fmt: skip
    frequencies = [math.exp(cast("float", brentq(imaginary, float(grid[i]), float(grid[i + 1])))) for i in crossing]
    gains = [1.0 / abs(complex(plant_response(plant, np.array([f]), period)[0])) for f in frequencies]
    least = int(np.argmin(gains))
    return Ultimate(gain=gains[least], time=1.0 / frequencies[least])


def single_loop(gains: Gains, period: float, *, limit: float = math.inf) -> Loop:
    """Return the loop with these gains on position, command out."""
    pid = Pid(kp=gains.kp, ki=gains.ki, kd=gains.kd, filter=gains.filter, limit=limit)
    return Loop(period=period, position=pid, limit=limit)
