"""The machine lock: everything runs and is shown, and nothing moves."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from trochia.controller.interrupted import interrupted
from trochia.machine.io import Channel
from trochia.machine.probe import Part, Probe
from trochia.messages import command as c

if TYPE_CHECKING:
    from pathlib import Path

    from trochia.machine.machine import Machine

TEXT = "G21 G90 G94\nG1 X20 F1200\nM64 P0\nG1 Y10\nM65 P0\nM0\nG10 L20 P1 X0\nX-5\nM2\n"


def places(b) -> np.ndarray:
    return np.array([position for _, position, *_ in b.trace])


def test_a_program_runs_and_is_shown_and_nothing_moves(bench, mill: Machine) -> None:
    free = bench(mill).on()
    locked = bench(mill).on()
    locked.ok(c.Switches(machine_lock=True))
    for b in (free, locked):
        b.ok(c.Load(name="p", text=TEXT))
        b.ok(c.Run())
        b.run(until="held")
        b.ok(c.Resume())
        b.run(0.05)
        b.run(until="idle")
    shown, real = places(locked), places(free)
    assert len(shown) == len(real)
    np.testing.assert_allclose(shown, real, atol=1e-9)
    assert not locked.twin.plant.load.any()
    assert not locked.twin._executor.commanded.any()
    assert [s.io["lamp"] for *_, s in locked.trace] == [s.io["lamp"] for *_, s in free.trace]
    assert locked.status.switches.machine_lock
    assert locked.runtime.controller.work.systems[0][0] == pytest.approx(20.0)


def test_opened_the_machine_stands_where_it_stood_and_runs_from_there(bench, mill: Machine) -> None:
    b = bench(mill).on()
    b.ok(c.JogTo(position={"X": 3.0}))
    b.run(until="idle")
    b.ok(c.Switches(machine_lock=True))
    b.ok(c.Mdi(text="G0 X50"))
    b.run(until="idle")
    assert b.at("X") == pytest.approx(50.0)
    b.ok(c.Switches(machine_lock=False))
    b.ok(c.Mdi(text="G91 G0 X1"))  # at once: nobody has looked in between
    b.run(until="idle")
    assert b.at("X") == pytest.approx(4.0)
    assert b.twin.plant.load[0] == pytest.approx(4.0)


def test_held_aborted_and_stopped_as_ever(bench, mill: Machine) -> None:
    b = bench(mill).on()
    b.ok(c.Switches(machine_lock=True))
    b.ok(c.Load(name="p", text="G21 G90 G94\nG1 X40 F1200\nM2\n"))
    b.ok(c.Run())
    b.run(0.4)
    refused = b.command(c.Switches(machine_lock=False))
    assert not refused.ok
    assert "at rest" in refused.reason
    b.ok(c.Hold())
    here = b.run(until="held").axes[0].commanded
    assert 0.0 < here < 40.0
    b.ok(c.Resume())
    b.run(0.3)
    b.ok(c.Abort())
    b.run(until="idle")
    b.ok(c.EmergencyStop())
    assert b.run(0.02).state == "estop"
    assert not b.twin.plant.load.any()


def test_the_beam_stays_dark(bench, laser: Machine) -> None:
    b = bench(laser).on()
    b.ok(c.ArmBeam(on=True))
    b.ok(c.Switches(machine_lock=True))
    b.ok(c.Load(name="p", text="G21 G90 G94 M3 S80\nG1 X20 F1200\nM2\n"))
    b.ok(c.Run())
    b.run(0.5)
    assert b.twin._beam == 0.0
    assert not b.twin._lit
    b.run(until="idle")
    assert not any(beam for _, _, beam, _ in b.trace)


def test_nothing_is_found_under_it(bench, homed_mill: Machine) -> None:
    made = replace(homed_mill, io=(*homed_mill.io, Channel(name="probe", kind="input")),
                   probe=Probe(input="probe", part=Part(top=-5.0)))  # fmt: skip
    b = bench(made).on()
    b.ok(c.Switches(machine_lock=True))
    assert "machine lock" in b.command(c.Home()).reason
    b.runtime.controller.trusted = dict.fromkeys("XYZ", True)
    assert "machine lock" in b.command(c.Mdi(text="G38.2 Z-9 F100")).reason


def test_a_job_under_it_is_not_one_to_go_on_with(bench, mill: Machine, tmp_path: Path) -> None:
    b = bench(mill, journal=tmp_path).on()
    b.ok(c.Switches(machine_lock=True))
    b.ok(c.Load(name="p", text="G21 G90 G94\nG1 X40 F1200\nM2\n"))
    b.ok(c.Run())
    b.run(0.5)
    assert interrupted(tmp_path) is None
    b.ok(c.Abort())
    b.run(until="idle")
    assert not b.command(c.RunFrom(line=0)).ok
