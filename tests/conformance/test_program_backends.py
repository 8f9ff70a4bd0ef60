"""What every board that plans for itself does: the same end for the same lines, the same refusals of abuse.

Each is tried on a strict model of its board's documented protocol, in virtual time.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import pytest

from trochia.backends import PROGRAM_BACKENDS
from trochia.backends.program import Doing, Order
from trochia.errors import LinkError, LocalProtocolError
from trochia.languages import gcode
from trochia.languages.gcode.write import Line, lines
from trochia.messages import Cause

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from trochia.backends.program import BoardReport, ProgramBackend

STEP = 0.01  #: between polls [s]


class Wire:
    """A cable between a backend and a model; it can be out."""

    def __init__(self, board: Any) -> None:
        self.board, self.out = board, False

    def read(self) -> bytes:
        if self.out:
            raise LinkError("the port is gone")
        return self.board.take()

    def write(self, data: bytes) -> None:
        if self.out:
            raise LinkError("the port is gone")
        self.board.feed_bytes(data)

    def close(self) -> None:
        pass


@dataclass
class Bench:
    """A backend, its board and a clock."""

    backend: ProgramBackend
    board: Any
    wire: Wire
    now: float = 0.0

    def run(self, seconds: float = 600.0, until: Callable[[BoardReport], bool] | None = None) -> BoardReport:
        """Let time pass, at most so long; until something is so."""
        end = self.now + seconds
        while self.now < end:
            self.now += STEP
            self.board.advance(self.now)
            report = self.backend.poll(self.now)
            if until is not None and until(report):
                return report
        assert until is None, f"it never came to that: {report}"
        return report

    def settle(self) -> BoardReport:
        return self.run(until=lambda report: report.done)


@pytest.fixture(params=sorted(PROGRAM_BACKENDS))
def bench(request: pytest.FixtureRequest, grbl_model: Any) -> Iterator[Bench]:
    board = {"grbl": grbl_model.Board}[request.param]()
    wire = Wire(board)
    made = Bench(PROGRAM_BACKENDS[request.param](lambda: wire), board, wire)
    made.backend.open(0.0)
    made.run(until=lambda report: report.doing is Doing.IDLE)
    yield made
    assert board.offences == []


def job(text: str) -> list[Line]:
    return list(lines(gcode.read(text)))


SQUARE = job("G21 F3000\nG1 X40\nY30\nX0\nY0\nM2\n")


def zigzag(count: int) -> list[Line]:
    return job("G21 F6000\n" + "".join(f"G1 X{n % 2 * 2} Y{n * 0.01:.2f}\n" for n in range(1, count + 1)) + "M2\n")


def test_connecting_moves_nothing_and_reads_the_settings(bench: Bench) -> None:
    assert bench.board.executed == []
    assert bench.backend.settings
    assert bench.backend.poll(bench.now).position == {"X": 0.0, "Y": 0.0, "Z": 0.0}


def test_lines_are_executed_in_order_to_the_end(bench: Bench) -> None:
    bench.backend.send(SQUARE)
    assert not bench.backend.poll(bench.now).done
    report = bench.settle()
    assert [end[:2] for end in bench.board.executed] == [(40, 0), (40, 30), (0, 30), (0, 0)]
    assert report.line == 6
    assert report.faults == ()


def test_a_job_of_five_thousand_lines_runs_to_its_end(bench: Bench) -> None:
    bench.backend.send(zigzag(5000))
    report = bench.settle()
    assert len(bench.board.executed) == 5000
    assert bench.board.executed[-1] == (0.0, 50.0, 0.0)
    assert report.position == {"X": 0.0, "Y": 50.0, "Z": 0.0}
    assert report.faults == ()


def test_the_line_reported_is_one_that_was_executed(bench: Bench) -> None:
    bench.backend.send(zigzag(300))
    seen = set[int]()

    def ended(report: BoardReport) -> bool:
        moves = len(bench.board.executed)
        assert report.line <= moves + (2 if moves == 300 else 1)  # the first move stands in line 2, M2 behind the last
        seen.add(report.line)
        return report.done

    assert bench.run(until=ended).line == 302
    assert len(seen) > 20


def test_hold_rests_and_resume_goes_on_to_the_same_end(bench: Bench) -> None:
    bench.backend.send(SQUARE)
    bench.run(0.5)
    bench.backend.order(Order.HOLD, bench.now)
    bench.run(0.5, until=lambda report: report.doing is Doing.HOLD)
    bench.run(0.5)
    before = list(bench.board.position)
    bench.run(1.0)
    assert bench.board.position == before
    bench.backend.order(Order.RESUME, bench.now)
    bench.settle()
    assert bench.board.executed[-1] == (0.0, 0.0, 0.0)


def test_abort_gives_up_at_rest_with_the_position_known(bench: Bench) -> None:
    bench.backend.send(zigzag(500))
    bench.run(1.0)
    bench.backend.order(Order.ABORT, bench.now)
    report = bench.settle()
    assert report.doing is Doing.IDLE
    assert report.faults == ()
    assert 0 < len(bench.board.executed) < 100
    bench.backend.send(job("G21 F3000\nG1 X1 Y1\nM2\n"))
    assert bench.settle().position["X"] == 1.0


def test_a_reset_in_motion_is_an_alarm_until_unlocked(bench: Bench) -> None:
    bench.backend.send(SQUARE)
    bench.run(0.5)
    bench.backend.order(Order.RESET, bench.now)
    report = bench.run(1.0)
    assert report.doing is Doing.ALARM
    assert report.faults[0].cause is Cause.ESTOP
    with pytest.raises(LocalProtocolError, match="alarm"):
        bench.backend.send(SQUARE)
    bench.backend.order(Order.UNLOCK, bench.now)
    bench.backend.order(Order.ACKNOWLEDGE, bench.now)
    assert bench.run(1.0).doing is Doing.IDLE


def test_overrides_change_how_long_it_takes(bench: Bench) -> None:
    took: list[float] = []
    for feed in (1.0, 0.5, 2.0):
        bench.backend.override(feed=feed)
        began = bench.now
        bench.backend.send(SQUARE)
        bench.settle()
        took.append(bench.now - began)
    assert took[1] == pytest.approx(2 * took[0], rel=0.1)
    assert took[2] == pytest.approx(took[0] / 2, rel=0.2)
    assert bench.run(2.0).overrides.feed == 2.0


def test_a_jog_goes_its_way_and_a_cancelled_one_does_not(bench: Bench) -> None:
    bench.backend.jog({"X": 10.0, "Y": -5.0}, 50.0)
    bench.settle()
    assert bench.board.position == [10.0, -5.0, 0.0]
    bench.backend.jog({"X": 100.0}, 20.0)
    bench.run(1.0)
    bench.backend.order(Order.JOG_STOP, bench.now)
    bench.settle()
    assert 20.0 < bench.board.position[0] < 40.0


def test_a_refused_line_stops_the_job_and_is_named(bench: Bench) -> None:
    bad = [*zigzag(200)[:100], Line("G33Z1K1", 77), *zigzag(200)[100:]]
    bench.backend.send(bad)
    report = bench.settle()
    assert report.faults[0].line == 77
    assert "G33Z1K1" in report.faults[0].message
    assert len(bench.board.executed) < 150
    assert report.doing is Doing.IDLE


def test_lines_that_no_board_takes_are_refused_before_they_are_sent(bench: Bench) -> None:
    for text in ("", "G1 X" + "1" * 90, "G1X1\nG1X2", "G1X1!", "(ä)"):
        with pytest.raises(LocalProtocolError):
            bench.backend.send([Line(text, 1)])


def test_a_pulled_cable_is_told_and_so_is_what_was_executed(bench: Bench) -> None:
    bench.backend.send(zigzag(500))
    bench.run(1.0)
    bench.wire.out = True
    report = bench.run(0.1)
    assert report.doing is Doing.LOST
    assert report.faults[0].cause is Cause.LINK
    assert 0 < report.line <= len(bench.board.executed) + 1
    with pytest.raises(LocalProtocolError, match="lost"):
        bench.backend.send(SQUARE)


def test_a_replugged_board_is_held_and_asked_anew(bench: Bench) -> None:
    bench.backend.send(zigzag(2000))
    bench.run(1.0)
    bench.wire.out = True
    bench.run(0.05)
    bench.wire.out = False
    bench.backend.open(bench.now)
    report = bench.run(until=lambda report: report.doing is Doing.IDLE)
    stood = list(bench.board.position)
    bench.run(2.0)
    assert bench.board.position == stood
    assert report.position["Y"] == pytest.approx(stood[1], abs=1e-3)


def test_a_silent_board_is_lost(bench: Bench) -> None:
    bench.backend.send(zigzag(100))
    bench.run(0.2)
    bench.board.deaf = True
    report = bench.run(5.0)
    assert report.doing is Doing.LOST
    assert "silent" in report.faults[0].message


def test_noise_amid_a_job_stops_it(bench: Bench) -> None:
    bench.backend.send(zigzag(300))
    bench.run(1.0)
    bench.board.out += b"o\xffk\r\n"
    report = bench.settle()
    assert report.faults[0].cause is Cause.LINK
    assert len(bench.board.executed) < 120


def test_a_board_that_restarts_amid_a_job_is_told(bench: Bench) -> None:
    bench.backend.send(zigzag(300))
    bench.run(1.0)
    bench.board.power_up()
    report = bench.run(until=lambda report: report.doing is Doing.IDLE)
    report = bench.settle()
    assert "restarted" in report.faults[0].message
    assert report.waiting == 0


def test_another_language_or_baud_rate_is_told(bench: Bench) -> None:
    fresh = PROGRAM_BACKENDS[bench.backend.kind](lambda: bench.wire)
    bench.wire.read = lambda: b"\x00\xfe\x80\x9c\n"  # type: ignore[method-assign]
    fresh.open(0.0)
    for step in range(1, 600):
        report = fresh.poll(step * STEP)
    assert report.doing is Doing.LOST
    assert "does not speak" in report.faults[0].message


def test_nobody_at_the_other_end_is_told(bench: Bench) -> None:
    fresh = PROGRAM_BACKENDS[bench.backend.kind](lambda: bench.wire)
    bench.wire.read = lambda: b""  # type: ignore[method-assign]
    fresh.open(0.0)
    for step in range(1, 600):
        report = fresh.poll(step * STEP)
    assert "nothing answers" in report.faults[0].message
