"""A sample of the campaign that holds what `check` says of lost steps against the twin (tests/soak/lost_steps.py)."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

SOAK = Path(__file__).parents[1] / "soak" / "lost_steps.py"


def test_joints_of_which_nothing_is_said_lose_no_step():
    done = subprocess.run([sys.executable, str(SOAK), "--count", "24", "--seed", "1"], capture_output=True, text=True,
                          check=False)  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    assert "24 cases" in done.stdout
    assert "warned, lost" in done.stdout  # the sample has machines that lose steps
