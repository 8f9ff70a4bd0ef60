"""The socket itself: leases of jogs, slow clients, garbage."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

import msgspec
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from websockets.exceptions import ConnectionClosed

import trochia
from trochia.backends.live_twin import LiveTwin
from trochia.controller.runtime import PERIOD, Runtime
from trochia.errors import RemoteProtocolError
from trochia.messages import decode_message, unpack
from trochia.messages.command import Enable
from trochia.server.desk import LEASE
from trochia.server.sockets import AHEAD, MISTAKES

JOGGER = """
import sys, time
from trochia.client import Client, Refused
from trochia.messages.command import Enable
client = Client.connect(sys.argv[1], "ada", "ada-ada-ada")
client.take()
client.command(Enable())
print("ready", flush=True)
while True:
    try:
        client.jog("X", 5.0, 60.0)
    except Refused:  # this computer is so busy that the lease ran out: once more
        time.sleep(0.1)
"""


def _jogs(place) -> tuple[list[float], float | None]:
    """Return when the last jog was renewed and when it began to brake, None: not yet, by the controller's clock [s]."""
    renewed, ended = [], None
    for entry in place.journal():
        if entry["kind"] == "state" and entry["state"] == "jogging":
            renewed, ended = renewed[-1:], None
        if entry["kind"] == "command" and entry["command"] == "jog":
            renewed.append(entry["time"])
        if entry["kind"] == "state" and entry["was"] == "jogging":
            ended = entry["time"]
    return renewed, ended


def _brakes_in_time(place) -> None:
    """Hold the last jog against its lease, two turns, and what this computer is known to have been late."""
    renewed, ended = _jogs(place)
    assert ended is not None
    load = place.runtime.load
    assert renewed[-1] < ended <= renewed[-1] + LEASE + 2 * PERIOD + load.late + load.longest
    assert LEASE + 2 * PERIOD < 0.15


def _wait(place, state: str) -> None:
    end = time.monotonic() + 30.0
    while place.runtime.status.state != state:
        assert time.monotonic() < end, f"still {place.runtime.status.state}, not {state}"
        time.sleep(0.005)


def _until_closed(socket) -> None:
    def read() -> None:
        while True:
            socket.recv(timeout=20.0)

    with pytest.raises(ConnectionClosed):
        read()


@pytest.mark.parametrize("how", [signal.SIGSTOP, signal.SIGKILL])
def test_a_jog_brakes_when_its_client_is_frozen_or_killed(place, how: signal.Signals) -> None:
    jogger = subprocess.Popen([sys.executable, "-c", JOGGER, place.url], stdout=subprocess.PIPE)
    try:
        assert jogger.stdout is not None
        assert jogger.stdout.readline() == b"ready\n"
        while len((found := _jogs(place))[0]) < 4 or found[1] is not None:
            assert jogger.poll() is None
            time.sleep(0.02)
        os.kill(jogger.pid, how)
        _wait(place, "idle")
    finally:
        jogger.kill()
        jogger.communicate()
    _brakes_in_time(place)
    assert place.runtime.status.axes[0].velocity == 0.0


def test_a_jog_brakes_when_its_socket_is_closed(place, tell, hear) -> None:
    with place.socket() as socket:
        for message in ({"kind": "take", "id": 1}, {"kind": "enable", "id": 2}):
            tell(socket, message)
            assert hear(socket, "ack").ok
        tell(socket, {"kind": "seen", "sequence": hear(socket, "status").sequence})
        tell(socket, {"kind": "jog", "axis": "X", "speed": 5.0, "id": 3, "lease": 1.0})
        assert hear(socket, "ack").ok
    _wait(place, "idle")
    _brakes_in_time(place)  # the lease of a second was cut, and the socket's end is the jog's


def test_whoever_does_not_see_the_machine_cannot_jog_it(place, tell, hear) -> None:
    with place.socket() as socket:
        for message in ({"kind": "take", "id": 1}, {"kind": "enable", "id": 2}):
            tell(socket, message)
            assert hear(socket, "ack").ok
        jog = {"kind": "jog", "axis": "X", "speed": 5.0, "id": 3}
        tell(socket, jog)
        assert "newest status" in hear(socket, "ack").reason
        sequence = hear(socket, "status").sequence
        time.sleep(0.4)  # as a message that lay in a buffer while the network was away
        tell(socket, {"kind": "seen", "sequence": sequence})
        tell(socket, jog)
        assert "newest status" in hear(socket, "ack").reason
    assert place.runtime.status.state == "idle"
    assert place.runtime.status.axes[0].commanded == 0.0


def test_a_slow_client_gets_the_newest_and_no_backlog(place, tell, hear) -> None:
    with place.socket("eve") as socket:
        numbers = [hear(socket, "status").sequence]
        while place.desk.hub.sequence < numbers[0] + 50:
            time.sleep(0.05)
        numbers += [hear(socket, "status").sequence for _ in range(AHEAD - 1)]
        with pytest.raises(TimeoutError):
            socket.recv(timeout=0.3)
        newest = place.desk.hub.sequence
        tell(socket, {"kind": "seen", "sequence": numbers[-1]})
        assert hear(socket, "status").sequence >= newest > numbers[-1] + AHEAD
        tell(socket, {"kind": "estop", "id": 9})  # and commands of a client that does not see are answered
        assert hear(socket, "ack").ok


def test_status_comes_fifty_times_a_second_of_a_clock_that_is_not_quite_even() -> None:
    runtime, chance = Runtime(LiveTwin(trochia.load("reference-mill"))), np.random.default_rng(1)
    told = set()
    runtime.watchers.append(lambda status, _: told.add(status.sequence))
    for turn in range(1, 2001):
        runtime.turn(turn * PERIOD + chance.uniform(-0.001, 0.001))
    runtime.close()
    assert len(told) == pytest.approx(500, abs=2)


@pytest.mark.parametrize("garbage", ["", "[]", "null", '{"kind":"jog"}', '{"kind":"fly","id":1}', '{"id":1}', "\x00",
                                     '{"kind":"seen","sequence":-1}', b"\xff\xfe", '{"kind":"watch","samples":3}',
                                     '{"kind":"estop","id":1,"really":true}', "[" * 100_000])  # fmt: skip
def test_garbage_is_answered_and_changes_nothing(place, tell, hear, garbage) -> None:
    with place.socket("ada") as socket:
        tell(socket, garbage)
        ack = hear(socket, "ack")
        assert (ack.ok, ack.id) == (False, 0)
        assert ack.reason
        tell(socket, {"kind": "watch", "samples": False, "id": 5})
        assert hear(socket, "ack").id == 5
    assert place.runtime.status.state == "off"


def test_too_much_garbage_cuts_the_socket(place, tell) -> None:
    with place.socket("ada") as socket:
        for _ in range(MISTAKES):
            tell(socket, "nonsense")
        _until_closed(socket)
    refused = [entry for entry in place.log() if entry["kind"] == "refused"]
    assert len(refused) == MISTAKES
    assert all(entry["user"] == "ada" for entry in refused)


_json = st.recursive(
    st.one_of(st.none(), st.booleans(), st.floats(), st.text(max_size=9)),
    lambda inner: st.dictionaries(st.sampled_from(["kind", "id", "axis", "speed"]), inner), max_leaves=6,
).map(lambda value: msgspec.json.encode(value).decode())  # fmt: skip
_garbage = st.one_of(st.text(max_size=60), st.binary(max_size=60), _json)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=40)
@given(data=st.lists(_garbage, min_size=1, max_size=10))
def test_no_garbage_moves_or_stops_the_server(served_once, tell, hear, data) -> None:
    with served_once.socket("eve") as socket:
        for message in data:
            tell(socket, message)
        tell(socket, {"kind": "path", "id": 77})
        while (ack := hear(socket, "ack")).id != 77:
            assert not ack.ok
        assert ack.reason == "no program is loaded"
    assert served_once.runtime.status.state == "off"


@given(data=st.one_of(st.binary(max_size=80), st.binary(max_size=80).map(lambda rest: b"TRO1" + rest)))
def test_a_frame_that_is_none_is_refused(data: bytes) -> None:
    with pytest.raises(RemoteProtocolError):
        unpack(data)


@given(data=st.binary(max_size=80))
def test_a_message_that_is_none_is_refused(data: bytes) -> None:
    with pytest.raises(RemoteProtocolError):
        decode_message(data)


def test_at_most_so_many_commands_wait(place, tell, hear) -> None:
    with place.socket("ada") as socket:
        tell(socket, {"kind": "take", "id": 1})
        for number in range(2, 302):
            tell(socket, {"kind": "override", "feed": 1.0, "id": number})
        tell(socket, {"kind": "estop", "id": 999})
        answers = {}
        while 999 not in answers:
            ack = hear(socket, "ack")
            answers[ack.id] = ack
    assert answers[999].ok
    assert all(answer.ok or "wait for their answers" in answer.reason for answer in answers.values())


def test_logging_out_closes_the_sockets_of_the_session(place, hear) -> None:
    with place.http("ada") as http:
        cookie = "; ".join(f"{name}={value}" for name, value in http.cookies.items())
        with place.socket(None, cookie=cookie) as socket:
            hear(socket, "status")
            http.post("/api/logout")
            _until_closed(socket)


def test_a_held_control_ends_with_its_session(place) -> None:
    with place.http("ada") as http, place.client("bob") as bob:
        http.post("/api/take", json={"kind": "take"})
        http.post("/api/logout")
        bob.take()
        bob.command(Enable())
