"""``trochia canon`` as a user meets it: output, files, JSON, exit codes, no traceback."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = b"G21\nG1 X1 F100\nM2\n"


def trochia(*arguments: object, text: bytes = b"") -> subprocess.CompletedProcess[bytes]:
    command = [sys.executable, "-c", "from trochia.cli import main; main()", "canon", *map(str, arguments)]
    return subprocess.run(command, input=text, capture_output=True, check=False, timeout=60)


def test_prints_one_command_a_line():
    done = trochia("-", text=PROGRAM)
    assert done.returncode == 0
    assert done.stdout.splitlines()[6:9] == [
        b"USE_LENGTH_UNITS(CANON_UNITS_MM)",
        b"SET_FEED_RATE(100.0000)",
        b"STRAIGHT_FEED(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)",
    ]


def test_writes_a_file(tmp_path):
    program, out = tmp_path / "part.ngc", tmp_path / "part.canon"
    program.write_bytes(PROGRAM)
    done = trochia(program, "-o", out)
    assert (done.returncode, done.stdout) == (0, b"")
    assert out.read_bytes() == trochia("-", text=PROGRAM).stdout
    assert sorted(path.name for path in tmp_path.iterdir()) == ["part.canon", "part.ngc"]


def test_a_wrong_program_leaves_the_file_as_it_was(tmp_path):
    out = tmp_path / "part.canon"
    out.write_text("before")
    done = trochia("-", "-o", out, text=b"G0 X1\nG1 X2\nM2\n")
    assert done.returncode == 1
    assert out.read_text() == "before"
    assert [path.name for path in tmp_path.iterdir()] == ["part.canon"]


def test_a_device_stays_a_device():
    assert trochia("-", "-o", "/dev/null", text=PROGRAM).returncode == 0
    assert Path("/dev/null").is_char_device()


def test_a_wrong_program_is_named_with_line_and_column():
    done = trochia("-", text=b"G0 X1\nG1 X2\nM2\n")
    assert done.returncode == 1
    assert b"STRAIGHT_TRAVERSE(1.0000" in done.stdout  # what came before it
    report = done.stderr.decode()
    assert report.startswith("error: <stdin>:2:1: this move has no feed\n    G1 X2\n    ^\n")
    assert "Traceback" not in report


@pytest.mark.parametrize(("text", "ok"), [(PROGRAM, True), (b"G0 X1\nG1 X2\nM2\n", False)])
def test_json_is_one_object(text, ok):
    done = trochia("-", "--json", text=text)
    answer = json.loads(done.stdout)
    assert done.returncode == (0 if ok else 1)
    assert answer["ok"] is ok
    assert answer["commands"][0] == "USE_LENGTH_UNITS(CANON_UNITS_MM)"
    assert [(problem["line"], problem["column"], problem["code"]) for problem in answer["problems"]] == (
        [] if ok else [(2, 1, "modal-conflict")]
    )


def test_block_delete():
    text = b"/G0 X1\nG0 X2\nM2\n"
    assert trochia("-", text=text).stdout.count(b"STRAIGHT_TRAVERSE") == 2
    assert trochia("-", "--block-delete", text=text).stdout.count(b"STRAIGHT_TRAVERSE") == 1


@pytest.mark.parametrize("content", [b"", b"G0\0X1\n"], ids=["empty", "binary"])
def test_what_is_no_program_is_the_programs_fault(content):
    done = trochia("-", text=content)
    assert done.returncode == 1
    assert done.stderr.startswith(b"error: <stdin>:1: ")


def test_a_missing_file_is_the_command_lines_fault(tmp_path):
    done = trochia(tmp_path / "none.ngc")
    assert done.returncode == 2
    assert b"none.ngc" in done.stderr
    assert b"Traceback" not in done.stderr


def test_a_folder_that_does_not_exist_is_the_command_lines_fault(tmp_path):
    done = trochia("-", "-o", Path(tmp_path, "none", "part.canon"), text=PROGRAM)
    assert done.returncode == 2
    assert b"Traceback" not in done.stderr


def test_canon_needs_no_numpy():
    code = (
        "import sys; sys.argv = ['trochia', 'canon', '-']\n"
        "from trochia.cli import main\n"
        "main()\n"
        "sys.exit(3 if 'numpy' in sys.modules else 0)"
    )
    done = subprocess.run([sys.executable, "-c", code], input=PROGRAM, capture_output=True, check=False, timeout=60)
    assert done.returncode == 0
