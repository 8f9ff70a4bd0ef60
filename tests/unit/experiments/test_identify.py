"""An axis nobody knows is found: the seeded sample of ``make soak``'s ten."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from trochia.experiments import Bounds, TwinAxis, identify
from trochia.experiments.motion import soft_loop
from trochia.experiments.response import Excitation, by_chirp, by_multisine
from trochia.servo.sampled import plant_response

if TYPE_CHECKING:
    from trochia.machine.servo_plant import ServoPlant

PERIOD = 5e-4
BOUNDS = Bounds(low=-250.0, high=250.0, command=20.0)


def test_a_drawn_axis_is_found(axes: list[ServoPlant]) -> None:
    truth = axes[6]
    axis = TwinAxis(truth, PERIOD)
    found = identify(axis, BOUNDS, speed=30.0, reach=2.0)
    assert not axis.enabled
    assert found.train is not None
    assert found.gap is not None
    for name in ("motor_inertia", "load_inertia", "stiffness"):
        assert found.train[name] == pytest.approx(getattr(truth, name), rel=0.05), name
    viscous = truth.motor_friction.viscous + truth.load_friction.viscous
    assert found.friction["viscous"] == pytest.approx(viscous, rel=0.05)
    assert found.train["damping"] == pytest.approx(truth.damping, rel=0.2)
    assert abs(found.gap["gap"] - truth.gap) * (truth.counts or 0.0) < 1.0
    dry = truth.motor_friction.coulomb + truth.load_friction.coulomb
    assert found.friction["coulomb"] == pytest.approx(dry, rel=0.02)


def test_one_stiff_mass_is_found_as_one(axes: list[ServoPlant]) -> None:
    lagging = replace(axes[0].amplifier, lag=4e-4)
    truth = replace(axes[0], stiffness=None, damping=0.0, gap=0.0, amplifier=lagging)
    found = identify(TwinAxis(truth, PERIOD), BOUNDS, speed=30.0, reach=2.0)
    assert found.train is None
    assert found.body is not None
    assert found.plant.motor_inertia == pytest.approx(truth.motor_inertia + truth.load_inertia, rel=0.02)
    assert found.plant.amplifier.lag == pytest.approx(4e-4, rel=0.1)


@pytest.fixture(scope="module")
def linear(axes: list[ServoPlant]) -> ServoPlant:
    return replace(axes[5], gap=0.0)


@pytest.mark.parametrize("method", [by_multisine, by_chirp])
def test_the_response_measured_in_the_loop_is_the_plant_s(linear: ServoPlant, method) -> None:  # type: ignore[no-untyped-def]
    """Against the exact sampled response: feedback of a closed loop makes no bias."""
    axis = TwinAxis(linear, PERIOD)
    loop = soft_loop(linear.motor_inertia + linear.load_inertia, axis, BOUNDS)
    dry = linear.motor_friction.coulomb + linear.load_friction.coulomb
    measured = method(axis, loop, BOUNDS, Excitation(0.5 * dry, (3.0, 100.0), 6.0)).trusted(0.98)
    assert len(measured.frequency) > 50
    exact = plant_response(linear, measured.frequency, PERIOD) / axis.torque
    off = np.abs(measured.value / exact - 1.0)
    assert np.median(off) < 0.02
    assert (off < 8.0 * measured.relative_sigma + 0.05).mean() > 0.95
