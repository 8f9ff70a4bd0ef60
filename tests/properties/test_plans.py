"""Programs on which planning with limited jerk once failed, and a sample of the campaign of plans."""

from __future__ import annotations

import runpy
import subprocess
import sys
from pathlib import Path

import pytest

from trochia.kernels import scurve
from trochia.planner import plan
from trochia.toolpath import build

SOAK = Path(__file__).parents[1] / "soak"


@pytest.mark.parametrize("seed", [77, 60_668, 30_065_879, 30_074_728, 10_018_943, 10_012_815])
def test_what_was_slower_than_stopping(seed, monkeypatch):
    """By 0.2 to 46 %, when corners were weighed one by one alone."""
    monkeypatch.syspath_prepend(SOAK)
    soak = runpy.run_path(str(SOAK / "plans.py"))
    assert soak["case"](seed, soak["machines"](), [0.0] * 4) == []


def test_no_join_of_the_passes_fails(monkeypatch):
    """Of 3,538 the place where the pass back is joined lay outside what its stretch's ends say."""
    monkeypatch.syspath_prepend(SOAK)
    soak = runpy.run_path(str(SOAK / "plans.py"))
    among, plans = soak["machines"](), []
    once = scurve.Ramps._pass
    monkeypatch.setattr(scurve.Ramps, "_pass", lambda ramps, *rests: (plans.append(0), once(ramps, *rests)))
    for seed in (3_468, 3_538):
        machine = among[seed % len(among)]
        program = soak["program_of"](seed, machine)
        plan(build(program, machine, continuity=2), machine, program=program, profile="s-curve")
    assert len(plans) == 2


def test_a_sample_of_the_campaign_of_plans():
    done = subprocess.run([sys.executable, str(SOAK / "plans.py"), "--count", "160"], capture_output=True, text=True,
                          check=False)  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    assert "160 programs" in done.stdout
