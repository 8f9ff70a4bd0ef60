"""The shield's sketches as host programs: the chip's register has, byte for byte, what the Python shield has."""

from __future__ import annotations

import functools
import itertools
import math
import runpy
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from trochia.backends.avr.transports import ChipTransport
from trochia.errors import RemoteProtocolError
from trochia.stepper import BACKWARD, DOUBLE, FORWARD, Calls, PacedTime, Stepper, StepperGroup, VirtualTime
from trochia.stepper.board import BoardShield

if TYPE_CHECKING:
    from collections.abc import Callable

SKETCHES = Path(__file__).parents[2] / "examples" / "steppers"


@pytest.fixture
def sketch(
    chip_program: Path,
    board_image: Callable[[str], Path],
    monkeypatch: pytest.MonkeyPatch,
    request: pytest.FixtureRequest,
):
    """Runs a sketch with a board on the simulated chip, keys typed when it waits for some; returns shield and pins."""

    def begin(name: str, *options: str, keys: tuple[str, ...] = ()) -> tuple[BoardShield, np.ndarray]:
        line = ChipTransport(chip_program, board_image("uno-l293d-1000000"))
        request.addfinalizer(line.chip.close)
        line.edges, shields, typed = [], [], list(keys)
        (script,) = SKETCHES.glob(f"{name}_*.py")
        monkeypatch.syspath_prepend(str(SKETCHES))
        monkeypatch.setattr(sys, "argv", [str(script), "--pace", "0", "--backend", "avr", "--port", "chip", *options])
        terminal: Any = __import__("terminal")

        def listen(self: Any, patience: float | None) -> None:
            if patience is None:
                if not typed:
                    raise terminal.SwitchedOffError
                self._keys.extend(typed.pop(0).encode())

        monkeypatch.setattr(terminal.Terminal, "_listen", listen)
        monkeypatch.setattr(terminal, "SerialTransport", lambda _port: line)
        made = BoardShield.__init__

        def noted(self: BoardShield, time: Any, transport: Any) -> None:
            made(self, time, transport)
            shields.append(self)

        monkeypatch.setattr(BoardShield, "__init__", noted)
        runpy.run_path(str(script))
        return shields[0], np.concatenate(line.edges)

    return begin


def without_repeats(bytes_: list[int]) -> list[int]:
    """Leave out empty bytes that follow an empty one: what is released already needs no other."""
    return [byte for i, byte in enumerate(bytes_) if byte or (i and bytes_[i - 1])]


@pytest.mark.parametrize(
    ("name", "options", "keys", "steps"),
    [
        ("01", ("--seconds", "1.5"), (), 30),  # for ever, until the power goes
        ("04", ("--seconds", "4"), (), 8),  # single steps, half a second apart
        ("03", ("--seconds", "3.5"), (), 100),  # ways of excitation
        ("07", ("--rpm", "280"), (), 200),  # a search
        ("15", (), (), 400),  # a ramp
        ("09", (), ("-300\n",), 1000),  # a speed by number
        ("12", (), ("S450A300D80S",), 80),  # a command
        ("16", (), ("ARDS",), 600),  # the speed controller
    ],
)
def test_the_board_makes_what_the_sketch_makes(
    sketch: Callable[..., Any], register: Any, *, name: str, options: tuple[str, ...], keys: tuple[str, ...], steps: int
):
    shield, events = sketch(name, *options, keys=keys)
    register.feed(events)
    wanted = without_repeats([byte for _, byte in shield.latched])
    assert sum(byte != 0 for byte in wanted) >= steps
    found = without_repeats(register.bytes)
    assert found[: len(wanted)] == wanted
    assert found[len(wanted) :] in ([], [0])  # drives off at the end
    python = np.array([moment for moment, byte in shield.latched if byte])
    chip = np.array([cycle / 16e6 for cycle, byte in register.latched if byte])
    gaps = np.diff(python)
    off = np.abs(np.diff(chip) - gaps)[gaps <= 0.25]  # longer rests last as long as they take
    assert off.max(initial=0.0) < 60e-6


def test_another_board_is_refused(chip_program: Path, board_image: Callable[[str], Path]):
    line = ChipTransport(chip_program, board_image("uno-stepdir-1000000"))
    with pytest.raises(RemoteProtocolError, match="the board is uno-stepdir, not uno-l293d"):
        BoardShield(VirtualTime(), line)
    line.close()


class Walled:
    """A simulated chip by the wall's clock, as a serial port has it."""

    stride = 0.0
    place = "on a simulated chip by the wall's clock"

    def __init__(self, line: ChipTransport) -> None:
        self.line, self.baud = line, line.baud

    def __getattr__(self, name: str) -> Any:
        return getattr(self.line, name)


def test_a_ramp_and_a_rest_on_a_board_by_the_walls_clock(
    chip_program: Path, board_image: Callable[[str], Path], register: Any, monkeypatch: pytest.MonkeyPatch
):
    """The board turns while the program goes on, and a rest longer than its patience with a silent host is one."""
    line = ChipTransport(chip_program, board_image("uno-l293d-1000000"))
    line.edges, wall = [], [100.0]
    monkeypatch.setattr(time, "monotonic", lambda: wall[0])
    monkeypatch.setattr(time, "sleep", lambda seconds: wall.__setitem__(0, wall[0] + seconds))
    time_ = PacedTime()
    shield = BoardShield(time_, Walled(line))
    motor = shield.motor(1)
    motor.set_speed(60)
    motor.step(200, FORWARD, DOUBLE)
    assert sum(edges.size for edges in line.edges) > 200  # type: ignore[attr-defined] - it did not wait for the end
    time_.wait(2.5)
    motor.step(20, BACKWARD, DOUBLE)
    shield.close()
    register.feed(np.concatenate(line.edges))  # type: ignore[arg-type]
    assert len([byte for byte in register.bytes if byte]) == 220


def test_both_motors_at_once(chip_program: Path, board_image: Callable[[str], Path], register: Any):
    line = ChipTransport(chip_program, board_image("uno-l293d-1000000"))
    line.edges = []
    time_ = VirtualTime()
    shield = BoardShield(time_, line)
    steppers: list[Stepper] = []
    for port in (1, 2):
        coils = shield.motor(port)
        calls = Calls(functools.partial(coils.onestep, 1, DOUBLE), functools.partial(coils.onestep, -1, DOUBLE))
        steppers.append(Stepper(calls, time_))
        steppers[-1].set_max_speed(600)
        steppers[-1].set_acceleration(1500)
    group = StepperGroup(*steppers)
    group.move_to([400, -300])
    group.run_to_position()
    shield.close()
    register.feed(np.concatenate(line.edges))  # type: ignore[arg-type]
    steps = {0x1E: 0, 0xE1: 0}  # bits of motor 1 and 2: changes of each
    for before, after in itertools.pairwise([0, *register.bytes]):
        for bits in steps:
            steps[bits] += (before ^ after) & bits != 0 and after & bits != 0
    assert steps == {0x1E: 400, 0xE1: 300}
    span = (register.latched[-2][0] - register.latched[1][0]) / 16e6
    assert span == pytest.approx(time_.now - math.sqrt(2 / 1500), abs=0.02)


def test_a_halt_stops_at_once_and_releases(chip_program: Path, board_image: Callable[[str], Path], register: Any):
    line = ChipTransport(chip_program, board_image("uno-l293d-1000000"))
    line.edges = []
    time_ = VirtualTime()
    shield = BoardShield(time_, line)
    motor = shield.motor(1)
    motor.set_speed(60)
    motor.step(500, FORWARD, DOUBLE)  # 2.5 s, of which the board still has the last
    shield.halt()
    shield.close()
    register.feed(np.concatenate(line.edges))  # type: ignore[arg-type]
    made = len([byte for byte in register.bytes if byte])
    assert 300 < made < 500
    assert register.bytes[-1] == 0
