from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from trochia.errors import RecordingError
from trochia.recorder import Channel, Header, Recording, compare


def recording(period=0.001, **channels):
    arrays = {name: np.asarray(samples) for name, samples in channels.items()}
    described = tuple(Channel(name=name, dtype=samples.dtype.str) for name, samples in arrays.items())
    return Recording(header=Header(period=period, channels=described), channels=arrays)


def test_a_recording_does_not_differ_from_itself():
    one = recording(a=np.arange(10.0), n=np.arange(10, dtype=np.uint32))
    comparison = compare(one, one)
    assert comparison.alike
    assert all((f.peak, f.rms) == (0, 0) for f in comparison.differences.values())


def test_peak_rms_and_place_of_a_difference():
    a = recording(a=np.zeros(4))
    b = recording(a=np.array([0.0, 0.0, -4.0, 3.0]))
    figures = compare(a, b).differences["a"]
    assert (figures.peak, figures.rms, figures.at) == (4.0, 2.5, 2)


def test_unsigned_channels_do_not_wrap():
    a = recording(line=np.array([5], np.uint32))
    b = recording(line=np.array([3], np.uint32))
    assert compare(a, b).differences["line"].peak == 2


def test_long_recordings_are_compared_over_all_blocks():
    signal = np.zeros(600_000)
    other = signal.copy()
    other[555_555] = 0.5
    figures = compare(recording(a=signal), recording(a=other)).differences["a"]
    assert (figures.peak, figures.at) == (0.5, 555_555)
    assert figures.rms == pytest.approx(0.5 / np.sqrt(600_000), rel=1e-12)


def test_a_nan_is_the_peak_and_not_hidden():
    a = recording(a=np.zeros(300_000))
    bad = np.zeros(300_000)
    bad[3] = np.nan
    bad[299_999] = 7
    figures = compare(a, recording(a=bad)).differences["a"]
    assert np.isnan(figures.peak)
    assert figures.at == 3


def test_what_only_one_has_is_named():
    comparison = compare(recording(a=np.zeros(3), b=np.zeros(3)), recording(a=np.zeros(5), c=np.zeros(5)))
    assert comparison.missing == ("b", "c")
    assert comparison.samples == (3, 5)
    assert not comparison.alike
    assert list(comparison.differences) == ["a"]


def test_other_rates_and_starts_are_refused():
    a = recording(a=np.zeros(3))
    with pytest.raises(RecordingError, match="one period"):
        compare(a, recording(period=0.002, a=np.zeros(3)))
    late = replace(a, header=replace(a.header, start=1.0))
    with pytest.raises(RecordingError, match="one start"):
        compare(a, late)


def test_no_samples_no_difference():
    empty = recording(a=np.zeros(0))
    assert compare(empty, recording(a=np.ones(2))).differences["a"].rms == 0
