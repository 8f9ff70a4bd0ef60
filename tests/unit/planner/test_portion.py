"""Phases between two instants, however many are in hand."""

from __future__ import annotations

import numpy as np
import pytest

from trochia.kernels.layout import PHASE
from trochia.planner.live.portion import between


def phases_of(rng, count):
    """Phases one after another, some of no duration, some whose ends are the next one's begin but for rounding."""
    phases = np.zeros(count, dtype=PHASE)
    phases["duration"] = rng.choice([0.0, 1e-3, 0.1, 0.3], count) * rng.uniform(0.5, 1.0, count)
    phases["t"] = np.concatenate([[0.0], np.cumsum(phases["duration"])[:-1]])
    phases["v"], phases["segment"] = 10.0, np.arange(count)
    return phases


@pytest.mark.parametrize("seed", range(20))
def test_what_lies_between_two_instants_is_every_phase_under_way(seed):
    rng = np.random.default_rng(seed)
    phases = phases_of(rng, 40)
    end = float(phases["t"][-1] + phases["duration"][-1])
    joints = [*phases["t"].tolist(), -1.0, 0.0, end, end + 1.0, np.inf, *rng.uniform(0.0, end, 20)]
    for low in rng.choice(joints[:-1], 10):
        for high in rng.choice(joints, 10):
            under_way = (phases["t"] + phases["duration"] > low) & (phases["t"] < high)
            kept = between(phases, float(low), float(high))
            assert (kept["segment"] == phases["segment"][under_way]).all()
            if len(kept):
                assert kept["t"][0] == max(low, phases["t"][under_way][0])
                assert kept["t"][-1] + kept["duration"][-1] == pytest.approx(min(high, end))
                assert kept["s"][0] == pytest.approx(10.0 * (kept["t"][0] - phases["t"][under_way][0]))


def test_phases_in_hand_are_not_changed():
    phases = phases_of(np.random.default_rng(1), 10)
    before = phases.copy()
    between(phases, 0.05, 0.4)
    assert (phases == before).all()
