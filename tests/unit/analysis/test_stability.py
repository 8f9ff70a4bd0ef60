"""The mid-band instability: linear theory against the twin, and against what is known at rest."""

from __future__ import annotations

import math

import numpy as np
import pytest

from trochia.analysis.stability import growth_rate, steady_angle
from trochia.backends.stepper_twin import StepperTwin
from trochia.errors import LimitError
from trochia.machine.drivers import HBridge, fed
from trochia.machine.motors import HybridStepper, ShaftLoad, motor
from trochia.machine.motors.curves import pull_out_torque

RAMP, RUN = 0.3, 0.9


def test_at_rest_back_emf_damps_the_pendulum():
    stepper = HybridStepper(
        teeth=50, resistance=1000.0, inductance=0.05, current=1.0, inertia=1e-5, torque_constant=0.2
    )
    # the back-EMF's current brakes like viscous friction K²/R, half of it over J is the rate
    assert growth_rate(stepper, 0.0, 1000.0) == pytest.approx(-(0.2**2) / 1000.0 / (2 * 1e-5), rel=1e-2)


def steadiness(name: str, volts: float, full_steps: float) -> tuple[int, float]:
    """Return the steps lost, and the ripple of speed [parts of it], of an undamped motor brought to a speed."""
    stepper = motor(name).parameters()
    twin = StepperTwin(fed(stepper, HBridge(supply=volts, drop=0.0, excitation="microstep-32")))
    rate = full_steps * 32
    twin.run(0.05)
    rise = np.sqrt(2 * RAMP * np.arange(1, int(rate * RAMP / 2) + 1) / rate)
    twin.queue(twin.now + np.concatenate([rise, rise[-1] + np.arange(1, int(rate * RUN)) / rate]))
    run = twin.run(RAMP + RUN - 0.1, every=50)
    late = run.omega[-400:]
    return int(run.lost_steps[-1]), float(late.std() / stepper.speed(full_steps))


@pytest.mark.parametrize(("name", "volts"), [("QSH5718-55", 5.0), ("QSH5718-41", 5.0), ("SM-42BYG011-25", 9.4)])
@pytest.mark.parametrize("full_steps", [200, 400, 600, 900, 1200])
def test_the_twin_is_steady_where_linear_theory_says(name: str, volts: float, full_steps: float):
    stepper = motor(name).parameters()
    rate = growth_rate(stepper, stepper.speed(full_steps), volts)
    lost, ripple = steadiness(name, volts, full_steps)
    assert (rate < 0) == (full_steps < 700)  # both kinds are tried
    if rate < 0:
        assert lost == 0
        assert ripple < 1e-3
    else:
        assert lost > 0 or ripple > 0.1


def test_viscous_friction_steadies_the_mid_band():
    stepper = motor("QSH5718-55").parameters()
    omega = stepper.speed(2000)
    assert growth_rate(stepper, omega, 24.0) > 0
    assert growth_rate(stepper, omega, 24.0, ShaftLoad(viscous=3e-3)) < 0


@pytest.mark.parametrize("full_steps", [0, 100, 1000])
def test_the_steady_angle_ends_at_pull_out(full_steps: float):
    stepper = motor("QSH5718-79").parameters()
    omega = stepper.speed(full_steps)
    most = float(pull_out_torque(stepper, np.array(omega), 24.0))
    lag = math.atan(stepper.teeth * omega * stepper.inductance / stepper.resistance)
    assert steady_angle(stepper, omega, 24.0, ShaftLoad(constant=most * (1 - 1e-9))) == pytest.approx(lag, abs=1e-3)
    with pytest.raises(LimitError, match="does not carry"):
        steady_angle(stepper, omega, 24.0, ShaftLoad(constant=most * (1 + 1e-9)))
