"""Laws of changing time: inside the slews of each phase every limit holds, and every stop comes to rest."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.planner import PROFILES, plan
from trochia.planner.slews import slews, stop
from trochia.planner.timebase import TimeBase, Timed
from trochia.toolpath import build


@pytest.mark.parametrize("profile", sorted(PROFILES))
@given(data=st.data())
def test_a_stop_by_time_alone_keeps_every_limit(motion, profile, data):
    machine = motion.machines["mill"]
    program = data.draw(motion.programs(replace(machine), most=6))
    whole = plan(build(program, machine, continuity=PROFILES[profile].continuity), machine, program=program,
                 profile=profile)  # fmt: skip
    if whole.schedule is None:
        return
    phases = np.concatenate(list(whole.blocks()))
    jerky = whole.schedule.jerk_limited
    rows = slews(whole.path.segments, whole.path.pool, whole.limits, phases, jerky=jerky)
    assert (rows["slow"] >= 0.0).all()
    assert (rows["quick"] >= 0.0).all()
    base = stop(rows, TimeBase.even(), data.draw(st.floats(0, 1)) * whole.duration)
    assert base.rate[-1] == 0.0
    timed = Timed(trajectory=whole, base=base)
    t = np.unique(
        np.concatenate([np.linspace(a, b, 60)[1:-1] for a, b in zip(base.t, base.t[1:], strict=False)] or [[]])
    )
    t = t[base.at(t) < whole.duration]
    if not len(t):
        return
    limits = (whole.limits.velocity, whole.limits.acceleration, whole.limits.jerk)
    for value, limit in zip((timed.velocity(t), timed.acceleration(t), timed.jerk(t)), limits[: 3 if jerky else 2],
                            strict=False):  # fmt: skip
        assert (np.abs(value @ whole.limits.matrix.T) <= limit * (1 + 1e-9)).all()
