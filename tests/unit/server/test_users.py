"""Users, doors, waits, control, the log: the parts that need no network."""

from __future__ import annotations

import json

import pytest

from trochia.controller.journal import entries
from trochia.errors import ConfigError
from trochia.messages.command import Enable
from trochia.server.audit import STRANGE, Audit
from trochia.server.authority import Authority
from trochia.server.doors import Doors
from trochia.server.openapi import document
from trochia.server.sessions import IDLE, MOST, Sessions
from trochia.server.throttle import FORGIVEN, FREE, LONGEST, Throttle
from trochia.server.users import User, Users, new_password

CHEAP = 1 << 10


def test_the_first_start_makes_an_operator_once(tmp_path) -> None:
    users = Users(tmp_path / "new" / "users.json", cost=CHEAP)
    password = users.first()
    assert password is not None
    assert users.first() is None
    user = users.verify("operator", password)
    assert user is not None
    assert user.role == "operator"
    assert users.verify("operator", password + "x") is None
    assert users.verify("nobody", password) is None


def test_no_password_is_kept_and_nobody_else_may_read_the_file(tmp_path) -> None:
    path = tmp_path / "users.json"
    users = Users(path, cost=CHEAP)
    for name in ("ada", "bob"):
        users.put(name, "viewer", "one and the same")
    assert path.stat().st_mode & 0o777 == 0o600
    assert "same" not in path.read_text()
    ada, bob = users.all()
    assert ada.key != bob.key  # salted
    path.chmod(0o644)
    with pytest.raises(ConfigError, match="chmod 600"):
        users.verify("ada", "one and the same")


@pytest.mark.parametrize("content", [b"", b"{}", b"[", b'{"format": 1, "users": 3}', b"\xff"])
def test_a_file_that_is_no_users_file_is_refused(tmp_path, content: bytes) -> None:
    path = tmp_path / "users.json"
    path.write_bytes(content)
    path.chmod(0o600)
    with pytest.raises(ConfigError, match="is no users file"):
        Users(path, cost=CHEAP).first()


def test_a_newer_file_is_refused_by_its_format(tmp_path) -> None:
    path = tmp_path / "users.json"
    path.write_text(json.dumps({"format": 99, "users": []}))
    path.chmod(0o600)
    with pytest.raises(ConfigError, match="format 99"):
        Users(path, cost=CHEAP).all()


@pytest.mark.parametrize(("name", "password"), [("", "long enough"), ("a b", "long enough"), ("a" * 65, "long enough"),
                                                ("ada", "short")])  # fmt: skip
def test_names_and_passwords_that_cannot_be(tmp_path, name: str, password: str) -> None:
    with pytest.raises(ConfigError):
        Users(tmp_path / "users.json", cost=CHEAP).put(name, "operator", password)
    assert not (tmp_path / "users.json").exists()


def test_users_are_removed_and_passwords_changed(tmp_path) -> None:
    users = Users(tmp_path / "users.json", cost=CHEAP)
    users.put("ada", "operator", "the first one")
    users.put("ada", "viewer", "the second one")
    assert [(user.name, user.role) for user in users.all()] == [("ada", "viewer")]
    assert users.verify("ada", "the first one") is None
    assert users.verify("ada", "the second one")
    assert users.remove("ada")
    assert not users.remove("ada")


def test_new_passwords_differ() -> None:
    made = {new_password() for _ in range(100)}
    assert len(made) == 100
    assert {len(password) for password in made} == {19}


@pytest.mark.parametrize(
    ("host", "good"),
    [
        ("127.0.0.1:8765", True),
        ("LOCALHOST:8765", True),
        ("[::1]:8765", True),
        ("mill.local:8765", True),
        ("lathe.local:443", True),
        ("127.0.0.1", False),
        ("127.0.0.1:80", False),
        ("mill.local.evil.example:8765", False),
        ("evil.example:8765", False),
        ("", False),
    ],
)
def test_a_server_goes_by_its_names_only(host: str, good: bool) -> None:  # noqa: FBT001 - the expected answer
    doors = Doors.of(8765, ["mill.local", "lathe.local:443"])
    assert bool(doors.refusal({"host": host})) is not good
    assert bool(doors.refusal({"host": "127.0.0.1:8765", "origin": f"http://{host.lower()}"})) is not good
    assert doors.refusal({"host": "127.0.0.1:8765", "origin": f"https://{host}"})


def test_the_usual_port_may_be_left_out() -> None:
    doors = Doors.of(443, ["mill.local"], secure=True)
    assert doors.refusal({"host": "mill.local", "origin": "https://mill.local"}) == ""
    assert doors.refusal({"host": "mill.local", "origin": "http://mill.local"})


def test_waits_double_end_and_are_forgotten() -> None:
    throttle = Throttle()
    for count in range(FREE):
        throttle.failed("a", float(count))
    assert throttle.wait("a", 2.0) == 0.0
    waits = []
    for _ in range(8):
        throttle.failed("a", 10.0)
        waits.append(throttle.wait("a", 10.0))
    assert waits == [1.0, 2.0, 4.0, 8.0, 16.0, LONGEST, LONGEST, LONGEST]
    assert throttle.wait("b", 10.0) == 0.0
    assert throttle.wait("a", 10.0 + LONGEST) == 0.0
    assert throttle.wait("a", 11.0 + FORGIVEN) == 0.0
    throttle.succeeded("a")
    throttle.failed("a", 10.0)
    assert throttle.wait("a", 10.0) == 0.0


def _user(name: str = "ada", role: str = "operator") -> User:
    return User(name=name, role=role, salt=b"", key=b"")


def test_sessions_end_by_age_by_hand_and_by_number() -> None:
    now = [0.0]
    sessions = Sessions(lambda: now[0])
    first, session = sessions.open(_user(), "here")
    assert sessions.of(first) is session
    assert sessions.of(first + "x") is None
    now[0] = IDLE - 1.0
    assert sessions.of(first) is session  # and is young again
    now[0] = 2 * IDLE - 2.0
    assert sessions.of(first) is session
    now[0] = 3 * IDLE
    assert sessions.of(first) is None
    tokens = [sessions.open(_user(), "here")[0] for _ in range(MOST + 1)]
    assert sessions.of(tokens[0]) is None
    assert sessions.of(tokens[1]) is not None


def test_control_of_a_session_that_has_ended_is_nobodys() -> None:
    sessions = Sessions(lambda: 0.0)
    authority = Authority()
    _, ada = sessions.open(_user("ada"), "")
    _, bob = sessions.open(_user("bob"), "")
    assert authority.take(ada, over=False) == ""
    assert authority.take(ada, over=False) == ""  # again
    assert "ada has control" in authority.refusal(bob, Enable())
    sessions.close(ada)
    assert "nobody" in authority.refusal(bob, Enable())
    assert authority.take(bob, over=False) == ""
    authority.release(ada)
    assert authority.holder is bob


def test_strangers_cannot_flood_the_log(tmp_path) -> None:
    audit = Audit(tmp_path)
    for number in range(1000):
        audit.note("refused", None, "there", reason="x" * 10_000, number=number)
    audit.close()
    kept = list(entries(tmp_path))
    assert STRANGE <= len(kept) <= 3 * STRANGE + 3  # the second may turn while it runs
    assert max(len(entry["reason"]) for entry in kept) < 300


def test_the_description_is_whole() -> None:
    made = document()
    text = json.dumps(made)
    names = set(made["components"]["schemas"])
    referred = {part.split('"')[0] for part in text.split("#/components/schemas/")[1:]}
    assert referred <= names
    assert {"Status", "Ack", "Jog", "Told", "Take", "Seen"} <= names
    assert made["components"]["schemas"]["Command"]["discriminator"] == {"propertyName": "kind"}
    assert all("summary" in operation for path in made["paths"].values() for operation in path.values())
