"""Hold, resume and abort at any instant: a sample of the campaign of ``make soak``, and whether it finds a fault."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

if TYPE_CHECKING:
    from types import ModuleType

SEEDS = range(1, 15)


@pytest.fixture(scope="module")
def holds() -> ModuleType:
    path = Path(__file__).parents[1] / "soak" / "holds.py"
    spec = importlib.util.spec_from_file_location("holds", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_sample_keeps_the_rules_of_motion(holds: ModuleType) -> None:
    grounds: dict[tuple[str, str], object] = {}
    done = [holds.case(seed, grounds) for seed in SEEDS]
    assert {"resume", "abort", "again"} <= set(done)


def test_the_campaign_sees_a_place_off_the_path(holds: ModuleType) -> None:
    base = holds.ground("contour", "laser")
    b = holds.Bench(base, 5.0)
    for _ in range(40):
        b.turn()
    holds.keeps_path(b)
    holds.keeps_limits(b, b.job.feeder.live, 5.0)
    at, place, beam = b.ticks[-1]
    b.ticks = [(at, place + np.array([0.0, 0.5]), beam)]
    with pytest.raises(AssertionError, match="from the path"):
        holds.keeps_path(b)
