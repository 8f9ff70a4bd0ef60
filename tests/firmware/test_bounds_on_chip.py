"""What a board cannot do is refused, or goes slower, before anything moves: it never ends in the board's alarm."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import trochia
from trochia.messages import command as c

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.machine.machine import Machine

STEP = 0.005  # mm
TOO_FAST = "G21 G90 F600\nG1 X1\nF30000\nG1 X60 Y60 Z30\nG1 X0 Y0 Z0\nM2\n"
JUST_SO = "G21 G90 F9000\nG1 X60 Y60\nG1 X0 Y0\nM2\n"


@pytest.fixture
def fast_mill() -> Machine:
    """A mill that is faster than an Uno can step three motors at once."""
    made = trochia.load("reference-mill")
    axes = tuple(replace(a, velocity=200.0, acceleration=2000.0, jerk=100_000.0, home=None) for a in made.axes)
    return replace(made, io=(), axes=axes, joints=tuple(replace(j, pulse_rate=None) for j in made.joints))


@pytest.fixture
def bench(fast_mill: Machine, chip_bench: Callable[[Machine], Any]) -> Any:
    return chip_bench(fast_mill)


def test_a_program_that_is_too_fast_is_refused_with_its_line_and_what_would_do(bench) -> None:
    why = bench.refused(c.Load(name="fast.ngc", text=TOO_FAST))
    assert why.startswith("fast.ngc:4: uno-stepdir: ")
    assert "more than its processor can do" in why
    assert "Lower the feed to " in why
    assert bench.refused(c.Mdi(text="G1 X60 Y60 Z30 F30000")).startswith("<mdi>:1: uno-stepdir: ")
    assert bench.runtime.status.state == "idle"


def test_a_jog_that_is_too_fast_goes_as_fast_as_the_board_can(bench) -> None:
    told = bench.ok(c.JogBy(way={"X": 60.0, "Y": 60.0, "Z": 60.0}, speed=300.0))
    assert told.startswith("slowed to ")
    bench.until("idle")
    np.testing.assert_allclose(bench.steps() * STEP, 60.0, atol=STEP)
    assert not bench.ok(c.JogBy(way={"X": -60.0}, speed=100.0))
    bench.until("idle")


def test_an_override_is_limited_to_what_the_board_can_do(bench) -> None:
    bench.ok(c.Load(name="job.ngc", text=JUST_SO))
    assert not bench.ok(c.Override(feed=2.0))  # nothing runs: nobody knows yet
    assert "; feed override limited to " in bench.ok(c.Run())
    limited = bench.runtime.controller.overrides.feed
    assert 1.0 <= limited < 2.0
    bench.until("running")
    assert not bench.ok(c.Override(feed=0.5))
    assert bench.ok(c.Override(feed=2.0)).startswith("feed override limited to ")
    assert bench.runtime.controller.overrides.feed == limited
    bench.until("idle")
    np.testing.assert_allclose(bench.steps(), 0.0, atol=1.0)
    assert max(np.hypot(*velocity[:2]) for velocity in bench.velocities) > 160.0  # mm/s: more than was programmed
