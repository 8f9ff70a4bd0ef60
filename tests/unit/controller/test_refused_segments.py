"""What the backend refuses stops the machine in the same turn, dark."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.errors import LinkError
from trochia.messages import command as c

if TYPE_CHECKING:
    import pytest

    from trochia.machine.machine import Machine

BURN = "G21 G90 G94 F1500\nM3 S50\nG1 X40\nM5\nM2\n"


def test_the_beam_goes_out_before_the_next_tick_when_segments_are_refused(
    bench, laser: Machine, monkeypatch: pytest.MonkeyPatch
) -> None:
    b = bench(laser).on()
    b.ok(c.ArmBeam(on=True))
    b.ok(c.Load(name="burn", text=BURN))
    b.ok(c.Run())
    b.run(0.6)
    assert b.trace[-1][2] > 0.0
    order = b.twin.order

    def picky(given, now: float) -> None:
        if given.segments is not None:
            raise LinkError("joint 0 would jump")
        order(given, now)

    monkeypatch.setattr(b.twin, "order", picky)
    b.ok(c.Hold())
    b.run(0.005)
    assert b.trace[-1][2] == 0.0
    status = b.run(0.5)
    assert [alarm.cause.value for alarm in status.alarms] == ["link-lost"]
    assert status.speed == 0.0
