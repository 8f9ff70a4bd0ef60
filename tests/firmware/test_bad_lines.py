"""A line that goes wrong: one clear message each, through a real pseudo-terminal, the image on the simulated chip."""

from __future__ import annotations

import itertools
import time
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import trochia
from trochia.backends.avr.live_avr import LiveAvr
from trochia.backends.avr.transports import SerialTransport
from trochia.backends.live import Orders
from trochia.backends.segments import Segments, sampled
from trochia.errors import LinkError, LinkTimeout, RemoteProtocolError, VersionMismatch
from trochia.kernels.link import ANSWER, CAUSES, SCHEMA, TYPES, FrameReader, frame
from trochia.messages import Cause

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from trochia.machine.machine import Machine


@pytest.fixture
def machine() -> Machine:
    return replace(trochia.load("reference-mill"), io=())


def clock(board: Any) -> float:
    """The chip's time, which stands still where the computer has none for it; or the wall's."""
    return 100.0 + board.board.at if hasattr(board.board, "at") else time.monotonic()


@pytest.fixture
def connect(machine: Machine, request: pytest.FixtureRequest) -> Callable[..., LiveAvr]:
    """Opens a port with a board of a name on it."""

    def begin(board: Any, *, name: str = "uno-stepdir", baud: int = 115_200) -> LiveAvr:
        made = LiveAvr(machine, SerialTransport(str(board.link), baud=baud), board=name)
        request.addfinalizer(made.transport.close)
        made.open(clock(board))
        return made

    return begin


def test_a_port_that_is_not_there():
    with pytest.raises(LinkError, match="/dev/not-there is not there") as caught:
        SerialTransport("/dev/not-there")
    assert "trochia boards" in str(caught.value)


def test_two_hosts(plug: Callable[..., Any], connect: Callable[..., LiveAvr]):
    board = plug("uno-stepdir")
    connect(board)
    with pytest.raises(LinkError, match="is in use by another program"):
        SerialTransport(str(board.link))


def test_another_board(plug: Callable[..., Any], connect: Callable[..., LiveAvr]):
    with pytest.raises(RemoteProtocolError, match="the board is uno-stepdir, not mega-stepdir") as caught:
        connect(plug("uno-stepdir"), name="mega-stepdir")
    assert "--board uno-stepdir" in str(caught.value)


def test_another_version(plug: Callable[..., Any], connect: Callable[..., LiveAvr]):
    reader, told = FrameReader(), np.zeros((), ANSWER)
    told["schema"] = 0x12345678

    def answer(came: bytes) -> bytes:
        return b"".join(frame(0, TYPES["answer"], told.tobytes()) for _ in reader.feed(came))

    with pytest.raises(VersionMismatch, match=f"schema 12345678, this program {SCHEMA:08x}") as caught:
        connect(plug(answer=answer))
    assert "trochia flash" in str(caught.value)


def test_another_baud_rate(plug: Callable[..., Any], connect: Callable[..., LiveAvr]):
    with pytest.raises(LinkTimeout, match="at 115200 baud; there is uno-stepdir at 1000000 baud, schema") as caught:
        connect(plug("uno-stepdir", baud=1_000_000))
    assert "Say --baud 1000000" in str(caught.value)


noise = itertools.cycle(np.random.default_rng(3).bytes(997))


@pytest.mark.parametrize(
    ("answer", "text"),
    [
        (lambda _came: b"", "nothing answers"),
        (lambda _came: bytes(itertools.islice(noise, 40)), "make no sense: another baud rate, or another firmware"),
        (lambda came: b"\r\nGrbl 1.1h ['$' for help]\r\n" if came else b"", "a GRBL board is there"),
        (lambda came: b"echo:Unknown command\n" if came else b"", "neither our protocol nor GRBL's: 'echo:Unknown"),
    ],
)  # fmt: skip
def test_strangers(
    plug: Callable[..., Any], connect: Callable[..., LiveAvr], answer: Callable[[bytes], bytes], text: str
):
    with pytest.raises(LinkTimeout) as caught:
        connect(plug(answer=answer))
    assert text in str(caught.value)


def motion(machine: Machine, way: float) -> Segments:
    """Return a motion along X from where it is 0."""
    plan = trochia.plan(trochia.gcode(f"G1 G21 X{way} F600\nM2\n", machine), machine).trajectory
    times = np.linspace(0.0, plan.duration, round(plan.duration / 0.005))
    return sampled(plan, machine.kinematics.matrix, times, np.full(len(times) - 1, 4.0))


def feed(backend: LiveAvr, board: Any, machine: Machine) -> float:
    """Start a motion of two seconds from where X is called 0; returns how far it goes."""
    now = clock(board)
    backend.order(Orders(enable=True), now)
    backend.order(Orders(segments=motion(machine, 20.0), at=backend.poll(now).executed), now)
    return 20.0


def poll(backend: LiveAvr, board: Any, until: Callable[[Any], bool], patience: float = 60.0) -> Any:
    end = time.monotonic() + patience
    while True:
        report = backend.poll(clock(board))
        if until(report):
            return report
        assert time.monotonic() < end, report
        time.sleep(0.005)


def test_a_motion_through_a_terminal_in_real_time(
    plug: Callable[..., Any], connect: Callable[..., LiveAvr], machine: Machine
):
    board = plug("uno-stepdir")
    backend = connect(board)
    way = feed(backend, board, machine)
    report = poll(backend, board, lambda now: now.still and now.executed > 0.1)
    assert report.commanded[0] == pytest.approx(way)
    assert not report.troubles
    poll(backend, board, lambda _now: backend.status["state"] == 0)  # the report runs ahead of the last status
    assert backend.status["position"][0] == round(way * 200)


def test_a_cable_pulled_in_motion_and_put_back(
    plug: Callable[..., Any], connect: Callable[..., LiveAvr], machine: Machine
):
    board = plug("uno-stepdir")
    backend = connect(board)
    feed(backend, board, machine)
    poll(backend, board, lambda now: now.commanded[0] > 3.0)
    board.pull()
    report = poll(backend, board, lambda now: bool(now.troubles))
    (trouble,) = report.troubles
    assert (trouble.cause, "is gone" in trouble.text) == (Cause.LINK, True)
    assert report.still
    assert not report.enabled
    with pytest.raises(LinkError, match="is gone"):
        backend.order(Orders(enable=True), clock(board))
    silent = board.board.at + 1.0
    while board.board.at < silent:  # it brakes for want of a host, and stands
        time.sleep(0.01)
    board.replug()
    report = poll(backend, board, lambda now: not now.troubles)
    assert (backend.status["state"], CAUSES[int(backend.status["cause"])]) == (3, "silence")
    steps = edges(board)
    position = int(backend.status["position"][0])
    assert position == len(steps)  # it has kept count
    assert 600 < position < 4000
    gaps = np.diff(steps["cycle"].astype(np.int64))
    assert gaps[-3:].min() > 1.5 * np.median(gaps)  # it braked
    assert report.commanded[0] == pytest.approx(position / 200)  # and is believed
    assert report.still
    backend.order(Orders(enable=True, place={"X": 0.0}), clock(board))
    feed(backend, board, machine)
    report = poll(backend, board, lambda now: now.still and now.commanded[0] == pytest.approx(20.0))
    assert not report.troubles
    poll(backend, board, lambda _now: backend.status["state"] == 0)
    assert backend.status["position"][0] == position + 4000


def edges(board: Any) -> NDArray[np.void]:
    """The steps of X so far."""
    made = np.concatenate(board.board.runs)
    return made[(made["kind"] == 1) & (made["unit"] == b"D") & (made["line"] == 2) & (made["value"] == 1)]


def test_a_board_that_is_reset_in_motion(plug: Callable[..., Any], connect: Callable[..., LiveAvr], machine: Machine):
    board = plug("uno-stepdir")
    backend = connect(board)
    feed(backend, board, machine)
    poll(backend, board, lambda now: now.commanded[0] > 3.0)
    board.board.reset()
    report = poll(backend, board, lambda now: bool(now.troubles))
    assert "nothing has been heard from the board for 0.5 s" in report.troubles[0].text
    report = poll(backend, board, lambda now: not now.troubles)
    assert (report.enabled, report.still) == (False, True)
    assert report.commanded[0] > 3.0  # nobody knows better; the controller has every axis homed
    assert int(backend.status["position"][0]) == 0
    backend.order(Orders(enable=True, place={"X": 0.0}), clock(board))
    feed(backend, board, machine)
    poll(backend, board, lambda now: now.still and now.commanded[0] == pytest.approx(20.0))
    poll(backend, board, lambda _now: backend.status["state"] == 0)
    assert backend.status["position"][0] == 4000
    assert not report.troubles


def test_a_stranger_is_plugged_in_instead(plug: Callable[..., Any], connect: Callable[..., LiveAvr]):
    board = plug("uno-stepdir")
    backend = connect(board)
    board.pull()
    poll(backend, board, lambda now: bool(now.troubles))
    other = plug("mega-stepdir")  # under the same name
    stood = clock(board)
    board.board = other.board
    other.board.at += stood - 100.0
    report = poll(backend, board, lambda now: any("the board is" in trouble.text for trouble in now.troubles))
    assert "the board is mega-stepdir, not uno-stepdir" in report.troubles[0].text


def test_the_next_program_on_a_board_that_was_not_reset(
    plug: Callable[..., Any], connect: Callable[..., LiveAvr], machine: Machine
):
    board = plug("uno-stepdir")
    first = connect(board)
    feed(first, board, machine)
    poll(first, board, lambda now: now.commanded[0] > 1.0)
    first.transport.close()  # the program is gone, the board is not reset
    again = connect(board)
    assert again.status["state"] != 2  # it has braked for the next
    place = again.poll(clock(board)).commanded[0]
    assert place == again.status["position"][0] / 200 > 1.0
