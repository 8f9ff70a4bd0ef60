"""Responses, two masses and gaps from data that is made by known ones."""

from __future__ import annotations

import numpy as np
import pytest

from trochia.analysis.identification.backlash import gap_by_switch
from trochia.analysis.identification.one_mass import one_mass
from trochia.analysis.identification.response import FrequencyResponse, of_periods, of_spectra
from trochia.analysis.identification.two_mass import peaks, plant_of, two_mass
from trochia.errors import RecordingError
from trochia.machine.friction import Friction
from trochia.machine.servo_plant import Amplifier, ServoPlant
from trochia.servo.sampled import plant_response

PERIOD, SAMPLES = 1e-3, 2000
TRUTH = {"motor_inertia": 1e-4, "load_inertia": 2e-4, "stiffness": 12.0, "damping": 2e-3}
VISCOUS, SHARE = 6e-4, 0.4
LINES = np.arange(3, 800, 4)
FREQUENCY = LINES / (SAMPLES * PERIOD)


def periodic(noise: float = 0.0, bend: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Return input and output of a first-order lag over six periods, with noise and a square in it."""
    rng = np.random.default_rng(3)
    spectrum = np.zeros(SAMPLES // 2 + 1, complex)
    spectrum[LINES] = np.exp(2j * np.pi * rng.random(len(LINES)))
    u = np.tile(np.fft.irfft(spectrum, SAMPLES), 6)
    out = spectrum / (1.0 + 1j * np.fft.rfftfreq(SAMPLES, PERIOD) / 20.0)
    y = np.tile(np.fft.irfft(out, SAMPLES), 6)
    y = y + bend * y**2 / y.std() + noise * y.std() * rng.normal(size=len(y))
    return u, y + 7.0 * np.arange(len(y)) * PERIOD  # and a steady speed


def test_whole_periods_give_the_response_and_its_noise() -> None:
    u, y = periodic(noise=0.3)
    found = of_periods(u, y, LINES, SAMPLES, PERIOD)
    exact = 1.0 / (1.0 + 1j * FREQUENCY / 20.0)
    off = np.abs(found.value / exact - 1.0)
    assert np.median(off[:50]) < 0.05
    # what is off is what the coherence says, line by line and on the whole
    scaled = off[3:] / found.relative_sigma[3:]
    assert 0.7 < np.sqrt(np.mean(np.minimum(scaled, 10.0) ** 2) / 2.0) < 1.6
    assert found.distortion is not None
    assert found.distortion < 0.1


def test_what_is_not_linear_shows_on_lines_left_out() -> None:
    straight, bent = (of_periods(*periodic(bend=bend), LINES, SAMPLES, PERIOD).distortion for bend in (0.0, 0.1))
    assert straight is not None
    assert bent is not None
    assert straight < 1e-3
    assert bent > 0.05


def test_an_open_loop_s_chirp_gives_its_response() -> None:
    t = np.arange(40000) * PERIOD
    u = np.sin(2 * np.pi * (0.5 * t + 0.5 * t * t * 100.0 / t[-1]))
    y = np.zeros_like(u)
    for i in range(1, len(u)):
        y[i] = 0.9 * y[i - 1] + 0.1 * u[i - 1]
    found = of_spectra(u, y, PERIOD, segment=4000, band=(4.0, 80.0))
    z = np.exp(2j * np.pi * found.frequency * PERIOD)
    np.testing.assert_allclose(found.value, 0.1 / (z - 0.9), rtol=0.02)
    assert found.coherence.min() > 0.99


@pytest.mark.parametrize(
    ("u", "y", "what"),
    [
        (np.ones(3999), np.ones(3999), "not two or more whole periods"),
        (np.ones(4000), np.ones(3999), "a sample each"),
        (np.ones(4000), np.where(np.arange(4000) == 1234, np.nan, 1.0), "sample 1234 is missing"),
    ],
)
def test_recordings_with_gaps_are_named(u: np.ndarray, y: np.ndarray, what: str) -> None:
    with pytest.raises(RecordingError, match=what):
        of_periods(u, y, LINES, SAMPLES, PERIOD)


def measured(noise: float, lag: float = 0.0) -> FrequencyResponse:
    rng = np.random.default_rng(11)
    exact = plant_response(plant_of([*TRUTH.values(), SHARE], VISCOUS, lag), FREQUENCY, PERIOD)
    dirt = noise * (rng.normal(size=len(exact)) + 1j * rng.normal(size=len(exact))) / np.sqrt(2.0)
    return FrequencyResponse(frequency=FREQUENCY, value=exact * (1.0 + dirt), period=PERIOD,
                             coherence=np.full(len(exact), 1.0 / (1.0 + noise**2)))  # fmt: skip


def test_two_masses_are_found_within_the_uncertainty_told() -> None:
    found = two_mass(measured(0.03), viscous=VISCOUS)
    for name, value in TRUTH.items():
        assert abs(found[name] - value) < 4.0 * found.numbers[name].sigma, name
        assert found.numbers[name].sigma < 0.05 * value, name
    assert found["notch"] == pytest.approx(np.sqrt(12.0 / 2e-4) / (2 * np.pi), rel=0.01)
    assert found["peak"] == pytest.approx(np.sqrt(12.0 / 2e-4 + 12.0 / 1e-4) / (2 * np.pi), rel=0.01)


@pytest.mark.parametrize("lag", [2e-4, 2e-3])
def test_the_lag_of_the_torque_is_not_taken_for_mechanics(lag: float) -> None:
    found = two_mass(measured(0.01, lag), viscous=VISCOUS)
    assert found["lag"] == pytest.approx(lag, abs=4.0 * found.numbers["lag"].sigma)
    assert found.numbers["lag"].sigma < 2e-5
    for name, value in TRUTH.items():
        assert abs(found[name] - value) < 4.0 * found.numbers[name].sigma, name


def test_one_mass_with_its_lag() -> None:
    plant = ServoPlant(amplifier=Amplifier(lag=3e-4), motor_inertia=7e-5, motor_friction=Friction(viscous=2e-4))
    rng = np.random.default_rng(4)
    dirt = 0.02 * (rng.normal(size=len(FREQUENCY)) + 1j * rng.normal(size=len(FREQUENCY)))
    response = FrequencyResponse(frequency=FREQUENCY, value=plant_response(plant, FREQUENCY, PERIOD) * (1.0 + dirt),
                                 coherence=np.full(len(FREQUENCY), 0.999), period=PERIOD)  # fmt: skip
    found = one_mass(response, inertia=1e-4, viscous=2e-4)
    for name, value in (("motor_inertia", 7e-5), ("lag", 3e-4)):
        assert abs(found[name] - value) < 4.0 * found.numbers[name].sigma, name
        assert found.numbers[name].sigma < 0.1 * value, name


def test_notch_and_peak_stand_where_they_are() -> None:
    notch, peak = peaks(measured(0.0))
    assert notch == pytest.approx(np.sqrt(12.0 / 2e-4) / (2 * np.pi), abs=3.0)
    assert peak == pytest.approx(np.sqrt(12.0 / 2e-4 + 12.0 / 1e-4) / (2 * np.pi), abs=3.0)


def test_one_mass_and_too_few_lines_are_named() -> None:
    rigid = FrequencyResponse(frequency=FREQUENCY, value=-1.0 / (1e-4 * (2 * np.pi * FREQUENCY) ** 2) + 0j,
                              coherence=np.ones(len(FREQUENCY)), period=PERIOD)  # fmt: skip
    with pytest.raises(RecordingError, match="one mass, not two"):
        two_mass(rigid, viscous=0.0)
    with pytest.raises(RecordingError, match="0 lines are coherent"):
        two_mass(measured(2.0), viscous=0.0)


def test_the_switch_s_gap_is_way_back_less_slip_and_twist() -> None:
    assert gap_by_switch(0.021, 0.008, wind_up=0.003) == pytest.approx(0.010)
