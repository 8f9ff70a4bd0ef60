"""Outputs that change by themselves: back after their time, and with an input."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from trochia.errors import ConfigError
from trochia.machine.io import Channel
from trochia.messages import command as c

if TYPE_CHECKING:
    from trochia.machine.machine import Machine


def test_a_timed_output_goes_back_when_its_time_is_over(bench, mill: Machine) -> None:
    b = bench(replace(mill, io=(*mill.io, Channel(name="puff", kind="timed", duration=0.25)))).on()
    b.ok(c.Mdi(text="M64 P1"))
    on = 0.0
    for _ in range(120):
        before = b.now
        b.run(0.005)
        on += (b.now - before) * b.status.io["puff"]
    assert on == pytest.approx(0.25, abs=0.011)  # a turn to be seen, and a turn to be set
    b.ok(c.SetOutput(name="puff", value=1.0))  # and again
    b.run(0.1)
    assert b.status.io["puff"] == 1.0
    b.run(0.2)
    assert b.status.io["puff"] == 0.0


def test_an_output_follows_its_input_in_every_state(bench, mill: Machine) -> None:
    b = bench(replace(mill, io=(*mill.io, Channel(name="light", kind="latched", follows="door"))))
    for level in (1.0, 0.0, 1.0):
        b.ok(c.SetInput(name="door", value=level))
        b.run(0.02)
        assert b.status.io["light"] == level
    b.on()
    b.ok(c.SetOutput(name="light", value=0.0))
    b.run(0.02)
    assert b.status.io["light"] == 1.0


def test_only_a_latched_output_follows_and_only_an_input(mill: Machine) -> None:
    with pytest.raises(ConfigError, match="only a latched output"):
        Channel(name="light", kind="input", follows="door")
    with pytest.raises(ConfigError, match="no input 'dor'"):
        replace(mill, io=(*mill.io, Channel(name="light", kind="latched", follows="dor")))
