"""``trochia interpolate``: what it prints, as text and as JSON, and what it refuses."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner, Result

from trochia.cli.interpolate import command
from trochia.pulses.interpolators import INTERPOLATORS

if TYPE_CHECKING:
    from pathlib import Path


def run(*arguments: str) -> Result:
    return CliRunner().invoke(command, arguments)


def test_the_sources_example_prints_its_pulses() -> None:
    text = run("line", "5", "3").output
    assert "X steps at ticks 2 4 5 7 8\n" in text
    assert "Y steps at ticks 3 6 8\n" in text


def test_negative_coordinates_are_no_options() -> None:
    result = run("line", "-5", "-3", "--json")
    assert json.loads(result.output)["methods"][0]["end_steps"] == [-5, -3]


def test_compare_has_a_row_a_method() -> None:
    text = run("arc", "40", "--compare").output
    assert all(method.title in text for method in INTERPOLATORS.values())


def test_json_carries_units_in_its_keys() -> None:
    given = json.loads(run("arc", "30", "--from", "90", "--to", "0", "--cw", "--compare", "--json").output)
    assert given["figure"] == {
        "kind": "arc", "radius_steps": 30, "start_steps": [0, 30], "end_steps": [30, 0], "clockwise": True,
    }  # fmt: skip
    assert [row["name"] for row in given["methods"]] == list(INTERPOLATORS)
    for row in given["methods"]:
        assert set(row) == {
            "name", "ticks", "steps", "end_steps", "deviation_max_steps", "deviation_rms_steps", "jitter_max",
            "jitter_rms", "time_per_step_ns", "operations_per_step",
        }  # fmt: skip
        assert row["steps"] == {"X": 30, "Y": 30}
        assert row["end_steps"] == [30, 0]


def test_equal_angles_are_a_whole_turn() -> None:
    assert json.loads(run("arc", "9", "--from", "45", "--to", "45", "--json").output)["methods"][0]["steps"]["X"] == 36


def test_the_plot_is_written_whole(tmp_path: Path) -> None:
    path = tmp_path / "circle.png"
    result = run("arc", "20", "--plot", str(path))
    assert result.exit_code == 0
    assert path.read_bytes().startswith(b"\x89PNG")
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["line", "0", "0"], "no step to make"),
        (["line", "5", "x"], "not a valid integer"),
        (["line", "200000", "0"], "not in the range"),
        (["arc", "0"], "not in the range"),
        (["arc", "10", "--from", "nan"], "number of degrees"),
        (["arc", "10", "--to", "1"], "shorter than a step"),
        (["line", "5", "3", "--method", "spline"], "dda, bresenham, point, difference, octant"),
        (["line", "5", "3", "--method", "dda", "--compare"], "not both"),
        (["line", "5", "3", "--plot", "no/such/folder/x.png"], "no folder"),
    ],
)
def test_bad_input_is_one_clear_error(arguments: list[str], message: str) -> None:
    result = run(*arguments)
    assert result.exit_code == 2
    assert message in result.output
