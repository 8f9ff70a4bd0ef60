"""A machine, its twin, and the controller, in virtual time."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

import trochia
from trochia.backends.live_twin import LiveTwin
from trochia.backends.switches import switches_of
from trochia.controller.runtime import Runtime
from trochia.machine.homing import Homing, LimitSwitch
from trochia.machine.io import Beam, Channel
from trochia.messages.command import Enable

if TYPE_CHECKING:
    from pathlib import Path

    from trochia.machine.machine import Machine
    from trochia.messages import Ack, AnyCommand, Status

TURN = 0.005


class Bench:
    """A machine on its twin, stepped by hand."""

    def __init__(self, machine: Machine, *, real: dict[str, float] | None = None, journal: Path | None = None) -> None:
        self.machine = machine
        position = np.array([(real or {}).get(joint.name, 0.0) for joint in machine.joints])
        self.twin = LiveTwin(machine, position=position, switches=switches_of(machine))
        self.now = 0.0
        self.runtime = Runtime(self.twin, journal=journal)
        self.trace: list[tuple[float, np.ndarray, float, Status]] = []

    @property
    def status(self) -> Status:
        return self.runtime.controller.status(self.now)

    def command(self, command: AnyCommand) -> Ack:
        return self.runtime.command(command, self.now)

    def ok(self, command: AnyCommand) -> Ack:
        answer = self.command(command)
        assert answer.ok, answer.reason
        return answer

    def run(self, seconds: float = 0.0, *, until: str = "", most: float = 120.0) -> Status:
        begin = self.now
        while True:
            self.now = round(self.now + TURN, 9)
            self.runtime.turn(self.now)
            report = self.runtime.controller.report
            self.trace.append((self.now, report.commanded.copy(), report.beam, self.runtime.status))
            state = self.runtime.controller.state.value
            if until and state == until:
                return self.status
            if not until and self.now - begin >= seconds:
                return self.status
            assert self.now - begin < most, f"{state} after {most} s, not {until}"

    def on(self) -> Bench:
        self.ok(Enable())
        self.run(0.02)
        return self

    def at(self, axis: str) -> float:
        return next(a.commanded for a in self.status.axes if a.name == axis)


@pytest.fixture
def mill() -> Machine:
    made = trochia.load("reference-mill")
    return replace(made, io=(Channel(name="lamp", kind="latched"), Channel(name="door", kind="input")))


@pytest.fixture
def laser() -> Machine:
    made = trochia.load("xy-table")
    return replace(made, beam=Beam(kind="power", full_power=100.0))


@pytest.fixture
def homed_mill(mill: Machine) -> Machine:
    axes = tuple(
        replace(
            axis,
            home=Homing(input=f"home-{axis.name}", towards="-", position=axis.minimum + 1.0, rest=axis.minimum + 5.0),
            limit_minus=LimitSwitch(input=f"limit-{axis.name}", at=axis.minimum - 2.0),
        )
        for axis in mill.axes
    )
    names = [f"{what}-{axis.name}" for axis in axes for what in ("home", "limit")]
    return replace(mill, axes=axes, io=(*mill.io, *(Channel(name=name, kind="input") for name in names)))


@pytest.fixture
def bench() -> type[Bench]:
    return Bench
