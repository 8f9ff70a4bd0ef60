"""What a program says while it runs: in the status, once, when the machine comes to it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.messages import command as c

if TYPE_CHECKING:
    from trochia.machine.machine import Machine

TEXT = "G21 G90 F1200\n(MSG, out)\nG1 X10\n(DEBUG, at #<_x>)\nG1 X0\n(LOGOPEN, a.txt)\n(LOG, home)\nM2\n"


def test_the_status_has_what_the_program_has_said_last(bench, mill: Machine) -> None:
    b = bench(mill).on()
    assert b.status.message == ""
    b.ok(c.Load(name="part", text=TEXT))
    b.ok(c.Run())
    assert b.run(0.1).message == "out"
    b.run(until="idle")
    heard = list(dict.fromkeys(status.message for _, _, _, status in b.trace if status.message))
    assert heard == ["out", "at 10.000000", "home"]
    assert b.status.message == "home"


def test_a_hold_repeats_nothing(bench, mill: Machine) -> None:
    b = bench(mill).on()
    b.ok(c.Load(name="part", text=TEXT))
    b.ok(c.Run())
    b.run(0.3)
    job = b.runtime.controller.activity
    for _ in range(3):
        b.ok(c.Hold())
        b.run(until="held")
        b.ok(c.Resume())
        b.run(0.1)
    b.run(until="idle")
    assert [told.text.strip() for told in job.doings.told] == ["out", "at 10.000000", "", "home"]
