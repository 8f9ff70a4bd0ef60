"""Writing and reading: round trips, crashes, and files that are not what they should be."""

from __future__ import annotations

import json
import os
from contextlib import suppress

import numpy as np
import pytest

from trochia.errors import RecordingError
from trochia.recorder import Header, RecordingWriter, gather, read, save, write


@pytest.fixture
def folder(tmp_path, header, block):
    write(tmp_path / "run", header, [block(700), block(300, 1)])
    return tmp_path / "run"


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def assert_same(a, b):
    assert a.header == b.header
    for name, samples in a.channels.items():
        np.testing.assert_array_equal(samples, b[name])


@pytest.mark.parametrize("sizes", [(), (0,), (1,), (5, 0, 3), (700, 300)])
def test_what_is_written_is_read(tmp_path, header, block, sizes):
    blocks = [block(n, seed) for seed, n in enumerate(sizes)]
    write(tmp_path / "run", header, blocks)
    recording = read(tmp_path / "run", verify=True)
    assert recording.complete
    assert_same(recording, gather(header, blocks))
    assert names(tmp_path) == ["run"]


def test_samples_are_mapped_not_loaded(folder):
    samples = read(folder)["X.actual"]
    base = samples
    while isinstance(base.base, np.ndarray):
        base = base.base
    assert isinstance(base, np.memmap)
    assert not samples.flags.writeable


def test_sidecar_may_be_named_instead_of_the_folder(folder):
    assert_same(read(folder / "recording.json"), read(folder))


def test_a_recording_in_memory_can_be_saved(tmp_path, header, block):
    recording = gather(header, [block(10)])
    save(tmp_path / "copy", recording)
    assert_same(read(tmp_path / "copy"), recording)


def test_binary_file_is_plain_little_endian_records_as_the_sidecar_says(folder):
    sidecar = json.loads((folder / "recording.json").read_text())
    assert (sidecar["format"], sidecar["format_version"], sidecar["complete"]) == ("trochia-recording", 1, True)
    raw = (folder / "samples.bin").read_bytes()
    assert len(raw) == sidecar["samples"] * sidecar["record_bytes"]
    column = next(c for c in sidecar["channels"] if c["name"] == "joint.X.counts")
    at = 42 * sidecar["record_bytes"] + column["offset"]
    assert int.from_bytes(raw[at : at + 8], "little", signed=True) == read(folder)["joint.X.counts"][42]


def test_an_older_recording_is_replaced_when_the_new_one_is_whole(folder, header, block):
    with RecordingWriter(folder, header) as writer:
        writer.write(block(5))
        assert len(read(folder)) == 1000
    assert len(read(folder)) == 5
    assert names(folder.parent) == ["run"]


def test_what_is_no_recording_is_not_overwritten(tmp_path, header):
    (tmp_path / "thesis").mkdir()
    with pytest.raises(RecordingError, match="exists and is no recording"):
        write(tmp_path / "thesis", header, [])


def test_a_writer_cut_short_leaves_a_marked_readable_part(tmp_path, header, block):
    def blocks():
        yield block(100)
        yield block(50, 1)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write(tmp_path / "run", header, blocks())
    with pytest.raises(RecordingError, match=r"(?s)no recording.*cut short is at .*run\.partial"):
        read(tmp_path / "run")
    part = read(tmp_path / "run.partial", verify=True)
    assert not part.complete
    assert_same(part, gather(header, [block(100), block(50, 1)]))
    write(tmp_path / "run", header, [block(3)])  # and the next run clears it away
    assert names(tmp_path) == ["run"]


def test_what_stands_in_the_file_after_a_block_survives_a_crash(tmp_path, header, block):
    with RecordingWriter(tmp_path / "run", header) as writer:
        writer.write(block(100))
        assert len(read(writer.partial)) == 100  # as another process would see it at this instant


@pytest.mark.parametrize("cut", [0, 1, 47, 48, 49, 479])
def test_a_part_ends_at_its_last_whole_record(tmp_path, header, block, cut):
    with suppress(ZeroDivisionError), RecordingWriter(tmp_path / "run", header) as writer:
        writer.write(block(10))
        raise ZeroDivisionError
    file = tmp_path / "run.partial" / "samples.bin"
    size = file.stat().st_size
    os.truncate(file, size - cut)
    part = read(tmp_path / "run.partial")
    assert len(part) == (size - cut) // header.record.itemsize
    np.testing.assert_array_equal(part["X.actual"], block(10)["X.actual"][: len(part)])


@pytest.mark.parametrize("size", [-1, +7])
def test_a_whole_recording_of_another_size_is_damaged(folder, size):
    file = folder / "samples.bin"
    os.truncate(file, file.stat().st_size + size)
    with pytest.raises(RecordingError, match=r"samples.bin: damaged: 1000 samples take 48000 bytes, the file has"):
        read(folder)


def test_a_changed_byte_is_found_by_verifying(folder):
    with (folder / "samples.bin").open("r+b") as file:
        file.seek(1234)
        byte = file.read(1)[0]
        file.seek(1234)
        file.write(bytes([byte ^ 1]))
    read(folder)
    with pytest.raises(RecordingError, match="checksum"):
        read(folder, verify=True)


def test_missing_samples_are_named(folder):
    (folder / "samples.bin").unlink()
    with pytest.raises(RecordingError, match="the samples are missing"):
        read(folder)


def test_a_newer_file_is_refused_by_version(folder, edit):
    edit(folder, format_version=2, channels="some other shape")
    with pytest.raises(RecordingError, match="format version 2; this program reads up to 1"):
        read(folder)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"format": "soup"}, "expected format 'trochia-recording', not 'soup'"),
        ({"format": None}, "no recording of this program"),
        ({"channels": None}, "damaged sidecar.*channels"),
        ({"period_s": -1}, "damaged sidecar.*period"),
        ({"record_bytes": 3}, "damaged sidecar"),
        ({"record_bytes": 0}, "damaged sidecar"),
        ({"record_bytes": 10**30}, "damaged sidecar"),
        ({"samples": -4}, "damaged"),
        ({"crc32": "soup"}, "damaged sidecar"),
        ({"channels": [{"name": "a", "unit": "", "dtype": "O", "offset": 0}]}, "damaged sidecar.*'O'"),
        ({"channels": [{"name": "a", "unit": "", "dtype": "<f8", "offset": -8}]}, "damaged sidecar"),
        ({"channels": [], "record_bytes": 0}, "damaged sidecar"),
    ],
)
def test_a_damaged_or_foreign_sidecar_is_named(folder, edit, keys, words):
    edit(folder, **keys)
    with pytest.raises(RecordingError, match=rf"(recording\.json|samples\.bin).*{words}"):
        read(folder)


@pytest.mark.parametrize("text", [b"", b"\xff\xfe", b"[]", b'{"format": "trochia-rec'])
def test_a_sidecar_that_is_no_json_object_is_named(folder, text):
    (folder / "recording.json").write_bytes(text)
    with pytest.raises(RecordingError, match=r"recording.json: no recording of this program"):
        read(folder)


def test_nothing_there(tmp_path):
    with pytest.raises(RecordingError, match=r"no recording: it has no recording\.json"):
        read(tmp_path)


def test_blocks_that_do_not_fit_are_refused(tmp_path, header, block):
    with pytest.raises(RecordingError, match="a block holds"):
        write(tmp_path / "run", header, [{"beam": np.zeros(3, np.uint8)}])
    with pytest.raises(RecordingError, match="equally long"):
        write(tmp_path / "run", header, [block(3) | {"X.actual": np.zeros(4)}])
    with pytest.raises(RecordingError, match=r"joint.X.counts: expected int64, not float64"):
        write(tmp_path / "run", header, [block(3) | {"joint.X.counts": np.zeros(3)}])


def test_a_recording_needs_a_channel():
    with pytest.raises(RecordingError, match="at least one channel"):
        Header(period=1, channels=())
