"""A board that is served: the real image behind a pseudo-terminal, a client that logs in, everything a twin can do."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import trochia
from trochia.backends.avr.live_avr import LiveAvr
from trochia.backends.avr.transports import SerialTransport
from trochia.client import Client
from trochia.client.asynchronous import Refused
from trochia.controller.runtime import Runtime
from trochia.machine.io import Channel
from trochia.messages import command as c
from trochia.server.desk import Desk
from trochia.server.doors import Doors
from trochia.server.listen import Served, listen
from trochia.server.rest import bring_to_rest
from trochia.server.users import Users

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from trochia.messages import Status

PASSWORD = "a password for tests"  # noqa: S105
PROGRAM = "G21 G90 G17 G61 F600\nG1 X12\nG3 X12 Y8 J4\nG1 X0\nY0\nM2\n"
PATIENCE = 60.0  # s: the chip's time may be far behind the wall's
UNITS = 200  # steps a millimetre
STEP_PINS = {"X": 2, "Y": 3, "Z": 4}
DIRECTIONS = {"X": ("D", 5), "Y": ("D", 6), "Z": ("D", 7)}


@dataclass
class Place:
    """A served board, and a client in control of it."""

    board: Any
    runtime: Runtime
    client: Client

    def ok(self, command: Any) -> None:
        self.client.command(command)

    def until(self, wanted: Callable[[Status], bool] | str) -> Status:
        """Wait for a state; an alarm ends the wait unless that is waited for."""

        def there(now: Status) -> bool:
            assert now.state != "alarm" or wanted == "alarm", now.alarms
            return now.state == wanted if isinstance(wanted, str) else wanted(now)

        return self.client.wait_until(there, timeout=PATIENCE)

    def back(self) -> None:
        """Wait until the board is connected again, and take note of the alarm."""
        self.client.wait_until(lambda now: not self.runtime.backend.link.lost and bool(now.alarms), timeout=PATIENCE)  # type: ignore[attr-defined]
        self.ok(c.Acknowledge())
        self.client.wait_until(lambda now: now.state in {"off", "idle"}, timeout=PATIENCE)

    def ready(self) -> None:
        if self.client.status.state == "off":
            self.ok(c.Enable())
        self.until("idle")
        self.ok(c.Home())
        self.until(lambda now: now.state == "idle" and all(axis.trusted for axis in now.axes))

    def steps(self) -> np.ndarray:
        """What the board's own counters say (motors,) [steps]."""
        return np.array(self.runtime.backend.status["position"][:3])  # type: ignore[attr-defined]

    def edges(self, axis: str) -> np.ndarray:
        """Cycles of the steps of an axis, from the pins."""
        runs = np.concatenate(self.board.board.runs)
        mine = (runs["kind"] == 1) & (runs["unit"] == b"D") & (runs["line"] == STEP_PINS[axis]) & (runs["value"] == 1)
        return runs["cycle"][mine]


@pytest.fixture
def place(plug: Callable[..., Any], tmp_path: Path) -> Iterator[Place]:
    board = plug("uno-stepdir")
    machine = replace(trochia.load("reference-mill"), io=(Channel(name="lamp", kind="latched"),))
    backend = LiveAvr(machine, SerialTransport(str(board.link)))
    runtime = Runtime(backend, now=board.board.clock())
    users = Users(tmp_path / "users.json", cost=1 << 10)
    users.put("ada", "operator", PASSWORD)
    socket = listen("127.0.0.1", 0)
    desk = Desk(runtime, users, Doors.of(socket.getsockname()[1]))
    runtime.start(board.board.clock)
    served = Served(desk, socket)
    served.start()
    with Client.connect(f"http://127.0.0.1:{served.port}", "ada", PASSWORD) as client:
        client.take()
        yield Place(board, runtime, client)
    served.close()
    bring_to_rest(runtime)
    desk.close()
    runtime.close()


def test_a_job_runs_is_held_goes_on_and_ends_with_the_steps_of_its_plan(place: Place) -> None:
    status = place.until("off")
    assert status.backend == f"uno-stepdir on {place.board.link}"
    assert place.edges("X").size == 0  # nothing moves at connect
    place.ready()
    place.ok(c.Load(name="job.ngc", text=PROGRAM))
    place.ok(c.Override(feed=1.5))
    place.ok(c.Run())
    place.until(lambda now: now.state == "running" and now.axes[0].commanded > 4.0)
    place.ok(c.Hold())
    status = place.until("held")
    still = place.edges("X").size
    assert status.program is not None
    assert status.program.line == 2
    assert status.axes[0].commanded == pytest.approx(still / UNITS, abs=1.0 / UNITS)  # executed, not sent
    place.ok(c.Override(feed=1.0))
    time.sleep(0.2)
    assert place.edges("X").size == still
    held = place.client.status.program
    assert held is not None
    assert held.line == 2  # also when nothing is left in the board's queue
    place.ok(c.Resume())
    status = place.until("idle")
    assert not status.alarms
    assert place.steps().tolist() == [0, 0, 0]
    assert place.edges("X").size == 2 * 12 * UNITS + 2 * 4 * UNITS
    assert place.edges("Y").size == 2 * 8 * UNITS
    assert place.edges("Z").size == 0


def test_jogs_an_abort_an_output_and_the_emergency_stop(place: Place) -> None:
    place.ready()
    place.ok(c.JogBy(way={"X": 2.0, "Y": -1.0}))
    place.until(lambda now: now.state == "idle" and now.axes[0].commanded == pytest.approx(2.0))
    assert place.steps().tolist()[:2] == [2 * UNITS, -UNITS]
    place.client.jog("X", 20.0, 0.4)  # a lease that is renewed, and then is not
    place.until(  # the board's counters are read beside the client's status: both come to the same place
        lambda now: (
            now.state == "idle"
            and now.axes[0].commanded > 3.0
            and abs(int(place.steps()[0]) - now.axes[0].commanded * UNITS) <= 1.0
        )
    )
    place.ok(c.SetOutput(name="lamp", value=1.0))
    place.until(lambda now: now.io["lamp"] == 1.0)
    with pytest.raises(Refused, match="inputs of a real machine cannot be set"):
        place.ok(c.SetInput(name="lamp", value=1.0))
    place.ok(c.JogTo(position={"X": 140.0}))  # far enough for orders that come late
    place.until(lambda now: now.axes[0].velocity > 5.0)
    place.ok(c.Abort())
    status = place.until("idle")
    assert status.axes[0].commanded < 139.0
    place.ok(c.Mdi(text="G0 X0"))
    place.until(lambda now: now.axes[0].velocity < -5.0)
    place.client.stop()
    status = place.until("estop")
    assert not status.axes[0].trusted
    last = time.monotonic() + PATIENCE
    while place.runtime.backend.status["enabled"]:  # type: ignore[attr-defined] # the order is on its way to the board
        assert time.monotonic() < last
        time.sleep(0.01)
    made = place.edges("X").size
    end = place.board.board.at + 0.3
    while place.board.board.at < end:
        time.sleep(0.01)
    assert place.edges("X").size == made


def test_a_cable_that_is_pulled_is_an_alarm_and_goes_on_when_it_is_back(place: Place) -> None:
    place.ready()
    place.ok(c.Load(name="job.ngc", text=PROGRAM))
    place.ok(c.Run())
    place.until(lambda now: now.state == "running" and now.axes[0].commanded > 4.0)
    place.board.pull()
    status = place.until("alarm")
    (alarm,) = status.alarms
    assert alarm.cause.value == "link-lost"
    assert "is gone" in alarm.message
    assert "connected to by itself" in alarm.remedy
    assert not any(axis.trusted or axis.velocity for axis in status.axes)
    place.board.replug()
    place.back()
    status = place.client.status
    assert status.axes[0].commanded == pytest.approx(place.steps()[0] / UNITS)  # it braked, and kept count
    assert 0 < place.steps()[0] <= 12 * UNITS
    place.ready()
    place.ok(c.JogTo(position={"X": 0.0}))
    place.until(lambda now: now.state == "idle" and now.axes[0].commanded == pytest.approx(0.0, abs=1e-9))
    assert place.steps().tolist() == [0, 0, 0]


def test_a_board_that_is_reset_while_it_moves_is_an_alarm(place: Place) -> None:
    place.ready()
    place.ok(c.Load(name="job.ngc", text=PROGRAM))
    place.ok(c.Run())
    place.until(lambda now: now.state == "running" and now.axes[0].commanded > 4.0)
    place.board.board.reset()
    status = place.until("alarm")
    assert "nothing has been heard from the board for 0.5 s" in status.alarms[0].message
    place.back()
    place.until("off")  # a chip that was reset has its drives off
    with pytest.raises(Refused, match="not taken while off"):
        place.ok(c.Run())
    place.ready()
    place.ok(c.JogBy(way={"X": 1.0}))
    place.until("idle")
    assert place.steps().tolist() == [UNITS, 0, 0]
