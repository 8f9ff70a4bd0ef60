"""Steps of real plans at the pins of a board's image: their times, the set-up of their direction, their widths."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from trochia import api
from trochia.backends.avr.ahead import spans_ahead
from trochia.kernels.link import CAUSES, executed

if TYPE_CHECKING:
    from collections.abc import Callable

US = 16  # cycles
WITHIN = 25e-6  # s
BRISK = 1000.0  # steps/s: below, the profile is so flat that rounding of the joints' cubics counts
STEPS, WAYS = ("D2", "D3", "D4"), ("D5", "D6", "D7")
PROGRAMS = {
    "line": "G21 G90 G64 P0.01 F1500\nG1 X12 Y3\nX0 Y0\nM2\n",
    "arc": "G21 G90 G64 P0.01 F1200\nG2 X12 Y0 I6 J0\nM2\n",
    "corners": "G21 G90 G64 P0.02 F1200\nG1 X2\nY2\nX2.5 Y2.5\nX2.4 Y3\nX5\nM2\n",
    "three motors": "G21 G90 G64 P0.01 F1500\nG1 X8 Y5 Z-3\nX0 Y0 Z0\nM2\n",
}


@pytest.mark.parametrize("profile", ["trapezoid", "s-curve"])
@pytest.mark.parametrize("name", PROGRAMS)
def test_steps_come_when_the_plan_has_them(talk: Callable[[str], Any], name: str, profile: str):
    edges = sys.modules["chip_motion"].edges
    machine = api.load("reference-mill")
    plan = api.plan(api.gcode(PROGRAMS[name], machine), machine, profile=profile)
    spans = [span.payload for span in spans_ahead(plan.trajectory, machine, "uno-stepdir")]
    told = talk("uno-stepdir")
    assert CAUSES[int(told.stream(spans)["cause"])] == "no_cause"
    events, wanted = told.events(), executed(b"".join(spans))
    ups = [edges(events, pin, 1) for pin in STEPS]
    planned = [wanted.pulses["tick"][wanted.pulses["pins"] >> j & 1 == 1] for j in range(len(STEPS))]
    assert [len(up) for up in ups] == [len(ticks) for ticks in planned]  # none lost, none doubled
    origin = np.median(np.concatenate([up - ticks for up, ticks in zip(ups, planned, strict=True)]))
    for j, (pin, way, up) in enumerate(zip(STEPS, WAYS, ups, strict=True)):
        if not len(up):
            continue
        turns = np.sort(np.concatenate([edges(events, way, 0), edges(events, way, 1)]))
        turns = turns[turns < up[-1]]
        assert (up[np.searchsorted(up, turns)] - turns >= 4 * US).all()  # set-up of the direction
        assert (edges(events, pin, 0)[-len(up) :] - up).min() >= 1.5 * US
        assert np.diff(up).min() >= 4 * US
        scale = float(machine.joints[j].steps_per_unit or 0)
        times = (up - origin) / 16e6
        place, speed = (each(times)[:, j] * scale for each in (plan.trajectory.position, plan.trajectory.velocity))
        backwards = np.searchsorted(turns, up) & 1 == 1 if len(turns) else np.zeros(len(up), bool)
        ways = np.where(backwards, -1, 1)
        count = np.cumsum(ways)
        off = place - (count - 0.5 * ways)  # steps: one is due halfway between two counts
        seconds = np.abs(off) / np.maximum(np.abs(speed), 1e-9)
        assert np.abs(off).max() <= 0.5
        assert (seconds[np.abs(speed) > BRISK] <= WITHIN).all()
