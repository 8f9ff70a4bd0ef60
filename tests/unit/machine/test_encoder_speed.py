"""Noise of measured speed against samples of a quantised motion."""

from __future__ import annotations

import numpy as np
import pytest

from trochia.machine.encoder_speed import crossover, difference_noise, period_noise

COUNTS, PERIOD, CLOCK = 1000.0, 1e-3, 1e6


def test_counting_is_off_by_two_fifths_of_a_count_a_period():
    """Speeds of all fractions of a count a period: 1/√6 = 0.408 count over the period."""
    rng = np.random.default_rng(3)
    speed, phase = rng.uniform(50, 60, 200_000), rng.uniform(0, 1, 200_000)
    counted = np.floor(speed * COUNTS * PERIOD + phase) - np.floor(phase)
    noise = np.std(counted / (COUNTS * PERIOD) - speed)
    assert noise == pytest.approx(difference_noise(COUNTS, PERIOD), rel=0.01)
    assert difference_noise(1, 1) == pytest.approx(0.41, abs=0.005)


def test_timing_a_count_is_off_by_the_clock():
    rng = np.random.default_rng(4)
    speed, phase = rng.uniform(1.99, 2.01, 200_000), rng.uniform(0, 1, 200_000)
    ticks = np.floor(CLOCK / (speed * COUNTS) + phase)
    noise = np.std(CLOCK / (ticks * COUNTS) - speed)
    assert noise == pytest.approx(period_noise(2.0, COUNTS, CLOCK), rel=0.05)


def test_they_are_equal_at_the_crossover():
    at = crossover(COUNTS, PERIOD, CLOCK)
    assert period_noise(at, COUNTS, CLOCK) == pytest.approx(difference_noise(COUNTS, PERIOD))
