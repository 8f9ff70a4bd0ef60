"""A recording in numbered parts: bounded, joined where nothing is missing between them."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from trochia.errors import RecordingError
from trochia.recorder import Channel, Header, RingWriter, parts_of, read

HEADER = Header(period=0.001, channels=(Channel(name="n", dtype="<i8"), Channel(name="state", values=("off", "on"))))
RECORD = HEADER.record.itemsize


def numbers(first, count):
    return {"n": np.arange(first, first + count), "state": np.zeros(count)}


def test_one_without_a_bound_is_one_part(tmp_path):
    ring = RingWriter(tmp_path / "r", HEADER, limit=None)
    for first in range(0, 1000, 100):
        ring.write(numbers(first, 100), first)
    ring.finish()
    assert [part.name for part in parts_of(tmp_path / "r")] == ["0001"]
    recorded = read(tmp_path / "r", verify=True)
    assert recorded["n"].tolist() == list(range(1000))
    assert recorded.complete
    assert recorded.duration == pytest.approx(0.999)
    assert recorded.describe("state").values == ("off", "on")


@pytest.mark.parametrize("block", [7, 100, 1234])
def test_the_oldest_part_is_dropped_and_the_rest_joins(tmp_path, block):
    limit = 800 * RECORD
    ring = RingWriter(tmp_path / "r", HEADER, limit=limit)
    total = 0
    while total < 5000:
        ring.write(numbers(total, block), total)
        total += block
        size = sum(file.stat().st_size for file in (tmp_path / "r").rglob("samples.bin"))
        assert size <= limit
    ring.finish()
    recorded = read(tmp_path / "r")
    assert len(recorded) >= 600
    assert recorded["n"][-1] == total - 1
    assert np.all(np.diff(recorded["n"]) == 1)
    assert recorded.start == pytest.approx(recorded["n"][0] * 0.001)
    assert ring.dropped > 0


def test_a_gap_begins_a_part_and_the_last_is_read(tmp_path):
    ring = RingWriter(tmp_path / "r", HEADER, limit=None)
    ring.write(numbers(0, 50), 0)
    ring.write(numbers(90, 20), 90)
    ring.write(numbers(110, 5), 110)
    ring.finish()
    assert read(tmp_path / "r")["n"].tolist() == list(range(90, 115))
    assert read(tmp_path / "r" / "0001")["n"].tolist() == list(range(50))
    spans = [(read(part).start, len(read(part))) for part in parts_of(tmp_path / "r")]
    assert all(after > before for before, after in pairwise(start for start, _ in spans))


def test_a_part_that_was_cut_short_is_read_to_its_last_record(tmp_path):
    ring = RingWriter(tmp_path / "r", HEADER, limit=None)
    ring.write(numbers(0, 50), 0)
    recorded = read(tmp_path / "r")
    assert not recorded.complete
    assert recorded["n"].tolist() == list(range(50))
    ring.finish()


def test_a_folder_of_recordings_is_taken_anew_and_no_other(tmp_path):
    for count in (30, 10):
        ring = RingWriter(tmp_path / "r", HEADER, limit=None)
        ring.write(numbers(0, count), 0)
        ring.finish()
    assert len(read(tmp_path / "r")) == 10
    (tmp_path / "r" / "diary.txt").write_text("keep me")
    with pytest.raises(RecordingError, match=r"diary\.txt"):
        RingWriter(tmp_path / "r", HEADER, limit=None)
    assert (tmp_path / "r" / "0001").is_dir()
    (tmp_path / "file").write_text("")
    with pytest.raises(RecordingError, match="no folder"):
        RingWriter(tmp_path / "file", HEADER, limit=None)
