"""The electronic leadscrew's log: its damaged rows are told apart, and its fit is the printed one."""

from __future__ import annotations

from pathlib import Path

import pytest

from trochia.analysis.identification import read_hex
from trochia.analysis.identification.step_log import step_log
from trochia.errors import RecordingError

TEXT = (Path(__file__).parents[3] / "golden" / "servo" / "leadscrew-step-log.hex").read_text()


def test_every_damaged_row_is_diagnosed_and_no_other() -> None:
    dump = read_hex(TEXT)
    lost = [line for line, why in dump.problems if "15 of 16 bytes" in why]
    sums = [line for line, why in dump.problems if "check sum: 0x" in why]
    assert len(lost) == 14
    assert len(sums) == 1
    assert len(dump.problems) == 15
    assert dict(dump.problems)[4].endswith("0x2B")


def test_the_first_and_the_last_counts_are_those_printed() -> None:
    log = step_log(read_hex(TEXT))
    first = [237, 191, 122, 100, 88, 80, 75, 72, 68, 66, 64, 62, 61, 59, 59, 57, 56, 55, 54, 53]
    assert log.counts[:20].tolist() == first
    assert log.counts[-200:].mean() == pytest.approx(38.6, abs=0.05)
    assert log.counts.sum() == pytest.approx(16671, abs=3)
    assert log.unit == pytest.approx(12e-6)
    assert log.steady == pytest.approx(17.2123, abs=1e-3)


def test_the_pole_is_that_of_the_source_within_two_parts_in_a_hundred() -> None:
    log = step_log(read_hex(TEXT))
    fit = log.pole()
    assert fit["pole"] == pytest.approx(74.29, rel=0.02)
    assert fit["amplitude"] == pytest.approx(18.88, rel=0.02)
    assert fit.fit > 0.975
    assert abs(fit["pole"] - 74.29) < 3 * fit.numbers["pole"].sigma + 1.0
    assert log.pole(drop=0)["pole"] == pytest.approx(73.1, abs=0.1)
    assert log.gain(1024) == pytest.approx(2.0866, abs=1e-3)


def test_the_chip_s_own_unit_gives_the_slower_motor() -> None:
    log = step_log(read_hex(TEXT), extra=1)
    assert log.pole()["pole"] == pytest.approx(55.9, abs=0.2)
    assert log.gain(1024) == pytest.approx(1.565, abs=1e-3)


def test_a_dump_without_a_log_is_refused() -> None:
    with pytest.raises(RecordingError, match="no step-response log"):
        step_log(read_hex(TEXT.splitlines()[0]))


@pytest.mark.parametrize(
    ("row", "why"),
    [
        ("10000000FF", "behind a colon"),
        (":1000", "behind a colon"),
        (":10000000ZZ", "hexadecimal"),
        (":0400000001020304F3", "wrong check sum: 0xF3, its bytes make 0xF2"),
        (":040000000102F9", "2 bytes of data, 4 are announced"),
    ],
)
def test_what_is_wrong_with_a_row_is_said(row: str, why: str) -> None:
    ((line, told),) = read_hex("\n" + row).problems
    assert line == 2
    assert why in told
