"""The examples run, and the README shows the first of them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("[0-9][0-9]_*.py"))
LONGEST = 40  # lines: an example is read in one look


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_example_runs_and_is_short(example: Path, tmp_path: Path):
    done = subprocess.run([sys.executable, str(example)], capture_output=True, text=True, cwd=tmp_path, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout
    assert len(example.read_text().splitlines()) <= LONGEST


def test_the_readme_shows_the_first_example():
    code = EXAMPLES[0].read_text().split('"""', 2)[2].strip()
    assert code in (ROOT / "README.md").read_text()
