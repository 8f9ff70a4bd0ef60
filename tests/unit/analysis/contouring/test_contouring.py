"""Circle test, repeatability, spectrum against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from trochia.analysis.contouring import circle_test, repeatability, spectrum
from trochia.analysis.contouring.circle import fit_circle
from trochia.analysis.contouring.repeatability import reversal
from trochia.errors import LimitError
from trochia.recorder import Channel, Header, gather

PERIOD = 1e-3


def recording(**columns):
    n = len(next(iter(columns.values())))
    channels = tuple(Channel(name=name.replace("_", "."), unit="mm") for name in columns)
    header = Header(period=PERIOD, duration=(n - 1) * PERIOD, machine="bench", program="", origin="test",
                    channels=channels)  # fmt: skip
    return gather(header, iter([{name.replace("_", "."): values for name, values in columns.items()}]))


def circle(change, radius=20.0, turns=1.5, lead=50):
    """Return a recording of rest, some turns from 3 o'clock, and rest; change(angle) gives what x and y are off."""
    angle = np.concatenate([np.zeros(lead), np.linspace(0, 2 * np.pi * turns, 3001), np.full(lead, 2 * np.pi * turns)])
    x, y = 5 + radius * np.cos(angle), -3 + radius * np.sin(angle)
    dx, dy = change(angle)
    return recording(X_commanded=x, Y_commanded=y, X_actual=x + dx, Y_actual=y + dy)


def test_a_smaller_circle_has_a_radial_but_no_circular_deviation():
    test = circle_test(circle(lambda a: (-0.03 * np.cos(a), -0.03 * np.sin(a))))
    assert test.radius == pytest.approx(20, abs=1e-6)
    assert test.centre == pytest.approx((5, -3), abs=1e-6)
    assert test.radial_deviation == pytest.approx((-0.03, -0.03), abs=1e-9)
    assert test.circular_deviation == pytest.approx(0, abs=1e-9)
    assert test.actual_radius == pytest.approx(19.97, abs=1e-6)
    assert max(abs(spike.height) for spike in test.spikes) < 1e-9


def test_an_offset_is_none_of_the_circular_deviation():
    test = circle_test(circle(lambda a: (0.05 + 0 * a, 0 * a)))
    assert test.radial_deviation == pytest.approx((-0.05, 0.05), abs=1e-4)
    assert test.circular_deviation == pytest.approx(0, abs=1e-9)
    assert test.actual_centre == pytest.approx((5.05, -3), abs=1e-6)


def test_axes_out_of_square_make_an_ellipse():
    """A squareness error of s radians leans the circle: radii 1 ± s/2, so G is R s."""
    s = 1e-3
    test = circle_test(circle(lambda a: (s * 20 * np.sin(a), 0 * a), turns=2))
    assert test.circular_deviation == pytest.approx(20 * s, rel=2e-3)


def test_backlash_leaves_its_step_at_every_reversal():
    """Each axis hangs half a backlash behind its motion: radius off by b/2 (sin - cos …), a step of b at a reversal."""
    b = 0.02
    run = circle(lambda a: (0.5 * b * np.sign(np.sin(a)), -0.5 * b * np.sign(np.cos(a))), turns=2)
    test = circle_test(run)
    assert [spike.angle for spike in test.spikes] == pytest.approx([90, 180, 270, 0, 90, 180, 270])
    for spike in test.spikes:
        assert abs(spike.height) == pytest.approx(b, rel=0.12)


def test_the_way_round_does_not_matter():
    forth = circle_test(circle(lambda a: (0.01 * np.cos(3 * a), 0.01 * np.sin(2 * a)), turns=1.2))
    back = circle_test(circle(lambda a: (0.01 * np.cos(3 * a), 0.01 * np.sin(2 * a)), turns=-1.2))
    assert forth.circular_deviation == pytest.approx(back.circular_deviation, rel=0.2)
    assert back.angle[-1] < back.angle[0]


def test_a_line_is_no_circle():
    x = np.linspace(0, 10, 200)
    with pytest.raises(LimitError, match="no whole circle") as caught:
        circle_test(recording(X_commanded=x, Y_commanded=x, X_actual=x, Y_actual=x))
    assert "G2" in str(caught.value)


def test_a_circle_through_points_is_found():
    centre, radius = fit_circle(np.array([[3.0, 0.0], [0.0, 3.0], [-3.0, 0.0]]) + np.array([7.0, -2.0]))
    assert centre == pytest.approx([7, -2])
    assert radius == pytest.approx(3)


def test_repeatability_tells_the_ways_apart():
    """Ten visits of 5 from below and above: means ±2 um apart by the reversal, and the spread that was put in."""
    rng = np.random.default_rng(7)
    told, was, put = [np.zeros(100)], [np.zeros(100)], {1: [], -1: []}
    for _ in range(10):
        for begin, way in ((0.0, 1), (10.0, -1)):
            ramp = np.linspace(begin, 5.0, 50)
            error = 0.002 * way + 1e-4 * rng.standard_normal()
            put[way].append(error)
            back = np.linspace(5.0, 10.0 if way > 0 else 0.0, 50)[1:]
            told += [ramp, np.full(80, 5.0), back]
            was += [ramp, np.full(80, 5.0 + error), back]
    found = repeatability(recording(X_commanded=np.concatenate(told), X_actual=np.concatenate(was)), "X")
    at = {entry.way: entry for entry in found if entry.target == 5.0}
    for way, entry in at.items():
        np.testing.assert_allclose(sorted(entry.errors), sorted(put[way]), atol=1e-12)
        assert entry.spread == pytest.approx(3 * np.std(put[way], ddof=1))
    assert reversal(found)[5.0] == pytest.approx(np.mean(put[1]) - np.mean(put[-1]))


def test_a_sine_shows_its_amplitude_at_its_frequency():
    t = PERIOD * np.arange(1000)
    found = spectrum(3 + 0.7 * np.sin(2 * np.pi * 50 * t) + 0.2 * np.cos(2 * np.pi * 120 * t), PERIOD)
    (first, second), *_ = [found.peaks(2)]
    assert first == pytest.approx((50, 0.7), rel=1e-9)
    assert second == pytest.approx((120, 0.2), rel=1e-9)


def test_too_few_samples_are_refused():
    with pytest.raises(LimitError, match="16 samples"):
        spectrum(np.zeros(5), PERIOD)
