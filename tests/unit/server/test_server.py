"""The server over real HTTP and WebSockets: who may come in, who may move, what is refused and logged."""

from __future__ import annotations

import contextlib

import msgspec
import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

from trochia.client import Client, Refused
from trochia.errors import LinkError
from trochia.messages import Ack, Status, unpack
from trochia.messages.command import Enable, JogBy, Load

SQUARE = "G21 G90 G17\nF6000\nG1 X4\nY4\nX0\nY0\nG2 X2 I1\nM2\n"


def test_who_is_not_logged_in_gets_nothing(place) -> None:
    with place.http(None) as http:
        assert http.get("/").status_code == 200  # the page itself: it has the login
        for path in ("/api/session", "/api/status", "/api/path"):
            assert http.get(path).status_code == 401
        for path in ("/api/command", "/api/stop", "/api/take", "/api/logout"):
            assert http.post(path, json={"kind": "enable"}).status_code == 401
        assert http.get("/api/nothing").status_code == 404
    with pytest.raises(InvalidStatus):
        place.socket(None)
    assert place.runtime.status.state == "off"
    assert sum(entry["kind"] == "refused" and entry["reason"] == "not logged in" for entry in place.log()) == 8


def test_a_session_is_a_cookie_scripts_cannot_read_and_ends_at_logout(place) -> None:
    with place.http(None) as http:
        answer = http.post("/api/login", json={"user": "ada", "password": "ada-ada-ada"})
        cookie = answer.headers["set-cookie"].lower()
        assert "httponly" in cookie
        assert "samesite=strict" in cookie
        assert answer.json() == {"user": "ada", "role": "operator", "control": False, "holder": ""}
        assert msgspec.convert(http.get("/api/status").json(), Status).machine == "reference-mill"
        kept = dict(http.cookies)
        assert http.post("/api/logout").status_code == 204
        http.cookies.update(kept)  # somebody has kept a copy
        assert http.get("/api/status").status_code == 401


def test_wrong_passwords_are_slowed_and_logged(place) -> None:
    with place.http(None) as http:
        codes = [http.post("/api/login", json={"user": name, "password": "wrong"}).status_code
                 for name in ("ada", "nobody", "ada", "ada", "ada", "ada")]  # fmt: skip
        assert codes == [401, 401, 401, 401, 429, 429]
        blocked = http.post("/api/login", json={"user": "ada", "password": "ada-ada-ada"})
        assert (blocked.status_code, int(blocked.headers["retry-after"]) >= 1) == (429, True)
    assert [entry["name"] for entry in place.log() if entry["kind"] == "login-failed"] == [
        "ada",
        "nobody",
        "ada",
        "ada",
    ]


def test_who_is_removed_or_gets_another_password_is_out(place) -> None:
    with place.client("ada") as ada, place.client("bob") as bob, place.client("eve") as eve:
        ada.take()
        place.desk.users.remove("ada")
        place.desk.users.put("eve", "viewer", "another password")
        for gone in (ada, eve):
            with pytest.raises(LinkError, match="connection"):
                gone.wait_until("running", timeout=20.0)
        bob.take()  # nobody's any more
        bob.command(Enable())


def test_one_operator_at_a_time_with_take_over(place) -> None:
    with place.client("ada") as ada, place.client("bob") as bob, place.client("eve") as eve:
        with pytest.raises(Refused, match="nobody has control"):
            ada.command(Enable())
        ada.take()
        ada.command(Enable())
        with pytest.raises(Refused, match="ada has control"):
            bob.command(JogBy(way={"X": 1.0}))
        with pytest.raises(Refused, match="ada has control"):
            bob.take()
        with pytest.raises(Refused, match="viewers"):
            eve.take(over=True)
        with pytest.raises(Refused, match="viewers"):
            eve.command(JogBy(way={"X": 1.0}))
        bob.take(over=True)
        ada.wait_until(lambda _: ada.session is not None and ada.session.holder == "bob", timeout=20.0)
        with pytest.raises(Refused, match="bob has control"):
            ada.command(JogBy(way={"X": 1.0}))
        assert abs(place.runtime.status.axes[0].commanded) == 0.0
        bob.command(JogBy(way={"X": 1.0}))
        bob.wait_until(lambda status: abs(status.axes[0].commanded - 1.0) < 1e-6, timeout=20.0)
        bob.release()
        ada.take()
    log = place.log()
    assert [entry["user"] for entry in log if entry["kind"] == "take"] == ["ada", "bob", "ada"]
    assert next(entry["lost"] for entry in log if entry["kind"] == "take" and entry["user"] == "bob") == "ada"
    assert all(entry["from"] == "127.0.0.1" for entry in log)


@pytest.mark.parametrize("user", ["ada", "bob", "eve"])
def test_stop_is_for_everybody_who_is_in(place, user: str) -> None:
    with place.client("ada") as ada, place.client(user) as other:
        ada.take()
        ada.command(Enable())
        ada.command(JogBy(way={"X": 50.0}, speed=5.0))
        ada.wait_until("jogging", timeout=20.0)
        other.stop()
        ada.wait_until(lambda status: status.state == "estop" and status.axes[0].velocity == 0.0, timeout=20.0)
    assert any(entry.get("stop") and entry["user"] == user for entry in place.log())


def test_stop_by_post(place) -> None:
    with place.http("eve") as http:
        assert http.post("/api/stop").json()["ok"]
    assert place.runtime.status.state == "estop"


def test_commands_by_post_say_yes_or_why_not(place) -> None:
    with place.http("ada") as http:
        assert http.post("/api/command", json={"kind": "enable", "id": 7}).status_code == 403
        assert http.post("/api/take", json={"kind": "take"}).json() == {"id": 0, "ok": True}
        assert http.post("/api/command", json={"kind": "enable", "id": 7}).json() == {"id": 7, "ok": True}
        refused = http.post("/api/command", json={"kind": "resume", "id": 8})
        ack = msgspec.json.decode(refused.content, type=Ack)
        assert (refused.status_code, ack.ok, "run" in ack.legal) == (409, False, True)
        assert "not taken while idle" in ack.reason
        assert http.post("/api/command", json={"kind": "jog", "axis": "X", "speed": 5.0}).status_code == 400
        assert http.post("/api/command", content=b"{", headers={"content-type": "application/json"}).status_code == 400
        assert http.post("/api/command", json={"kind": "enable", "power": 9}).status_code == 400
        assert http.post("/api/command", content=b"kind=enable").status_code == 415


def test_a_body_that_is_too_long_is_refused(place) -> None:
    with place.http("eve") as http:
        load = {"kind": "load", "name": "x", "text": "x" * 5000}
        assert http.post("/api/command", json=load).status_code == 413
        assert http.post("/api/login", json={"user": "x" * 5000, "password": ""}).status_code == 413
    assert [entry["reason"] for entry in place.log() if entry["kind"] == "refused"] == [
        "the body has at most 4096 bytes"
    ] * 2


def test_a_message_that_is_too_long_cuts_the_socket(place, tell, hear) -> None:
    def flood() -> None:
        with place.socket("eve") as socket:
            tell(socket, "x" * (5 << 20))
            hear(socket, "ack")

    with pytest.raises(ConnectionClosed):
        flood()
    assert any("too long" in entry.get("reason", "") for entry in place.log())


@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": "http://127.0.0.1:1"},
        {"Host": "evil.example"},
        {"Host": "127.0.0.1"},
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "same-site", "Sec-Fetch-Mode": "navigate"},
    ],
)
def test_requests_of_other_sites_are_refused_even_with_the_cookie(place, headers: dict[str, str]) -> None:
    with place.http("ada") as http:
        cookie = "; ".join(f"{name}={value}" for name, value in http.cookies.items())
        for path in ("/api/stop", "/api/command", "/api/login", "/api/take"):
            assert http.post(path, headers=headers, json={"kind": "estop"}).status_code == 403
        assert http.get("/api/status", headers=headers).status_code == 403
    if "Sec-Fetch-Site" not in headers:
        with pytest.raises(InvalidStatus):
            place.socket("ada", origin=headers.get("Origin"), host=headers.get("Host"))
    assert place.runtime.status.state == "off"
    assert any("refused" in entry["reason"] or "name" in entry["reason"]
               for entry in place.log() if entry["kind"] == "refused")  # fmt: skip
    assert cookie


def test_a_link_may_lead_to_the_page_and_the_page_trusts_nobody_else(place) -> None:
    with place.http(None) as http:
        page = http.get("/", headers={"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "navigate"})
        assert page.status_code == 200
        assert "default-src 'none'" in page.headers["content-security-policy"]
        assert "unsafe" not in page.headers["content-security-policy"]
        assert page.headers["x-frame-options"] == "DENY"
        assert "access-control-allow-origin" not in page.headers


def test_our_own_origin_is_taken(place) -> None:
    with place.http("ada", Origin=place.url) as http:
        assert http.get("/api/session").status_code == 200
    with place.socket("ada", origin=place.url.replace("127.0.0.1", "localhost")):
        pass


def test_a_program_runs_to_its_end_and_its_path_is_shown(place) -> None:
    with place.client("ada") as ada, place.client("eve") as eve:
        ada.take()
        ada.command(Enable())
        with pytest.raises(Refused, match="no program is loaded"):
            ada.path()
        eve.watch(samples=True)
        end = ada.run("square.ngc", SQUARE, timeout=60.0)
        assert (end.state, end.alarms) == ("idle", ())
        where = {axis.name: axis.commanded for axis in end.axes}
        assert (round(where["X"], 6), round(where["Y"], 6)) == (2.0, 0.0)
        frame = eve.path()
        points, lines = frame.columns["points"], frame.columns["lines"]
        assert frame.head.about["name"] == "square.ngc"
        assert points.dtype == np.float32
        assert np.allclose(points[-1, :2], [2.0, 0.0], atol=1e-3)
        assert set(lines.tolist()) == {0, 3, 4, 5, 6, 7}
        half = points[lines == 7][:, :2]
        assert np.allclose(np.hypot(half[:, 0] - 1.0, half[:, 1]), 1.0, atol=0.011)
        assert len(half) > 8
        eve.wait_until(lambda _: bool(eve.frames), timeout=20.0)
        rows = np.concatenate([frame.columns["values"] for frame in eve.frames])
        names = eve.frames[0].head.about["names"]
        times = np.concatenate([frame.columns["time"] for frame in eve.frames])
        assert names[0] == "X.commanded"
        assert rows[:, 0].max() == pytest.approx(4.0, abs=0.05)
        assert (np.diff(times) > 0.0).all()


def test_a_long_program_goes_by_post(place) -> None:
    text = "G21 G90\nF6000\n" + "".join(f"G1 X{i % 7} (a comment that makes it long)\n" for i in range(3000)) + "M2\n"
    with place.http("ada") as http:
        http.post("/api/take", json={"kind": "take"})
        assert http.post("/api/command", json={"kind": "load", "name": "long", "text": text}).json()["ok"]
        frame = unpack(http.get("/api/path?points=100").content)
        assert frame.head.rows <= 100
        assert http.get("/api/path?points=1").status_code == 400
        assert http.get("/api/path?points=9999999999999").status_code == 400


def test_the_log_keeps_who_asked_for_what_and_not_every_renewal(place) -> None:
    with place.client("ada") as ada:
        ada.take()
        ada.command(Enable())
        with contextlib.suppress(Refused):  # a busy computer may be too slow for the lease
            ada.jog("X", 5.0, 0.5)
        ada.wait_until("idle", timeout=20.0)
        ada.command(Load(name="square.ngc", text=SQUARE))
    commands = [entry["command"] for entry in place.log() if entry["kind"] == "command"]
    assert sum('"jog"' in text for text in commands) < 4
    assert commands[-1] == f"load square.ngc, {len(SQUARE)} characters"
    assert all("password" not in str(entry) for entry in place.log())


def test_the_client_says_what_is_wrong(place) -> None:
    with pytest.raises(LinkError, match="name or password is wrong"):
        Client.connect(place.url, "ada", "something else")
    with pytest.raises(LinkError, match="nobody answers"):
        Client.connect("http://127.0.0.1:9", "ada", "x")
    with pytest.raises(LinkError, match="an address looks like"):
        Client.connect("ftp://127.0.0.1", "ada", "x")
    with place.client("eve") as eve:
        with pytest.raises(LinkError, match="'running' has not come"):
            eve.wait_until("running", timeout=0.05)
        place.served.close()
        with pytest.raises(LinkError, match="connection"):
            eve.wait_until("running", timeout=20.0)
    with pytest.raises(LinkError, match="closed"):
        eve.stop()


def test_after_a_reconnect_the_state_is_there_and_the_job_went_on(place) -> None:
    with place.client("ada") as ada:
        ada.take()
        ada.command(Enable())
        ada.command(JogBy(way={"X": 20.0}, speed=40.0))
    with place.client("ada") as again:
        end = again.wait_until(lambda status: status.state == "idle", timeout=20.0)
        assert end.axes[0].commanded == pytest.approx(20.0)
