"""`trochia plan --explain` and `--csv`: what a person reads and what a script gets."""

from __future__ import annotations

import csv
import json

import pytest
from click.testing import CliRunner

from trochia.cli import group

PART = "F4800\nG1 X30\nG3 X40 Y10 J10\nG1 Y30\nG4 P0.5\nG0 X0 Y0\nM2\n"


@pytest.fixture
def run(tmp_path):
    part = tmp_path / "part.ngc"
    part.write_text(PART)

    def run(*options):
        result = CliRunner().invoke(group, ["plan", str(part), "-m", "reference-mill", *options])
        assert result.exit_code == 0, result.output
        return result.stdout

    return run


def test_a_person_reads_limits_and_lines(run):
    text = run("--explain")
    assert "what binds:" in text
    assert "axis X jerk" in text
    assert "at rest" in text
    assert "line 2 " in text


def test_a_script_gets_seconds_by_limit_and_line(run):
    told = json.loads(run("--explain", "--json", "--lines", "0"))
    assert sum(share["time_s"] for share in told["binding"]) == pytest.approx(told["time_s"])
    assert {"limit", "kind", "time_s", "beside_stops_s", "used"} == set(told["binding"][0])
    for line in told["line_times"]:
        assert line["binding"]
        assert sum(part["time_s"] for part in line["binding"]) <= line["time_s"] * (1 + 1e-9)
    assert "binding" not in json.loads(run("--json"))


def test_every_line_goes_to_a_file(run, tmp_path):
    file = tmp_path / "lines.csv"
    told = json.loads(run("--csv", str(file), "--json", "--lines", "0"))
    rows = list(csv.DictReader(file.read_text().splitlines()))
    assert [int(row["line"]) for row in rows] == [line["line"] for line in told["line_times"]] == [2, 3, 4, 6]
    assert sum(float(row["time_s"]) for row in rows) == pytest.approx(told["motion_s"], abs=1e-5)
    assert rows[0]["source"] == "G1 X30"
