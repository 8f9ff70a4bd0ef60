"""The page on the step library: what it shows runs, and every name it promises is there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from trochia.stepper import Stepper

PAGE = (Path(__file__).parents[3] / "docs" / "how-to" / "drive-steppers-from-python.md").read_text()


def test_its_pieces_run_one_after_the_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.chdir(tmp_path)
    pieces = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    assert len(pieces) == 4
    names: dict[str, object] = {}
    for piece in pieces:
        exec(compile(piece, "page", "exec"), names)  # noqa: S102 - our own page
    told = capsys.readouterr().out.splitlines()
    time, lost = told[0].split()
    assert float(time) == pytest.approx(3.278, abs=5e-4)
    assert lost == "0"
    assert re.fullmatch(r"rotor at .* of 359\.1 degrees, [1-9]\d* steps lost", told[1])
    assert (tmp_path / "ramp.png").exists()


def test_every_name_of_its_table_is_there():
    table = PAGE[PAGE.index("| names |") : PAGE.index("They are the Arduino")]
    rows = [row for row in table.splitlines()[2:] if row.startswith("|")]
    names = [name for row in rows for name in re.findall(r"`(\w+)`", row.split("|")[1])]
    assert len(names) == 22
    for name in names:
        assert callable(getattr(Stepper, name)), name
