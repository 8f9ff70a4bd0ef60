"""Motion times on the planners' yardstick with limited jerk: inside what was reached, never below the physical bound.

``s-curve.csv``: the third-order bound with the path free inside the tolerance, the most it may take, and the formula
where motion stops at every corner.
"""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from trochia.languages.gcode import read
from trochia.machine.load import load
from trochia.planner import plan
from trochia.toolpath import build

FOLDER = Path(__file__).parent / "anchors"
ROWS = list(csv.DictReader((FOLDER / "s-curve.csv").read_text().splitlines()))


@pytest.mark.parametrize("row", ROWS, ids=[row["program"] for row in ROWS])
def test_anchor(row):
    machine = load("reference-mill")
    program = read((FOLDER / f"{row['program']}.ngc").read_text(), name=row["program"])
    time = plan(build(program, machine, continuity=2), machine, program=program, profile="s-curve").duration
    assert time <= float(row["most_s"])
    assert time >= float(row["bound_s"] or 0) - 1e-9
    if row["exact_s"]:
        assert time == pytest.approx(float(row["exact_s"]), abs=1e-9)
