"""`trochia run` on the twin: by a virtual clock and in real time, with what it asks of the host."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from pathlib import Path

SHORT = "G21 G90 G94\nG1 X4 F1200\nM2\n"


def run(folder: Path, *args: str) -> subprocess.CompletedProcess[str]:
    (folder / "part.ngc").write_text(SHORT)
    code = "import sys; from trochia.cli import main; sys.argv[0] = 'trochia'; main()"
    command = [sys.executable, "-c", code, "run", str(folder / "part.ngc"), "-m", "reference-mill", "-y", *args]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_a_run_in_real_time_tells_what_it_asked_of_the_host(tmp_path: Path) -> None:
    done = run(tmp_path, "--json", "--journal", str(tmp_path / "journal"))
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["ok"]
    host = told["host"]
    assert host["underruns"] == 0
    assert host["processor_percent"] > 0.0
    assert host["command_to_motion_ms"] > 0.0
    assert set(host) == {"underruns", "processor_percent", "longest_turn_ms", "latest_turn_ms", "least_queued_ms",
                         "command_to_motion_ms"}  # fmt: skip


@pytest.mark.parametrize(("option", "told"), [((), "of a core"), (("--virtual",), "idle after")])
def test_a_person_is_told_in_one_line(tmp_path: Path, option: tuple[str, ...], told: str) -> None:
    done = run(tmp_path, *option)
    assert done.returncode == 0, done.stderr
    assert told in done.stdout
    assert ("of a core" in done.stdout) == (option == ())


def test_a_run_finds_what_the_check_found(tmp_path: Path) -> None:
    """Tools, parameters and folders of subroutines are those the command line names."""
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "way.ngc").write_text("o<way> sub\nG0 X#1\nG10 L2 P2 Y#5401\no<way> endsub\nM2\n")
    (tmp_path / "p.var").write_text("5221\t2.0\n5242\t0.0\n")
    (tmp_path / "t.tbl").write_text("T4 P4 X1.5 Z10 D3\n")
    (tmp_path / "call.ngc").write_text("G21 G90 T4 M6 G43\no<way> call [5]\nG10 L2 P3 X#5420\nM2\n")
    code = "import sys; from trochia.cli import main; sys.argv[0] = 'trochia'; main()"
    command = [sys.executable, "-c", code, "run", str(tmp_path / "call.ngc"), "-m", "reference-mill", "-y", "--virtual",
               "--subroutines", str(tmp_path / "sub"), "--parameters", str(tmp_path / "p.var"), "--tools",
               str(tmp_path / "t.tbl"), "--save-parameters"]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    left = dict(line.split() for line in (tmp_path / "p.var").read_text().splitlines())
    assert float(left["5242"]) == 1.5  # of the tool's table
    assert float(left["5261"]) == pytest.approx(5.0)  # where the program stood
