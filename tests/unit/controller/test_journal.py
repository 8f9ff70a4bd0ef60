"""The journal: whatever is cut off its end or damaged inside, the rest can be read."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from trochia.controller import journal
from trochia.controller.journal import Journal, entries
from trochia.errors import RecordingError

if TYPE_CHECKING:
    from pathlib import Path


def fill(folder: Path, count: int, *, bytes_a_file: int = journal.BYTES) -> None:
    book = Journal(folder, bytes_a_file)
    for i in range(count):
        book.write("point", i / 50, line=i)
    book.close()


def test_what_was_written_is_read_again_over_several_runs(tmp_path: Path) -> None:
    fill(tmp_path, 10)
    fill(tmp_path, 5)
    assert [entry["line"] for entry in entries(tmp_path)] == [*range(10), *range(5)]


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60, deadline=None)
@given(cut=st.integers(0, 2000))
def test_a_file_cut_anywhere_gives_every_whole_entry_before_the_cut(tmp_path: Path, cut: int) -> None:
    folder = tmp_path / f"{cut}"
    if not folder.exists():
        fill(folder, 30)
    (path,) = [path for _, path in journal.files(folder)]
    whole = path.read_bytes()
    path.write_bytes(whole[:cut])
    lines = [entry["line"] for entry in entries(folder)]
    assert lines == list(range(max(0, whole[:cut].count(b"\n") - 1)))
    path.write_bytes(whole)


@given(st.binary(min_size=0, max_size=80))
def test_a_damaged_line_is_never_taken_for_an_entry(noise: bytes) -> None:
    assert journal.entry_of(noise) is None
    good = journal.line_of({"kind": "x", "noise": noise.hex()})
    assert journal.entry_of(good) == {"kind": "x", "noise": noise.hex()}
    flipped = bytes([good[0], good[1] ^ 1]) + good[2:]
    assert journal.entry_of(flipped) is None


def test_the_journal_is_bounded_and_keeps_the_newest(tmp_path: Path) -> None:
    fill(tmp_path, 3000, bytes_a_file=2000)
    kept = journal.files(tmp_path)
    assert len(kept) == journal.FILES
    assert sum(path.stat().st_size for _, path in kept) <= journal.FILES * 2000
    lines = [entry["line"] for entry in entries(tmp_path)]
    assert lines == list(range(lines[0], 3000))


def test_a_journal_of_a_newer_version_is_refused_by_name(tmp_path: Path) -> None:
    (tmp_path / "00000001.log").write_bytes(journal.line_of({"kind": "journal", "format": 99}))
    with pytest.raises(RecordingError, match=r"00000001\.log: format 99"):
        list(entries(tmp_path))


def test_a_folder_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(RecordingError, match="cannot be written"):
        Journal(tmp_path / "file")


def test_a_killed_process_loses_no_entry_it_wrote(tmp_path: Path) -> None:
    code = (
        "import sys, pathlib; from trochia.controller.journal import Journal\n"
        f"book = Journal(pathlib.Path({str(tmp_path)!r}))\n"
        "for i in range(10**9):\n    book.write('point', i, line=i); print(i, flush=True)\n"
    )
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        for _ in range(200):
            last = int(process.stdout.readline())
        os.kill(process.pid, signal.SIGKILL)
    lines = [entry["line"] for entry in entries(tmp_path)]
    assert lines == list(range(len(lines)))
    assert len(lines) > last
