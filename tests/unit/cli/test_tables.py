"""Numbers as a person reads them."""

from __future__ import annotations

import pytest

from trochia.cli.tables import clock, table


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.0, "0.000 s"),
        (59.9994, "59.999 s"),
        (60.0, "1 min 00.0 s"),
        (184.5, "3 min 04.5 s"),
        (119.96, "2 min 00.0 s"),
        (7384.2, "2 h 03 min 04 s"),
    ],
)
def test_clock(seconds: float, text: str):
    assert clock(seconds) == text


def test_columns_line_up():
    assert table([["a", "1"], ["bb", "20"]]) == "  a    1\n  bb  20"
