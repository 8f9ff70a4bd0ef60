from __future__ import annotations

import csv
import json

import numpy as np
import pytest

from trochia.recorder import gather, to_csv, to_npz


@pytest.fixture
def recording(header, block):
    return gather(header, [block(50)])


def test_csv_reads_back_exactly(recording, tmp_path):
    to_csv(recording, tmp_path / "run.csv")
    with (tmp_path / "run.csv").open(newline="") as file:
        titles, *rows = csv.reader(file)
    assert titles[:3] == ["time [s]", "beam", "X.commanded [mm]"]
    table = np.array(rows, float)
    np.testing.assert_array_equal(table[:, 0], recording.time)
    np.testing.assert_array_equal(table[:, 2], recording["X.commanded"])
    np.testing.assert_array_equal(table[:, 5], recording["joint.X.counts"])


def test_npz_holds_arrays_time_and_header(recording, tmp_path):
    to_npz(recording, tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz") as archive:
        np.testing.assert_array_equal(archive["time"], recording.time)
        np.testing.assert_array_equal(archive["joint.X.counts"], recording["joint.X.counts"])
        assert archive["path.line"].dtype == np.uint32
        assert json.loads(str(archive["header"]))["machine"] == "bench"


@pytest.mark.parametrize("export", [to_csv, to_npz])
def test_a_failed_export_leaves_the_old_file(recording, tmp_path, export, monkeypatch):
    target = tmp_path / "run.out"
    target.write_text("old")
    monkeypatch.setattr(np, "savez", lambda *_, **__: 1 / 0)
    monkeypatch.setattr(csv, "writer", lambda *_: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        export(recording, target)
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]
