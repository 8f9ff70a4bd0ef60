from __future__ import annotations

import numpy as np
import pytest

from trochia.errors import RecordingError
from trochia.recorder import Channel, Header, Recording, gather


@pytest.fixture
def recording(header, block):
    return gather(header, [block(600), block(400, 1)])


def test_samples_are_evenly_spaced_from_the_start(recording):
    assert len(recording) == 1000
    np.testing.assert_allclose(recording.time[[0, 1, 999]], [0.25, 0.251, 1.249], rtol=1e-15)


def test_header_is_at_hand(recording):
    assert (recording.period, recording.start, recording.duration) == (0.001, 0.25, 0.9995)
    assert (recording.machine, recording.program) == ("bench", "square.ngc")
    assert recording.header.created_by.startswith("trochia ")
    assert recording.describe("joint.X.counts").unit == "count"


def test_axes_and_joints_are_found_by_their_channels(recording):
    assert recording.axes == ("X",)
    assert recording.joints == ("X",)


def test_gathering_keeps_order_and_values(recording, block):
    np.testing.assert_array_equal(recording["X.actual"][600:], block(400, 1)["X.actual"])
    assert recording["path.line"].dtype == np.uint32


def test_select_takes_whole_words(header):
    channels = (*header.channels, Channel(name="joint.XX.motor"))
    samples = {channel.name: np.zeros(2) for channel in channels}
    recording = Recording(header=Header(period=1, channels=channels), channels=samples)
    assert list(recording.select("joint.X")) == ["joint.X.motor", "joint.X.counts"]
    assert list(recording.select("beam")) == ["beam"]
    assert recording.select("jo") == {}


def test_samples_are_read_only(recording):
    with pytest.raises(ValueError, match="read-only"):
        recording["X.actual"][0] = 1
    with pytest.raises(TypeError):
        recording.channels["Y.actual"] = np.zeros(1000)


def test_unknown_channel_names_those_there_are(recording):
    with pytest.raises(RecordingError, match=r"(?s)no channel 'Y.actual'.*X.actual, joint.X.motor"):
        recording["Y.actual"]
    assert "Y.actual" not in recording


@pytest.mark.parametrize(
    ("period", "channels", "words"),
    [
        (0, (), "period must be above zero"),
        (float("nan"), (), "period must be above zero"),
        (1, (Channel(name="a"), Channel(name="a")), "twice here: a"),
    ],
)
def test_impossible_headers_are_refused(period, channels, words):
    with pytest.raises(RecordingError, match=words):
        Header(period=period, channels=channels)


def test_impossible_channels_are_refused():
    with pytest.raises(RecordingError, match="needs a name"):
        Channel(name="")
    with pytest.raises(RecordingError, match="expected a dtype of"):
        Channel(name="a", dtype=">f8")


def test_channels_must_match_the_header(header):
    with pytest.raises(RecordingError, match="expected samples of beam"):
        Recording(header=header, channels={"beam": np.zeros(1)})
    uneven = {channel.name: np.zeros(i) for i, channel in enumerate(header.channels)}
    with pytest.raises(RecordingError, match="same number"):
        Recording(header=header, channels=uneven)
