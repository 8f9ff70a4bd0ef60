"""A support bundle has what explains a fault, and no secret."""

from __future__ import annotations

import json
import zipfile

import numpy as np
import pytest
from click.testing import CliRunner

from trochia import cli
from trochia.controller.journal import Journal
from trochia.recorder import Channel, Header, RingWriter
from trochia.server.users import Users

PASSWORD = "Correct-Horse-7-Battery"  # noqa: S105 - nobody's
HEADER = Header(period=0.001, channels=(Channel(name="n"),))


@pytest.fixture
def shop(tmp_path):
    """A folder as a served machine leaves it: journal with a log of access, recordings, users."""
    journal = Journal(tmp_path / "journal")
    (tmp_path / "journal" / "programs").mkdir()
    (tmp_path / "journal" / "programs" / "abc123.ngc").write_text("G1 X1 F60\nM2\n")
    for i in range(20):
        journal.write("point", i * 0.01, line=i)
    journal.write("job", 1.0, program="abc123", name="part.ngc")
    journal.write("odd", 2.0, password=PASSWORD, inner={"session_token": PASSWORD, "fine": [1, {"api_key": PASSWORD}]})
    journal.close()
    access = Journal(tmp_path / "journal" / "access")
    access.write("login", 1.0, user="operator", address="192.0.2.7")
    access.close()
    users = Users(tmp_path / "journal" / "users.json", cost=16)
    users.put("operator", "operator", PASSWORD)
    for name, samples in (("old", 10), ("new", 500)):
        ring = RingWriter(tmp_path / "recordings" / name, HEADER, limit=8000)
        ring.write({"n": np.arange(samples, dtype=float)}, 0)
        ring.finish()
    (tmp_path / "recordings" / "new" / "users.json").write_text(PASSWORD)
    (tmp_path / "recordings" / "new" / "0001" / "token").write_text(PASSWORD)
    return tmp_path


def call(*words):
    return CliRunner().invoke(cli.group, list(map(str, words)), catch_exceptions=False)


def contents(path):
    with zipfile.ZipFile(path) as file:
        assert file.testzip() is None
        return {name: file.read(name) for name in file.namelist()}


def test_it_packs_what_explains_and_says_so(shop):
    done = call("bundle", "-m", "laser", "--journal", shop / "journal", "--recordings", shop / "recordings",
                "--entries", 15, "-o", shop / "b.zip", "--json")  # fmt: skip
    assert done.exit_code == 0
    told = json.loads(done.output)
    inside = contents(shop / "b.zip")
    assert [row["name"] for row in told["packed"]] == list(inside)
    assert all(row["bytes"] == len(inside[row["name"]]) for row in told["packed"])
    assert {"about.json", "machine.toml", "journal.jsonl", "recording/0001/samples.bin"} <= set(inside)
    about = json.loads(inside["about.json"])
    assert about["trochia"]
    assert about["packages"]["numpy"] == np.__version__
    lines = [json.loads(line) for line in inside["journal.jsonl"].splitlines()]
    assert len(lines) == 15
    assert lines[-2]["name"] == "part.ngc"
    assert b"kinematics" in inside["machine.toml"]
    assert any("last job" in what for what in told["left_out"])
    assert "program.ngc" not in inside


def test_no_secret_is_in_it(shop):
    done = call("bundle", "-m", "laser", "--journal", shop / "journal", "--recordings", shop / "recordings",
                "--with-program", "-o", shop / "b.zip")  # fmt: skip
    assert done.exit_code == 0
    key = json.loads((shop / "journal" / "users.json").read_text())["users"][0]["key"]
    inside = contents(shop / "b.zip")
    for content in inside.values():
        assert PASSWORD.encode() not in content
        assert key.encode() not in content
        assert b"192.0.2.7" not in content
    odd = json.loads(inside["journal.jsonl"].splitlines()[-1])
    assert odd["inner"] == {"session_token": "left out", "fine": [1, {"api_key": "left out"}]}
    assert inside["program.ngc"] == b"G1 X1 F60\nM2\n"
    assert (shop / "b.zip").stat().st_mode & 0o077 == 0


def test_what_is_no_machine_file_is_not_packed(shop):
    refused = call_code("bundle", "-m", shop / "journal" / "users.json", "-o", shop / "b.zip")
    assert refused != 0
    assert not (shop / "b.zip").exists()
    broken = shop / "broken.toml"
    broken.write_text('format = 1\nname = "half"\n')
    assert call("bundle", "-m", broken, "-o", shop / "b.zip").exit_code == 0
    assert b"missing" in contents(shop / "b.zip")["machine-mistakes.txt"]


def call_code(*words):
    return CliRunner().invoke(cli.group, list(map(str, words))).exit_code


def test_a_recording_that_is_too_long_loses_its_oldest_parts(shop):
    done = call("bundle", "--recordings", shop / "recordings", "--room", "0.002", "-o", shop / "b.zip")
    names = list(contents(shop / "b.zip"))
    assert "recording/0001/samples.bin" not in names
    assert any(name.startswith("recording/") for name in names)
    assert "older parts" in done.output


def test_a_file_that_exists_is_kept(shop):
    (shop / "b.zip").write_text("mine")
    assert "exists" in call("bundle", "-o", shop / "b.zip").output
    assert (shop / "b.zip").read_text() == "mine"
    assert call("bundle", "--force", "-o", shop / "b.zip").exit_code == 0
    none = call("bundle", "--recordings", shop / "nowhere", "--force", "-o", shop / "b.zip")
    assert "there is none" in none.output
    assert call_code("bundle", "--journal", shop / "nowhere", "--force", "-o", shop / "b.zip") == 1
