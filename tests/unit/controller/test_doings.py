"""What a job does beside moving: beam power by path speed, overrides at rest, outputs of a job that is given up."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from trochia.controller.doings import dynamic_moves
from trochia.languages import gcode
from trochia.machine.io import Channel
from trochia.messages import command as c

if TYPE_CHECKING:
    from trochia.machine.machine import Machine

LINE = "G21 G90 G94\nG1 X40 F1200\nM2\n"


def lit(b) -> tuple[np.ndarray, np.ndarray]:
    """Return speed and beam power over the run."""
    rows = [(status.speed, beam) for _, _, beam, status in b.trace if status.state == "running"]
    return np.array([speed for speed, _ in rows]), np.array([beam for _, beam in rows])


@pytest.mark.parametrize("word", ["M3", "M4"])
def test_the_beam_follows_the_path_speed_where_m4_asks_for_it(bench, laser: Machine, word: str) -> None:
    b = bench(laser).on()
    b.ok(c.ArmBeam(on=True))
    b.ok(c.Load(name="p", text=f"G21 G90 {word} S80\nG1 X40 F1200\nM2\n"))
    b.ok(c.Run())
    b.run(until="idle")
    speed, beam = lit(b)
    moving = (speed > 1.0) & (beam > 0.0)
    assert moving.sum() > 50
    slow = moving & (speed < 15.0)
    assert slow.sum() > 5
    if word == "M4":
        # a status is at most a turn older or newer than the beam: what speed can change by in a turn, and a row
        np.testing.assert_allclose(beam[moving], 80.0 * speed[moving] / 20.0, atol=80.0 * 133.0 * 0.03 / 20.0)
    else:
        assert set(beam[moving].tolist()) == {80.0}


def test_moves_are_dynamic_from_m4_on_until_m3() -> None:
    program = gcode.read("G21 S5\nM4 G1 X1 F100\nX2\nM3\nX3\nM5\nX4\nM2\n")
    assert dynamic_moves(program).tolist() == [True, True, False, False]


def test_an_override_set_while_held_acts_from_the_resume_on(bench, mill: Machine) -> None:
    b = bench(mill).on()
    b.ok(c.Load(name="p", text=LINE))
    b.ok(c.Run())
    b.run(0.4)
    b.ok(c.Hold())
    b.run(until="held")
    b.ok(c.Override(feed=0.5))
    b.ok(c.Resume())
    b.run(0.6)
    assert b.status.speed == pytest.approx(10.0, rel=1e-3)
    assert b.run(until="idle").axes[0].commanded == pytest.approx(40.0, abs=1e-9)


def test_an_override_of_nought_holds_and_nothing_starts_under_it(bench, mill: Machine) -> None:
    b = bench(mill).on()
    b.ok(c.Load(name="p", text=LINE))
    b.ok(c.Run())
    b.run(0.4)
    assert "held" in b.ok(c.Override(feed=0.0)).told
    assert b.run(until="held").speed == 0.0
    answer = b.command(c.Resume())
    assert not answer.ok
    assert "override is 0" in answer.reason
    b.ok(c.Abort())
    assert not b.command(c.Run()).ok
    b.ok(c.Override(feed=1.0))
    b.ok(c.Run())
    b.run(until="idle")


def test_a_job_given_up_sets_nothing_of_what_was_still_to_come(bench, mill: Machine) -> None:
    b = bench(mill).on()
    b.ok(c.Load(name="p", text="G21 G90 G94\nG1 X40 F1200\nM64 P0\nX0\nM2\n"))
    b.ok(c.Run())
    b.run(0.4)
    b.ok(c.Abort())
    b.run(until="idle")
    b.run(0.1)
    assert b.status.io["lamp"] == 0.0


def test_outputs_that_are_not_there_and_actions_that_are_not_built_are_refused_before_anything_moves(
    bench, mill: Machine
) -> None:
    b = bench(mill).on()
    for text, why in (("M64 P7\nM2\n", "output number 7"), ("G21 M3 S100\nG33 Z-2 K1\nM2\n", "spindle")):
        b.ok(c.Load(name="p", text=text))
        answer = b.command(c.Run())
        assert not answer.ok
        assert why in answer.reason
        assert b.status.state == "idle"


def test_the_same_pause_twice_at_one_place_is_two_pauses(bench, mill: Machine) -> None:
    b = bench(mill).on()
    b.ok(c.Load(name="p", text="o1 sub\nM0\no1 endsub\nG21 G1 X1 F600\no1 call\no1 call\nX2\nM2\n"))
    b.ok(c.Run())
    for _ in range(2):
        assert b.run(until="held").axes[0].commanded == pytest.approx(1.0, abs=1e-6)
        b.ok(c.Resume())
    b.run(0.02)
    assert b.run(until="idle").axes[0].commanded == pytest.approx(2.0, abs=1e-9)


def test_the_spindle_override_scales_what_turns_and_the_spindle_bounds_it(bench, mill: Machine) -> None:
    from trochia.machine.io import Spindle  # noqa: PLC0415 - of this test alone

    b = bench(replace(mill, spindle=Spindle(maximum=1500.0))).on()
    b.ok(c.Load(name="p", text="G21 M3 S1000\nG1 X40 F1200\nM2\n"))
    b.ok(c.Run())
    b.run(0.2)
    for factor, speed in ((0.5, 500.0), (1.0, 1000.0), (2.0, 1500.0)):
        b.ok(c.Override(spindle=factor))
        b.run(0.05)
        assert b.status.spindle == speed


def test_a_fault_while_held_ends_the_job_and_its_questions(bench, mill: Machine) -> None:
    b = bench(replace(mill, io=(*mill.io, Channel(name="x", kind="input")))).on()
    b.ok(c.Load(name="p", text="G21 G1 X1 F600\nM0\nX2\nM2\n"))
    b.ok(c.Run())
    assert b.run(until="held").request is not None
    b.twin.faulty.add("X")
    assert b.run(until="alarm").request is None
    b.twin.faulty.clear()
    b.ok(c.Acknowledge())
    b.run(until="off")


def test_drives_that_go_off_by_themselves_are_a_fault(bench, mill: Machine) -> None:
    b = bench(mill).on()
    b.twin._enabled = False
    status = b.run(until="alarm")
    assert status.alarms[0].cause.value == "drive-fault"
    assert not any(axis.trusted for axis in status.axes)
