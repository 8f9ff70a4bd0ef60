"""Our own GRBL backend drives our own GRBL gateway before a twin, through a pseudo-terminal, by one virtual clock."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from trochia.backends.grbl import GrblBackend, SerialPort
from trochia.backends.grbl.settings import differences, machine_of
from trochia.backends.program import Doing, Order
from trochia.languages import gcode
from trochia.languages.gcode.write import Line, lines

if TYPE_CHECKING:
    from collections.abc import Callable

    from tests.unit.gateways.conftest import Plant

    from trochia.backends.program import BoardReport


class Pair:
    """A plant behind a terminal, and the backend at its other end."""

    def __init__(self, plant: Plant) -> None:
        self.plant = plant
        self.backend = GrblBackend(lambda: SerialPort(plant.door.name))
        self.report = self.backend.open(0.0)
        plant.beside = self._poll

    def _poll(self, now: float) -> None:
        self.report = self.backend.poll(now)

    def run(self, seconds: float, until: Callable[[BoardReport], bool] | None = None) -> BoardReport:
        self.plant.run(seconds, None if until is None else lambda: until(self.report))
        return self.report


@pytest.fixture
def pair(plants: Callable[..., Plant]) -> Pair:
    made = Pair(plants(door="terminal"))
    made.run(5.0, lambda report: report.doing is Doing.IDLE)
    return made


def test_five_thousand_lines_with_hold_resume_and_overrides_end_where_they_should(pair: Pair) -> None:
    text = (
        "G21 F6000\n" + "".join(f"G1 X{n % 100 * 0.1:.1f} Y{n * 0.01:.2f}\n" for n in range(1, 4999)) + "X7 Y-3\nM2\n"
    )
    program = gcode.read(text)
    pair.backend.send(lines(program))
    pair.run(5.0, lambda report: report.line > 300)
    pair.backend.order(Order.HOLD, pair.plant.now)
    pair.run(2.0, lambda report: report.doing is Doing.HOLD)
    pair.run(0.5)
    stood = pair.plant.place()
    line = pair.run(0.5).line
    assert pair.run(0.5).line == line
    assert pair.plant.place() == stood
    pair.backend.override(feed=1.5)
    pair.backend.order(Order.RESUME, pair.plant.now)
    pair.run(1.0)
    assert pair.report.overrides.feed == pytest.approx(1.5)
    report = pair.run(300.0, lambda report: report.done)
    assert report.faults == ()
    assert report.line == 5001
    assert pair.plant.place() == pytest.approx({"X": 7.0, "Y": -3.0, "Z": 0.0}, abs=1e-9)
    assert report.position == pytest.approx(dict(zip("XYZ", program.moves["target"][-1][:3], strict=True)), abs=1e-3)


def test_abort_and_reset_keep_the_position(pair: Pair) -> None:
    pair.backend.send([Line("G21G90", 1), Line("G1X100F3000", 2), Line("X0", 3)])
    pair.run(1.0)
    pair.backend.order(Order.ABORT, pair.plant.now)
    report = pair.run(5.0, lambda report: report.done)
    assert report.faults == ()
    stood = pair.plant.place()["X"]
    assert 10.0 < stood < 99.0
    pair.backend.send([Line("G1X100F3000", 2)])
    pair.run(0.4)
    pair.backend.order(Order.RESET, pair.plant.now)
    report = pair.run(5.0, lambda report: report.done)
    assert report.faults == ()
    assert stood < pair.plant.place()["X"] < 99.0
    assert report.position["X"] == pytest.approx(pair.plant.place()["X"], abs=1e-3)


def test_settings_come_back_as_the_machine(pair: Pair) -> None:
    mine = pair.plant.runtime.controller.machine
    assert differences(mine, pair.backend.settings) == []
    board = {axis.name: axis for axis in machine_of(pair.backend.settings).axes}
    for axis in mine.axes:
        assert board[axis.name].velocity == pytest.approx(axis.velocity)
        assert board[axis.name].acceleration == pytest.approx(axis.acceleration)


def test_a_jog_from_afar(pair: Pair) -> None:
    pair.backend.jog({"X": 3.0, "Y": -1.0}, 20.0)
    pair.run(5.0, lambda report: report.done and report.position["X"] > 2.9)
    assert pair.plant.place() == pytest.approx({"X": 3.0, "Y": -1.0, "Z": 0.0})


def test_the_terminal_gone_is_told_and_nothing_crashes(pair: Pair) -> None:
    pair.backend.send([Line("G1X100F3000", 2)])
    pair.run(0.5)
    pair.plant.door.close()
    pair.plant.door.close = lambda: None
    assert pair.backend.poll(pair.plant.now + 0.1).doing is Doing.LOST
    assert "gone" in pair.backend.poll(pair.plant.now + 0.2).faults[-1].message
