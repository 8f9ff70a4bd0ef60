"""A machine on its twin, the gateway before it, a sender before that: one virtual clock for all."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest

import trochia
from trochia.backends.live_twin import LiveTwin
from trochia.backends.switches import switches_of
from trochia.controller.runtime import Runtime
from trochia.gateways.grbl import Service, TcpDoor, TerminalDoor
from trochia.machine.homing import Homing, LimitSwitch
from trochia.machine.io import Channel

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from trochia.machine.machine import Machine

STEP = 0.005


class MemoryDoor:
    """A door without a system behind it."""

    name = "memory"

    def __init__(self) -> None:
        self.inward, self.outward = bytearray(), bytearray()
        self.gone = False

    def read(self) -> bytes | None:
        data = bytes(self.inward)
        self.inward.clear()
        return None if self.gone else data

    def write(self, data: bytes) -> None:
        self.outward += data

    def close(self) -> None:
        pass


def with_switches(machine: Machine) -> Machine:
    """Return a machine whose axes have a home switch near their lower end, and travel of 40 mm."""
    axes = tuple(
        replace(axis, minimum=-20.0, maximum=20.0,
                home=Homing(input=f"home-{axis.name}", towards="-", position=-19.0, rest=-15.0),
                limit_minus=LimitSwitch(input=f"limit-{axis.name}", at=-22.0))
        for axis in machine.axes
    )  # fmt: skip
    names = [f"{what}-{axis.name}" for axis in axes for what in ("home", "limit")]
    return replace(machine, axes=axes, io=tuple(Channel(name=name, kind="input") for name in names))


class Plant:
    """The machine with its gateway."""

    def __init__(self, machine: str, door: Any, *, arm: bool = False, homed: bool = False) -> None:
        made = with_switches(trochia.load(machine)) if homed else trochia.load(machine)
        self.runtime = Runtime(LiveTwin(made, switches=switches_of(made)))
        self.door = door
        self.service = Service(self.runtime, door, arm=arm)
        self.now = 0.0
        self.beside: Callable[[float], object] = lambda _: None

    def run(self, seconds: float, until: Callable[[], bool] | None = None) -> None:
        end = self.now + seconds
        while self.now < end:
            self.now += STEP
            self.service.turn(self.now)
            self.runtime.turn(self.now)
            self.beside(self.now)
            if until is not None and until():
                return
        assert until is None, "it never came to that"

    def say(self, text: str | bytes, seconds: float = 0.3) -> list[str]:
        """Say something, let time pass, and return what was answered."""
        self.door.inward += text.encode() if isinstance(text, str) else text
        self.run(seconds)
        lines = self.door.outward.decode("ascii").split("\r\n")
        self.door.outward.clear()
        return [line for line in lines if line]

    def status(self) -> str:
        return self.say("?", 0.01)[-1]

    def place(self) -> dict[str, float]:
        return {axis.name: axis.commanded for axis in self.runtime.status.axes}


@pytest.fixture
def plants() -> Iterator[Callable[..., Plant]]:
    made: list[Plant] = []

    def make(machine: str = "reference-mill", door: str = "memory", **options: Any) -> Plant:
        doors = {"memory": MemoryDoor, "terminal": TerminalDoor, "tcp": TcpDoor}
        made.append(Plant(machine, doors[door](), **options))
        return made[-1]

    yield make
    for plant in made:
        plant.door.close()
        plant.runtime.close()


@pytest.fixture
def mill(plants: Callable[..., Plant]) -> Plant:
    plant = plants()
    assert plant.say("") == ["Grbl 1.1h ['$' for help]"]
    return plant
