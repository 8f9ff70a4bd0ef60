"""Tuning rules and margins against published numbers and closed forms."""

from __future__ import annotations

import math

import control
import numpy as np
import pytest

from trochia.analysis.tuning.closed import closed_loop
from trochia.analysis.tuning.margins import margins_of
from trochia.analysis.tuning.metrics import following_metrics, step_metrics
from trochia.analysis.tuning.models import Fopdt, Gains, Integrating, Ultimate
from trochia.analysis.tuning.rules import (
    bandwidth_and_damping,
    simc,
    tyreus_luyben,
    ziegler_nichols_closed,
    ziegler_nichols_open,
    ziegler_nichols_pi,
)
from trochia.errors import ConfigError, RecordingError

LEADSCREW = Gains(kp=72.0371, ki=82.6077, kd=0.6721, filter=226.7541)


def position_plant(gain: float, pole: float) -> tuple[list[float], list[float]]:
    """Return gain / (s / pole + 1) / s."""
    return [gain], [1.0 / pole, 1.0, 0.0]


def test_the_leadscrew_s_loop_is_the_published_one() -> None:
    found = closed_loop(LEADSCREW, *position_plant(2.0866, 74.29))
    np.testing.assert_allclose(found.poles[:2], [-114.49 + 148.14j, -114.49 - 148.14j], atol=0.02)
    np.testing.assert_allclose(found.poles[2:], [-70.89, -1.17], atol=0.01)
    assert found.margins.crossover == pytest.approx(131.7, abs=0.1)
    assert found.margins.pm_deg == pytest.approx(60.1, abs=0.1)
    assert found.step.overshoot == pytest.approx(0.0897, abs=2e-4)
    assert found.step.rise == pytest.approx(10.09e-3, abs=0.05e-3)
    assert found.step.settling == pytest.approx(32.8e-3, abs=0.2e-3)


def test_the_leadscrew_s_loop_without_its_filter() -> None:
    found = closed_loop(Gains(kp=72.0371, ki=82.6077, kd=0.6721), *position_plant(2.0866, 74.29))
    np.testing.assert_allclose(found.poles, [-88.65 + 55.68j, -88.65 - 55.68j, -1.17], atol=0.02)
    assert found.margins.crossover == pytest.approx(118.5, abs=0.1)
    assert found.margins.pm_deg == pytest.approx(79.7, abs=0.1)
    assert found.step.overshoot == pytest.approx(0.0357, abs=2e-4)
    assert found.step.rise == pytest.approx(14.8e-3, abs=0.1e-3)
    assert found.step.settling == pytest.approx(49.8e-3, abs=0.3e-3)


def test_the_leadscrew_s_loop_on_the_plant_with_the_timer_s_true_unit() -> None:
    found = closed_loop(LEADSCREW, *position_plant(1.5650, 55.72))
    np.testing.assert_allclose(found.poles[1:3], [-88.92 + 74.63j, -88.92 - 74.63j], atol=0.05)
    np.testing.assert_allclose(found.poles[[0, 3]], [-103.46, -1.17], atol=0.02)
    assert found.margins.crossover == pytest.approx(87.9, abs=0.1)
    assert found.margins.pm_deg == pytest.approx(61.1, abs=0.1)
    assert found.step.overshoot == pytest.approx(0.095, abs=5e-4)
    assert found.step.settling == pytest.approx(59.3e-3, abs=0.3e-3)


def test_simc_has_its_published_margins() -> None:
    """Skogestad 2003: dead time 1, closed time constant 1."""
    plant = Fopdt(gain=2.0, lag=3.0, dead=1.0)
    found = margins_of(lambda w: simc(plant).response(w) * plant.response(w), 1e-3, 20.0)
    assert found.gm == pytest.approx(3.142, abs=1e-3)
    assert found.pm_deg == pytest.approx(61.35, abs=0.01)
    assert found.ms == pytest.approx(1.590, abs=1e-3)
    integrating = Integrating(gain=0.7, dead=1.0)
    gains = simc(integrating)
    assert gains.kp / gains.ki == pytest.approx(8.0)
    found = margins_of(lambda w: gains.response(w) * integrating.response(w), 1e-3, 20.0)
    assert found.gm == pytest.approx(2.963, abs=1e-3)
    assert found.pm_deg == pytest.approx(46.86, abs=0.01)
    assert found.ms == pytest.approx(1.704, abs=1e-3)


def test_ziegler_and_nichols_tables() -> None:
    assert ziegler_nichols_open(Fopdt(gain=2.0, lag=1.0, dead=0.5)) == Gains(kp=1.2, ki=1.2, kd=0.3)
    closed = ziegler_nichols_closed(Ultimate(gain=10.0, time=0.2, plant_gain=1.0))
    assert (closed.kp, closed.ki, closed.kd) == pytest.approx((6.0, 60.0, 0.15))
    pi = ziegler_nichols_pi(Ultimate(gain=10.0, time=0.2))
    assert (pi.kp, pi.ki) == pytest.approx((4.5, 27.0))
    gentle = tyreus_luyben(Ultimate(gain=32.0, time=0.2))
    assert (gentle.kp, gentle.kp / gentle.ki) == pytest.approx((10.0, 0.44))
    with pytest.raises(ConfigError, match="for 2 to 20"):
        ziegler_nichols_closed(Ultimate(gain=10.0, time=0.2, plant_gain=0.1))


@pytest.mark.parametrize(("bandwidth", "damping"), [(10.0, 0.7), (25.0, 1.0), (40.0, 0.4)])
def test_poles_lie_where_bandwidth_and_damping_put_them(bandwidth: float, damping: float) -> None:
    gains = bandwidth_and_damping(2.0866, 1.0 / 74.29, bandwidth=bandwidth, damping=damping)
    w = 2.0 * math.pi * bandwidth
    wanted = np.roots(np.polymul([1.0, w], [1.0, 2.0 * damping * w, w * w]))
    found = closed_loop(gains, *position_plant(2.0866, 74.29)).poles
    np.testing.assert_allclose(np.poly(found), np.poly(wanted), rtol=1e-9)


def test_a_bandwidth_below_the_plant_s_own_is_named() -> None:
    with pytest.raises(ConfigError, match="quicker than the loop") as raised:
        bandwidth_and_damping(2.0866, 1.0 / 74.29, bandwidth=3.0, damping=0.7)
    assert "at least 4.93 Hz" in str(raised.value)


def test_unstable_gains_are_seen() -> None:
    found = closed_loop(Gains(kp=1.0, ki=1000.0), *position_plant(2.0866, 74.29), duration=0.1)
    assert not found.stable
    assert not found.margins.stable


def test_margins_are_those_of_python_control() -> None:
    plant = control.tf([40.0], [1.0, 6.0, 11.0, 6.0])
    found = margins_of(lambda w: plant(1j * w), 1e-2, 1e2)
    gm, pm, sm, *_ = control.stability_margins(plant)
    assert (found.gm, found.pm_deg, 1.0 / found.ms) == pytest.approx((gm, pm, sm), rel=1e-3)


def test_metrics_of_a_second_order_step() -> None:
    z, w = 0.4, 30.0
    t = np.linspace(0.0, 1.0, 20001)
    wd = w * math.sqrt(1 - z * z)
    y = 1.0 - np.exp(-z * w * t) * (np.cos(wd * t) + z * w / wd * np.sin(wd * t))
    found = step_metrics(t, 5.0 + 2.0 * y, 2.0, start=5.0)
    assert found.overshoot == pytest.approx(math.exp(-math.pi * z / math.sqrt(1 - z * z)), rel=1e-4)
    last = np.nonzero(np.abs(y - 1.0) > 0.02)[0][-1]
    assert found.settling == pytest.approx(t[last], abs=1e-4)
    assert step_metrics(t, 0.9 * y, 1.0).settling == math.inf
    with pytest.raises(RecordingError, match="needs a step"):
        step_metrics(t, y, 0.0)


def test_following_error_tells_what_feed_forward_would_take_away() -> None:
    t = np.linspace(0.0, 1.0, 1001)
    wanted = np.stack([np.sin(6 * t), 6 * np.cos(6 * t), -36 * np.sin(6 * t)], axis=1)
    found = following_metrics(wanted, wanted[:, 0] - 2e-3 * wanted[:, 1] - 3e-5 * wanted[:, 2])
    assert (found.speed_part, found.acceleration_part) == pytest.approx((2e-3, 3e-5))


@pytest.mark.parametrize("lag", [0.0, -1.0])
def test_models_that_cannot_be_are_named(lag: float) -> None:
    with pytest.raises(ConfigError, match="lag: must be above zero"):
        Fopdt(gain=1.0, lag=lag, dead=1.0)
