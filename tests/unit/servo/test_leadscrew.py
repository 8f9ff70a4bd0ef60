"""The electronic leadscrew's chip, count by count, against a published simulation of the same equations.

The table: error in pulses of the screw at 1.00 mm pitch, at the spindle's pulses from 1 to 3 s, by spindle speed; mean,
standard deviation, least, greatest.  Limit cycles have no closed form: their phase at the first sample decides, so
means agree to half a pulse (or a fifth of the spread), spreads to a quarter.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from trochia.errors import ConfigError
from trochia.servo.leadscrew import ElectronicLeadscrew

ONE, COARSE = Fraction(1), Fraction(5, 2)


def late(screw: ElectronicLeadscrew, rpm: float) -> np.ndarray:
    run = screw.run(rpm, ONE, 3.0)
    return run.error[run.time >= 1]


@pytest.mark.parametrize(
    ("rpm", "mended", "mean", "spread", "least", "most"),
    [
        (30, False, -0.6, 10.2, -25, 13), (30, True, 0.0, 6.8, -16, 10),
        (60, False, 0.2, 2.7, -6, 5), (60, True, 0.2, 2.0, -4, 4),
        (100, False, 0.3, 2.3, -5, 5), (100, True, 0.2, 0.9, -1, 2),
        (200, False, 0.5, 0.7, -1, 3), (300, False, 0.8, 0.9, -1, 3),
        (400, False, 1.0, 0.9, -1, 4), (480, False, 0.5, 0.6, -1, 2),
    ],
)  # fmt: skip
def test_steady_error_by_spindle_speed(rpm, mended, mean, spread, least, most):  # noqa: PLR0917 - a row of the table
    error = late(ElectronicLeadscrew(mended=mended), rpm)
    assert error.mean() == pytest.approx(mean, abs=max(0.5, 0.2 * spread))
    assert error.std() == pytest.approx(spread, rel=0.25)
    assert error.min() == pytest.approx(least, abs=1 + 0.1 * abs(least))
    assert error.max() == pytest.approx(most, abs=1 + 0.1 * most)


@pytest.mark.parametrize(
    ("pitch", "rpm", "peak"),
    [(ONE, 60, 6), (ONE, 100, 8), (ONE, 200, 13), (ONE, 300, 17), (ONE, 400, 26), (ONE, 500, 41),
     (COARSE, 60, 15), (COARSE, 100, 19), (COARSE, 150, 27), (COARSE, 200, 42)],
)  # fmt: skip
def test_greatest_error_of_the_start(pitch, rpm, peak):
    assert ElectronicLeadscrew().run(rpm, pitch, 0.5).error.max() == peak


@pytest.mark.parametrize(("rpm", "duty"), [(100, 196), (200, 392), (400, 785)])
def test_mean_duty_is_the_rate_over_the_gain(rpm, duty):
    """A softer set of gains, which does not limit-cycle there."""
    screw = ElectronicLeadscrew(p=640, i=1, d=2000)
    run = screw.run(rpm, ONE, 3.0)
    assert run.duty[run.time >= 1].mean() == pytest.approx(duty, rel=0.03)
    assert float(screw.ratio(ONE)) * 40 * rpm / 60 / screw.gain == pytest.approx(duty, rel=0.01)


def test_softer_gains_are_calm_when_slow_and_loose_when_fast():
    soft = ElectronicLeadscrew(p=640, i=1, d=2000)
    assert late(soft, 60).std() == pytest.approx(0.6, abs=0.1)
    assert late(soft, 400).std() == pytest.approx(2.2, abs=0.2)


def test_the_ratio_is_exact_and_nothing_drifts():
    """39 p / 635 in hundredths; over any run the pulses owed and those come differ by the error alone."""
    screw = ElectronicLeadscrew()
    assert screw.ratio(Fraction("1.25")) == Fraction(39 * 125, 635)
    run = screw.run(200, Fraction("1.25"), 5.0)
    n = np.arange(1, len(run.time) + 1)
    due = n * (39 * 125) // 635
    np.testing.assert_array_equal(due - np.floor(run.position), run.error)


def test_what_it_ran_over_last_time_is_made_good():
    """An error given at the start is caught up: the same thread is met."""
    screw = ElectronicLeadscrew(p=640, i=1, d=2000)
    plain, owed = (screw.run(200, ONE, 3.0, error=slip) for slip in (0, 29))
    assert owed.position[-1] - plain.position[-1] == pytest.approx(29, abs=3)


def test_full_speed_and_coast():
    """2136.75 pulses/s at full duty less a step of 1024; 28.8 pulses of coast, 0.117 mm."""
    screw = ElectronicLeadscrew()
    assert screw.most_rate == pytest.approx(2136.75 * 1023 / 1024)
    assert screw.coast() == pytest.approx(28.8, abs=0.1)
    assert screw.coast() * 3.175 / 780 == pytest.approx(0.117, abs=1e-3)
    assert screw.greatest_rpm(ONE) == pytest.approx(2134.66 / 6.1417 / 40 * 60, rel=1e-3)


def test_beyond_its_greatest_speed_the_pitch_is_lost():
    screw = ElectronicLeadscrew()
    fast = screw.run(1.1 * screw.greatest_rpm(ONE), ONE, 2.0)
    assert fast.error[-1] > 300
    assert np.all(fast.duty[-50:] == 1023)


def test_a_spindle_at_rest_is_refused():
    with pytest.raises(ConfigError, match="must turn"):
        ElectronicLeadscrew().run(0, ONE, 1.0)
