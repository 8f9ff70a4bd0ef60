"""Back along the path from a hold, and on again."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from trochia.messages import command as c

if TYPE_CHECKING:
    from trochia.machine.machine import Machine

CORNER = "G21 G90 G94 G61 F3000\nG1 X40\nY40\nM2\n"
BURN = "G21 G90 G94 G61 F1500\nG1 X10\nM3 S50\nG1 X40\nY40\nM5\nM2\n"


def held(bench: type[Any], machine: Machine, text: str, seconds: float) -> Any:
    b = bench(machine).on()
    b.command(c.ArmBeam(on=True))
    b.ok(c.Load(name="part", text=text))
    b.ok(c.Run())
    b.run(seconds)
    b.ok(c.Hold())
    b.run(until="held")
    return b


def test_reverse_goes_back_along_the_path_and_a_resume_ends_at_the_same_point(bench: type[Any], mill: Machine) -> None:
    b = held(bench, mill, CORNER, 1.2)
    x, y = b.at("X"), b.at("Y")
    assert x == pytest.approx(40.0)
    assert 0.0 < y < 40.0
    b.ok(c.Reverse(way=y + 15.0))
    b.trace.clear()
    status = b.run(until="held")
    assert status.speed == 0.0
    assert (b.at("X"), b.at("Y")) == pytest.approx((25.0, 0.0), abs=1e-6)
    for _, (along, across, _), _, _ in b.trace:
        assert min(abs(along - 40.0), abs(across)) < 1e-6  # on the two lines
    b.ok(c.Resume())
    status = b.run(until="idle")
    assert (b.at("X"), b.at("Y")) == pytest.approx((40.0, 40.0), abs=1e-9)
    assert not status.alarms


def test_a_hold_on_the_way_back_is_obeyed_and_more_can_be_gone_back(bench: type[Any], mill: Machine) -> None:
    b = held(bench, mill, CORNER, 0.6)
    x = b.at("X")
    b.ok(c.Reverse(way=20.0))
    b.run(0.2)
    b.ok(c.Hold())
    b.run(until="held")
    between = b.at("X")
    assert x - 20.0 < between < x
    b.ok(c.Reverse(way=3.0))
    b.run(until="held")
    assert b.at("X") == pytest.approx(between - 3.0, abs=1e-6)
    b.ok(c.Reverse(way=1000.0))
    b.run(until="held")
    assert b.at("X") == pytest.approx(0.0, abs=1e-6)
    b.ok(c.Resume())
    b.run(until="idle")
    assert (b.at("X"), b.at("Y")) == pytest.approx((40.0, 40.0), abs=1e-9)


def test_the_way_back_is_dark_and_ends_where_the_program_switched_something(bench: type[Any], laser: Machine) -> None:
    b = held(bench, laser, BURN, 1.0)
    assert 15.0 < b.at("X") < 40.0
    b.ok(c.Reverse(way=100.0))
    b.trace.clear()
    b.run(until="held")
    assert not any(beam for _, _, beam, _ in b.trace)
    assert b.at("X") == pytest.approx(10.0, abs=1e-6)
    b.ok(c.Resume())
    b.trace.clear()
    b.run(until="idle")
    lit = np.array([place[:2] for _, place, beam, _ in b.trace if beam])
    assert lit[:, 0].min() < 10.5
    assert lit[:, 1].max() > 39.0
    assert (b.at("X"), b.at("Y")) == pytest.approx((40.0, 40.0), abs=1e-9)


def test_what_is_not_held_is_not_reversed(bench: type[Any], mill: Machine) -> None:
    b = bench(mill).on()
    assert not b.command(c.Reverse(way=1.0)).ok
    b.ok(c.Load(name="pause", text="G21 G90 G94 F3000\nG1 X5\nM0\nG1 X9\nM2\n"))
    b.ok(c.Run())
    b.run(until="held")
    answer = b.command(c.Reverse(way=1.0))
    assert "waits" in answer.reason
    assert b.status.state == "held"


@pytest.mark.parametrize("feed", [1.0, 0.5])
def test_progress_tells_the_place_on_the_program_which_falls_on_the_way_back(
    bench: type[Any], mill: Machine, feed: float
) -> None:
    b = bench(mill).on()
    b.ok(c.Override(feed=feed))
    b.ok(c.Load(name="part", text=CORNER))
    b.ok(c.Run())
    out = []
    while b.status.program.done_s < 1.2 / feed:
        b.run(0.02)
        out.append((b.at("X") + b.at("Y"), b.status.program.done_s))
    b.ok(c.Hold())
    b.run(until="held")
    b.ok(c.Reverse(way=35.0))
    back = []
    while b.runtime.controller.state.value != "held":
        b.run(0.02)
        back.append((b.at("X") + b.at("Y"), b.status.program.done_s))
    ways, falling = np.array(back).T
    assert (np.diff(falling) <= 1e-9).all()
    assert falling[0] - falling[-1] > 0.5 / feed
    before = ways < out[-1][0] - 5.0  # where the hold had not braked it yet
    assert falling[before] == pytest.approx(np.interp(ways[before], *np.array(out).T), abs=0.05 / feed)
    began = b.now
    b.ok(c.Resume())
    b.run(0.3)
    assert b.status.program.done_s - falling[-1] == pytest.approx(b.now - began, abs=0.03)


def test_all_the_way_back_nothing_is_done_and_the_whole_time_is_left(bench: type[Any], mill: Machine) -> None:
    b = held(bench, mill, CORNER, 0.6)
    b.ok(c.Reverse(way=1000.0))
    program = b.run(until="held").program
    assert program.done_s == pytest.approx(0.0, abs=1e-3)
    assert program.remaining_s == pytest.approx(program.time_s, abs=1e-3)
    b.ok(c.Resume())
    most = 0.0
    while b.runtime.controller.state.value != "idle":
        most = max(most, b.status.program.done_s)
        b.run(0.02)
    assert most == pytest.approx(program.time_s, abs=0.05)
