"""The relay's ultimate gain against the exact one of plants that are known."""

from __future__ import annotations

from dataclasses import replace

import pytest

from trochia.analysis.tuning.classic import ultimate
from trochia.errors import LimitError, RecordingError
from trochia.experiments import Bounds, TwinAxis
from trochia.experiments.relay import relay
from trochia.machine.friction import Friction
from trochia.machine.servo_plant import Amplifier, ServoPlant

PERIOD = 5e-4
BOUNDS = Bounds(low=-10.0, high=10.0, command=5.0)
LAGGING = ServoPlant(amplifier=Amplifier(current=10.0, lag=5e-3), torque_constant=0.1, motor_inertia=1e-3,
                     motor_friction=Friction(viscous=1e-2), counts=50000.0)  # fmt: skip
SLIPPERY = replace(LAGGING, amplifier=Amplifier(current=10.0, lag=2e-3), motor_friction=Friction(viscous=3e-3))
SOFT = replace(LAGGING, motor_inertia=5e-4, load_inertia=5e-4, stiffness=50.0, damping=5e-3, on_load=True,
               amplifier=Amplifier(current=10.0, lag=2e-2))  # fmt: skip


@pytest.mark.parametrize(
    ("plant", "period", "hysteresis"),
    [
        (LAGGING, PERIOD, 1e-3),
        (LAGGING, 2e-3, 1e-2),
        (replace(LAGGING, counts=2000.0), PERIOD, 2e-3),
        (replace(LAGGING, motor_friction=Friction(viscous=0.1)), PERIOD, 1e-3),
        (replace(LAGGING, load=0.02), PERIOD, 1e-3),
        (replace(LAGGING, amplifier=Amplifier(current=10.0)), PERIOD, 1e-3),  # the phase of sampling alone
        (SLIPPERY, PERIOD, 1e-3),
        (SOFT, PERIOD, 3e-3),
    ],
    ids=["lag", "slow ticks", "coarse", "viscous", "loaded", "no lag", "slippery", "two masses"],
)
def test_ultimate_gain_and_period_are_found(plant: ServoPlant, period: float, hysteresis: float) -> None:
    """Hysteresis, a tick's delay and counts do not shift them: 5 % of the gain, 2.5 % of the period."""
    axis = TwinAxis(plant, period)
    found, exact = relay(axis, BOUNDS, size=1.0, hysteresis=hysteresis), ultimate(plant, period)
    assert not axis.enabled
    assert found.gain.value == pytest.approx(exact.gain, rel=0.05)
    assert found.time.value == pytest.approx(exact.time, rel=0.025)
    assert 0.0 <= found.gain.sigma < 0.1 * found.gain.value
    assert found.bias * 0.1 == pytest.approx(plant.load, abs=0.1 * 0.02)


def test_dry_friction_makes_the_gain_greater_as_it_does_in_a_loop() -> None:
    rubbing = replace(LAGGING, motor_friction=Friction(viscous=1e-2, coulomb=5e-3))
    found = relay(TwinAxis(rubbing, PERIOD), BOUNDS, size=1.0, hysteresis=1e-3)
    assert found.gain.value > 1.1 * ultimate(LAGGING, PERIOD).gain


def test_a_relay_that_asks_too_much_is_refused_before_it_moves() -> None:
    axis = TwinAxis(LAGGING, PERIOD)
    with pytest.raises(LimitError, match="would command 9"):
        relay(axis, Bounds(low=-10.0, high=10.0, command=5.0), size=9.0, hysteresis=1e-3)
    with pytest.raises(LimitError, match="less than two counts"):
        relay(axis, Bounds(low=-10.0, high=10.0, command=5.0), size=1.0, hysteresis=1e-6)
    assert axis.position == 0.0
    assert not axis.enabled


def test_an_axis_that_hardly_swings_is_named_with_the_motor_off() -> None:
    axis = TwinAxis(LAGGING, PERIOD)
    with pytest.raises(RecordingError, match="swings were seen"):
        relay(axis, BOUNDS, size=1.0, hysteresis=1e-3, most_time=0.3)
    assert not axis.enabled
