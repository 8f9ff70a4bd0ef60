"""The estimate of the start/stop speed against the twin, which starts from rest at one speed and then at another."""

from __future__ import annotations

import numpy as np
import pytest

from trochia.analysis.sweep import start_stop_speed_measured
from trochia.machine.drivers import Chopper, Fed, HBridge, fed
from trochia.machine.motors import HybridStepper, ShaftLoad, motor
from trochia.machine.motors.curves import start_stop_speed

SHIELD, MEDIUM, SMALL = (motor(name).parameters() for name in ("SM-42BYG011-25", "QSH5718-55", "17HS4401"))
FREE_OF_LAG = HybridStepper(teeth=50, resistance=1e3, inductance=1e-4, current=1.0, inertia=1e-5, torque_constant=0.2)


@pytest.mark.parametrize(
    ("made", "load"),
    [
        (
            fed(SHIELD, HBridge(supply=24.0, drop=2.6, excitation="two-phase", released="hold")),
            ShaftLoad(friction=4e-3, inertia=2e-5),
        ),
        (
            fed(SHIELD, HBridge(supply=12.0, drop=2.6, excitation="half-step", released="hold")),
            ShaftLoad(friction=4e-3, inertia=2e-5),
        ),
        (fed(MEDIUM, Chopper(supply=24.0, current=2.5), 16), ShaftLoad(friction=0.02)),
        (fed(MEDIUM, Chopper(supply=24.0, current=2.5), 16), ShaftLoad(friction=0.02, inertia=1e-4)),
        (fed(SMALL, Chopper(supply=24.0, current=1.5), 16), ShaftLoad(friction=0.02, constant=0.1, inertia=5e-5)),
    ],
)
def test_the_twin_starts_below_the_estimate_and_not_above(made: Fed, load: ShaftLoad):
    """Within a fifth, held as it stops; with nothing but its rotor a voltage-fed motor starts up to a third later."""
    estimate = made.start_stop(load)
    assert start_stop_speed_measured(made, [0.8 * estimate], load) > 0
    assert start_stop_speed_measured(made, [1.2 * estimate], load) == 0


def test_without_lag_it_is_the_pendulum_s_escape():
    made = fed(FREE_OF_LAG, HBridge(supply=1e3, drop=0.0, excitation="microstep-64"))
    angle = made.excitation.step_angle
    assert made.start_stop() == pytest.approx(start_stop_speed(FREE_OF_LAG, 0.2, step_angle=angle), rel=1e-3)


def test_it_starts_at_no_speed_that_it_cannot_run_at_and_not_against_what_it_cannot_turn():
    slow = fed(SHIELD, HBridge(supply=12.0, drop=2.6, excitation="one-phase"))
    load = ShaftLoad(constant=0.06)
    assert 0 < slow.start_stop(load) <= slow.fastest(load) < start_stop_speed(
        slow.motor, slow.holding, load=load, step_angle=slow.excitation.step_angle
    )  # fmt: skip
    assert slow.start_stop(ShaftLoad(constant=1.1 * slow.holding)) == 0.0
    assert np.isfinite(slow.start_stop())
