"""The socket itself: leases of jogs, slow clients, garbage."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

import msgspec
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from websockets.exceptions import ConnectionClosed

from trochia.errors import RemoteProtocolError
from trochia.messages import decode_message, unpack
from trochia.messages.command import Enable
from trochia.server.desk import LEASE
from trochia.server.sockets import AHEAD, MISTAKES

#: between the last renewal as the controller took it and the order to brake: the lease, and turns of a busy computer
BRAKES = LEASE + 0.02

JOGGER = """
import sys, time
from trochia.client import Client
from trochia.messages.command import Enable
client = Client.connect(sys.argv[1], "ada", "ada-ada-ada")
client.take()
client.command(Enable())
print("ready", flush=True)
client.jog("X", 5.0, 60.0)
"""


def _lease(place) -> tuple[float, float]:
    """Return when the jog last was renewed, and when it began to brake, by the controller's own clock [s]."""
    renewed, ended = 0.0, 0.0
    for entry in place.journal():
        if entry["kind"] == "command" and entry["command"] == "jog":
            renewed = entry["time"]
        if entry["kind"] == "state" and entry["was"] == "jogging" and not ended:
            ended = entry["time"]
    return renewed, ended


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
        _wait(place, "jogging")
        time.sleep(0.3)
        assert place.runtime.status.state == "jogging"  # renewed
        os.kill(jogger.pid, how)
        _wait(place, "idle")
    finally:
        jogger.kill()
        jogger.communicate()
    renewed, ended = _lease(place)
    assert renewed < ended <= renewed + BRAKES
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
    renewed, ended = _lease(place)
    assert renewed < ended <= renewed + BRAKES  # the lease of a second was cut


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
        time.sleep(1.0)  # some 50 statuses
        numbers += [hear(socket, "status").sequence for _ in range(AHEAD - 1)]
        with pytest.raises(TimeoutError):
            socket.recv(timeout=0.3)
        tell(socket, {"kind": "seen", "sequence": numbers[-1]})
        newest = hear(socket, "status").sequence
        assert newest - numbers[-1] > 30
        assert place.runtime.status.sequence - newest < 20
        tell(socket, {"kind": "estop", "id": 9})  # and commands of a client that does not see are answered
        assert hear(socket, "ack").ok


def test_status_comes_fifty_times_a_second(place) -> None:
    with place.client("eve") as eve:
        first = eve.status
        last = eve.wait_until(lambda status: status.time > first.time + 1.0, timeout=30.0)
    made = (last.sequence - first.sequence) / (last.time - first.time)
    assert 25.0 < made < 55.0  # of the controller's own clock; a busy computer makes fewer


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
