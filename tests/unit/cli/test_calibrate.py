"""A machine that errs is measured, calibrated, and errs no more."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import trochia
from trochia import cli
from trochia.analysis.calibration import by_deviation, by_diagonals, fit, read_points
from trochia.analysis.calibration.points import Points
from trochia.errors import ConfigError, RecordingError
from trochia.machine.compensation import Compensation, Squareness
from trochia.machine.dump import dumps
from trochia.machine.error_table import ErrorTable
from trochia.machine.load import load

TRUE = 0.02
PLACES = np.linspace(0.0, 400.0, 17)
TABLE = ErrorTable(points=tuple(zip(PLACES.tolist(), (0.03 * np.sin(PLACES / 50) + 2e-4 * PLACES).tolist(),
                                    strict=True)))  # fmt: skip


def call(*words, code=0):
    done = CliRunner().invoke(cli.group, list(map(str, words)))
    assert done.exit_code == code or (code and done.exception), done.output
    return done.output if done.exception is None or isinstance(done.exception, SystemExit) else f"{done.exception}"


def measured(machine, axis, places):
    """Return what a twin of a machine measures at places, come to from below and from above."""
    from trochia.api import gcode, plan, simulate  # noqa: PLC0415

    words = ["G21 G90"]
    for way, order in (("+", places), ("-", places[::-1])):
        words += [f"G1 {axis}{place:.4f} F2000\nG4 P0.3" for place in order]
        words += [f"G1 {axis}{places[-1] + 2:.4f}\nG4 P0.3"] if way == "+" else []
    recorded = simulate(plan(gcode("\n".join([*words, "M2", ""]), machine), machine))
    commanded, actual = recorded[f"{axis}.commanded"], recorded[f"{axis}.actual"]
    still = np.concatenate([[False], np.diff(commanded) == 0])
    rows = []
    for k in np.flatnonzero(still[1:] & ~still[:-1]):
        end = k + 250
        before = commanded[max(k - 5, 0)]
        way = "+" if commanded[k] > before else "-"
        if end < len(actual):
            rows.append((commanded[end], actual[end], way))
    return rows


@pytest.fixture
def file(tmp_path):
    """A machine that errs, in a file with remarks."""
    plain = trochia.load("laser")
    first = replace(plain.joints[0], motor=replace(plain.joints[0].motor, microsteps=32), backlash=TRUE,
                    pulse_rate=None, screw_error=TABLE)  # fmt: skip
    fine = replace(first, pulses=replace(first.pulses, length=1e-6, space=1e-6))
    path = tmp_path / "mill.toml"
    text = dumps(replace(plain, joints=(fine, *plain.joints[1:])))
    path.write_text("# mine\n" + text.replace("[joints.X]", "# the long screw\n[joints.X]  # left side"))
    return path


def csv_of(path, rows):
    path.write_text("commanded [mm],who,measured [um],direction\n"
                    + "".join(f"{c:.6f},me,{1000 * m:.4f},{way}\n" for c, m, way in rows))  # fmt: skip
    return path


def test_what_is_measured_is_taken_back(file, tmp_path):
    rows = measured(load(file), "X", PLACES[1:-1] + 0.0)
    points = csv_of(tmp_path / "x.csv", rows)
    was = file.read_text()
    told = json.loads(
        call("machine", "calibrate", file, "--axis", "X", "--points", points, "--resolution", "1 um", "--json")
    )
    assert not told["written"]
    assert file.read_text() == was
    assert told["backlash"]["found"] == pytest.approx(TRUE, abs=0.001)
    for point in told["points"]:
        error = float(TABLE.at(point["place"]) - TABLE.at(told["reference"]))
        assert point["error"] == pytest.approx(error, abs=0.001)
    shown = call("machine", "calibrate", file, "--axis", "X", "--points", points, "--write")
    assert "backlash    2" in shown
    assert "→ 0.00 µm, foreseen" in shown
    text = file.read_text()
    assert text.startswith("# mine\n")
    assert "# the long screw\n[joints.X]  # left side" in text
    seen = call("machine", "show", file)
    assert "16 points" in seen
    assert "79." in seen  # a fifth for backlash, a little for the slope
    again = measured(load(file), "X", PLACES[1:-1] + 3.0)
    errors = np.array([m - c for c, m, _ in again])
    before = np.array([m - c for c, m, _ in rows])
    assert np.ptp(before) > 0.06
    assert np.ptp(errors) < 0.008  # steps of 0.8 µm, and places between the points
    points = csv_of(tmp_path / "y.csv", measured(load(file), "X", PLACES[1:-1]))
    second = json.loads(call("machine", "calibrate", file, "--axis", "X", "--points", points, "--json"))
    assert second["backlash"]["corrected"][1] == pytest.approx(TRUE, abs=0.002)
    assert second["greatest_error"][0] < 0.003
    call("machine", "calibrate", file, "--undo")
    assert file.read_text() == was


def test_a_length_gives_the_scale(file):
    told = json.loads(call("machine", "calibrate", file, "--axis", "Y", "--asked", "200 mm", "--measured", "200.1 mm",
                           "--measured", "200.098 mm", "--measured", "200.102 mm", "--write", "--json"))  # fmt: skip
    assert told["scale"]["error_ppm"] == pytest.approx(500.0)
    assert told["scale"]["uncertainty_ppm"] == pytest.approx(1e6 * 2 * 0.002 / 3**0.5 / 200, rel=1e-3)
    before, after = told["scale"]["steps_per_unit"]
    assert (before, after) == (80.0, pytest.approx(80.0 / 1.0005, rel=1e-7))
    assert float(load(file).joints[1].steps_per_unit) == pytest.approx(after, rel=1e-12)
    assert load(file).joints[1].compensation is None


def test_a_slope_goes_into_the_scale_and_the_rest_into_the_table(file, tmp_path):
    rows = [(x, x * 1.001 + 0.01 * np.sin(x / 30), "+") for x in PLACES]
    told = json.loads(call("machine", "calibrate", file, "--axis", "X", "--points", csv_of(tmp_path / "p.csv", rows),
                           "--take", "scale", "--take", "screw", "--write", "--json"))  # fmt: skip
    slope = 1e-6 * told["scale"]["error_ppm"]
    assert slope == pytest.approx(0.001, abs=1e-4)
    joint = load(file).joints[0]
    assert float(joint.transmission.lead) == pytest.approx(5 * (1 + slope), abs=1e-7)
    left = joint.compensation.screw.at(PLACES) + slope * PLACES
    assert left == pytest.approx(PLACES * 0.001 + 0.01 * np.sin(PLACES / 30), abs=2e-6)


def test_squareness_is_added_to_what_is_corrected(file):
    call("machine", "calibrate", file, "--square", "XY", "--deviation", "-10 um", "--over", "100 mm", "--write")
    assert pytest.approx(np.degrees(1e-4), abs=1e-6) == load(file).squareness.XY
    told = json.loads(call("machine", "calibrate", file, "--square", "XY", "--deviation", "-5 um", "--over", "100 mm",
                           "--resolution", "1 um", "--write", "--json"))  # fmt: skip
    assert pytest.approx(np.degrees(1.5e-4), abs=2e-6) == load(file).squareness.XY
    assert told["uncertainty_deg"] == pytest.approx(np.degrees(2 * 1e-3 * (2 / 12) ** 0.5 / 100))
    for _ in range(2):
        call("machine", "calibrate", file, "--undo")
    assert load(file).squareness is None


def test_the_diagonals_of_a_leaning_square_tell_the_angle():
    a, b, angle = 120.0, 80.0, 0.05
    phi = np.radians(90 + angle)
    first = np.sqrt(a * a + b * b + 2 * a * b * np.cos(phi))
    second = np.sqrt(a * a + b * b - 2 * a * b * np.cos(phi))
    found, sure = by_diagonals(first, second, (a, b), resolution=0.01)
    assert found == pytest.approx(angle, abs=1e-9)
    assert 0 < sure < 0.02
    with pytest.raises(ConfigError, match="no parallelogram"):
        by_diagonals(100.0, 100.0, (a, b), resolution=0.01)
    assert by_deviation(0.1, 100.0, resolution=0.0)[0] == pytest.approx(-np.degrees(np.arctan(1e-3)))


def test_the_twin_of_a_leaning_machine_agrees_with_its_correction():
    machine = replace(trochia.load("laser"), squareness_error=Squareness(XY=0.1), squareness=Squareness(XY=0.1))
    from trochia.backends.errors import with_errors  # noqa: PLC0415
    from trochia.machine.crossing import crossing_of  # noqa: PLC0415

    asked = np.array([[10.0, 200.0], [300.0, 20.0]])
    assert with_errors(machine, crossing_of(machine).motor(asked)) == pytest.approx(asked)


def test_uncertainty_is_twice_that_of_the_mean():
    draw = np.random.default_rng(5)
    places = np.repeat(np.linspace(0, 100, 6), 200)
    ways = np.tile([1, -1], 600)
    noise = draw.normal(0, 0.004, 1200)
    found = fit(Points(commanded=places, measured=places + noise - 0.01 * ways, ways=ways.astype(np.int8)))
    assert found.repeatability == pytest.approx(0.004, rel=0.1)
    assert found.backlash[0] == pytest.approx(0.02, abs=3 * found.backlash[1])
    for spot in found.spots:
        assert spot.sure == pytest.approx(2 * 0.004 / 200**0.5, rel=0.1)
        assert abs(spot.error) < 2.5 * spot.sure


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "is empty"),
        ("commanded,actual\n1,2\n", "no column 'measured'"),
        ("commanded,measured\n1,2\n3,x\n", "x.csv:3"),
        ("commanded,measured,direction\n1,2,+\n3,4,north\n", "north"),
        ("commanded,measured\n1,2\n", "holds 1 points"),
        ("commanded [V],measured\n1,2\n2,3\n", "x.csv:1"),
    ],
)
def test_a_file_of_points_that_is_none_is_told(tmp_path, text, why):
    path = tmp_path / "x.csv"
    path.write_text(text)
    with pytest.raises(RecordingError) as refused:
        read_points(path)
    assert why in f"{refused.value}"


def test_a_way_is_that_from_the_point_before(tmp_path):
    path = tmp_path / "x.csv"
    path.write_text("commanded,measured\n0,0\n10,10\n10,10\n5,5\n")
    assert read_points(path).ways.tolist() == [0, 1, 1, -1]


def test_what_cannot_be_calibrated_is_refused(file, tmp_path):
    points = csv_of(tmp_path / "p.csv", [(0, 0, "+"), (400, 400.01, "+")])
    assert "no axis Q" in call("machine", "calibrate", file, "--axis", "Q", "--points", points, code=2)
    assert "is not written to" in call(
        "machine", "calibrate", "laser", "--axis", "X", "--points", points, "--write", code=2
    )
    assert "both ways" in call(
        "machine", "calibrate", file, "--axis", "X", "--points", points, "--take", "backlash", code=2
    )
    assert "or --square" in call("machine", "calibrate", file, code=2)
    assert "nothing to undo" in call("machine", "calibrate", file, "--undo", code=2)
    short = csv_of(tmp_path / "s.csv", [(0, 0, "+"), (50, 50.01, "+")])
    assert "must reach over the travel" in call("machine", "calibrate", file, "--axis", "X", "--points", short, code=2)


def test_a_correction_written_over_lines_is_replaced(file):
    text = file.read_text()
    many = 'compensation = { screw = [\n  ["0 mm", "0 mm"], # here [\n  ["400 mm", "5 um"],\n] }  # of May\n'
    file.write_text(text.replace("# left side\n", "# left side\n" + many))
    from trochia.machine.key_text import with_keys  # noqa: PLC0415

    machine = load(file)
    given = Compensation(backlash=0.01)
    changed = replace(machine, joints=(replace(machine.joints[0], compensation=given), *machine.joints[1:]))
    out = with_keys(file.read_text(), changed, [("joints.X", "compensation")])
    assert 'compensation = { backlash = "0.01 mm" }  # of May\n' in out
    assert "here [" not in out
    none = replace(machine, joints=(replace(machine.joints[0], compensation=None), *machine.joints[1:]))
    assert "compensation" not in with_keys(out, none, [("joints.X", "compensation")])
    table = text.replace("[joints.Y]", '[joints.X.compensation]\nbacklash = "1 um"\n\n[joints.Y]')
    with pytest.raises(ConfigError, match="table of its own"):
        with_keys(table, changed, [("joints.X", "compensation")])
