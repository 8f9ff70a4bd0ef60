"""A job that is killed: a sample of the campaign of ``make soak``."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

SOAK = Path(__file__).parents[1] / "soak"


def test_a_killed_job_is_found_again_where_it_was() -> None:
    done = subprocess.run([sys.executable, str(SOAK / "kills.py"), "--count", "2", "--speed", "40"],
                          capture_output=True, text=True, check=False)  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
