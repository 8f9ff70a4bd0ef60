"""What is GRBL's own: its words, its numbers, its terminal, and what a bad cable does to a job."""

from __future__ import annotations

import os
import tty
from contextlib import suppress
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.backends.grbl import GrblBackend, SerialPort, codes, overrides
from trochia.backends.grbl.replies import Alarm, Error, Noise, Ok, Setting, StatusLine, Told, Welcome, parse
from trochia.backends.grbl.settings import differences, machine_of
from trochia.backends.program import Doing, Order
from trochia.errors import ConfigError, LinkError
from trochia.languages.gcode.write import Line
from trochia.machine.load import load

STEP = 0.01


class Wire:
    """A cable that spoils what the board says, from a byte on."""

    def __init__(self, board: Any, spoil: Any = lambda data, _: data) -> None:
        self.board, self.spoil, self.passed = board, spoil, 0

    def read(self) -> bytes:
        data = self.board.take()
        self.passed += len(data)
        return self.spoil(data, self.passed - len(data))

    def write(self, data: bytes) -> None:
        self.board.feed_bytes(data)

    def close(self) -> None:
        pass


def run(backend: GrblBackend, board: Any, now: float, until: Any, most: float = 60.0) -> tuple[Any, float]:
    end = now + most
    while now < end:
        now += STEP
        board.advance(now)
        report = backend.poll(now)
        if until(report):
            return report, now
    raise AssertionError(f"it never came to that: {report}")


def zigzag(count: int) -> list[Line]:
    return [Line("G21G90G94F6000", 1),
            *(Line(f"G1X{n % 2 * 2}Y{n * 0.01:.2f}", n + 1) for n in range(1, count + 1))]  # fmt: skip


@pytest.mark.parametrize(("line", "reply"), [
    ("ok", Ok()), ("error:22", Error(22)), ("ALARM:9", Alarm(9)), ("Grbl 1.1f ['$' for help]", Welcome("1.1f")),
    ("$100=250.000", Setting("$100", "250.000")), ("$N0=G54", Setting("$N0", "G54")),
    ("[OPT:V,15,128]", Told("OPT", "V,15,128")), ("<Idle|MPos:0,0,0>", StatusLine(Doing.IDLE, -1, {"MPos": "0,0,0"})),
    ("<Hold:1|MPos:0,0,0|Pn:XP>", StatusLine(Doing.HOLD, 1, {"MPos": "0,0,0", "Pn": "XP"})),
    ("<Idle|MPos:0,0,zero>", Noise("<Idle|MPos:0,0,zero>")), ("<Bored|MPos:0,0,0>", Noise("<Bored|MPos:0,0,0>")),
    ("oK", Noise("oK")), ("error:", Noise("error:")), ("start", Noise("start")),
])  # fmt: skip
def test_what_the_board_says_is_read_and_nothing_else(line: str, reply: object) -> None:
    assert parse(line) == reply


def test_every_error_and_alarm_says_what_to_do() -> None:
    for meaning in (*codes.ERRORS.values(), *codes.ALARMS.values(), codes.error(99), codes.alarm(99)):
        assert meaning.sentence
        assert meaning.remedy.endswith(".")


@given(feed=st.floats(0, 3), spindle=st.floats(0, 3))
def test_override_bytes_lead_to_the_nearest_percent(feed: float, spindle: float) -> None:
    found = [100, 100]
    for code in overrides.codes(feed=feed, rapid=1.0, spindle=spindle):
        at = 0 if code < 0x95 else 1
        found[at] = overrides.stepped(found[at], code) or found[at]
    assert found == [min(max(round(100 * value), 10), 200) for value in (feed, spindle)]


def test_settings_make_a_machine_and_what_a_file_promises_more_is_named(grbl_model: Any) -> None:
    board = machine_of(grbl_model.SETTINGS)
    assert [axis.velocity for axis in board.axes] == [100.0, 100.0, 50.0]
    assert board.joints[0].steps_per_unit == 250
    assert differences(board, grbl_model.SETTINGS) == []
    told = differences(load("rotary-mill"), grbl_model.SETTINGS)
    assert "the board has no axis A" in told
    with pytest.raises(ConfigError):
        machine_of({"$0": "10"})


def test_a_locked_board_is_homed_or_unlocked(grbl_model: Any) -> None:
    board = grbl_model.Board(settings=grbl_model.SETTINGS | {"$22": "1"})
    backend = GrblBackend(lambda: Wire(board))
    backend.open(0.0)
    _, now = run(backend, board, 0.0, lambda report: report.doing is Doing.ALARM)
    backend.order(Order.HOME, now)
    report, now = run(backend, board, now, lambda report: report.done and report.doing is Doing.IDLE)
    assert now > 3.0  # it said nothing for so long, and was not given up
    assert report.faults == ()


def test_a_soft_limit_is_an_alarm_with_the_line_that_was_executed(grbl_model: Any) -> None:
    board = grbl_model.Board(settings=grbl_model.SETTINGS | {"$20": "1"})
    backend = GrblBackend(lambda: Wire(board))
    backend.open(0.0)
    _, now = run(backend, board, 0.0, lambda report: report.doing is Doing.IDLE)
    backend.send([Line("G21G90G1X-5F3000", 1), Line("X5", 2)])
    report, _ = run(backend, board, now, lambda report: bool(report.faults))
    assert report.doing is Doing.ALARM
    assert report.faults[0].cause.value == "soft-limit"


def test_five_thousand_lines_through_a_terminal_and_then_the_cable_is_pulled(grbl_model: Any) -> None:
    ours, theirs = os.openpty()
    tty.setraw(theirs)
    os.set_blocking(ours, False)
    board, name = grbl_model.Board(), os.ttyname(theirs)
    backend = GrblBackend(lambda: SerialPort(name))
    backend.open(0.0)
    now = 0.0

    def beat(until: Any) -> Any:
        nonlocal now
        while True:
            now += STEP
            with suppress(BlockingIOError):
                board.feed_bytes(os.read(ours, 4096))
            board.advance(now)
            os.write(ours, board.take())
            report = backend.poll(now)
            assert now < 300.0
            if until(report):
                return report

    beat(lambda report: report.doing is Doing.IDLE)
    backend.send(zigzag(5000))
    report = beat(lambda report: report.done)
    assert report.line == 5001
    assert len(board.executed) == 5000
    assert board.offences == []
    backend.send(zigzag(100))
    beat(lambda report: report.line > 20)
    os.close(ours)
    os.close(theirs)
    report = backend.poll(now + STEP)
    assert report.doing is Doing.LOST
    assert "gone" in report.faults[0].message
    with pytest.raises(LinkError, match="cannot be opened"):
        backend.open(now)


@given(at=st.integers(400, 3500), how=st.sampled_from(["drop", "flip", "twice", "burst", "cut"]), bit=st.integers(0, 7))
def test_a_spoilt_answer_ends_in_the_same_motion_or_in_a_stop_that_is_told(
    grbl_model: Any, at: int, how: str, bit: int
) -> None:  # fmt: skip
    def spoil(data: bytes, passed: int) -> bytes:
        if how == "cut" and passed + len(data) > at:
            return data[: max(at - passed, 0)]
        here = at - passed
        if not 0 <= here < len(data):
            return data
        spoilt = {"drop": b"", "flip": bytes([data[here] ^ 1 << bit]), "twice": data[here : here + 1] * 2,
                  "burst": b"\x00\xff\x55" * 7, "cut": b""}[how]  # fmt: skip
        return data[:here] + spoilt + data[here + 1 :]

    board = grbl_model.Board()
    backend = GrblBackend(lambda: Wire(board, spoil))
    backend.open(0.0)
    _, now = run(backend, board, 0.0, lambda report: report.doing in {Doing.IDLE, Doing.LOST})
    lines = zigzag(150)
    if backend.poll(now).doing is Doing.IDLE:
        backend.send(lines)
    report, now = run(backend, board, now, lambda report: report.done)
    stopped = list(board.executed)
    for _ in range(200):
        now += STEP
        board.advance(now)
        backend.poll(now)
    whole = len(board.executed) == 150
    assert board.offences == []
    assert whole or report.faults
    if not whole and report.doing is not Doing.LOST:
        assert board.executed == stopped  # it rests where it was stopped
