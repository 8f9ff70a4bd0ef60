"""A machine on its twin in real time, served on loopback, and clients that misbehave on request."""

from __future__ import annotations

import socket
import time
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import httpx
import msgspec
import pytest
from websockets.sync.client import connect

import trochia
from trochia.backends.live_twin import LiveTwin
from trochia.backends.switches import switches_of
from trochia.client import Client
from trochia.controller.journal import entries
from trochia.controller.runtime import Runtime
from trochia.messages import decode_told
from trochia.server.desk import Desk
from trochia.server.doors import Doors
from trochia.server.listen import Served, listen
from trochia.server.rest import bring_to_rest
from trochia.server.users import Users

if TYPE_CHECKING:
    from pathlib import Path

CHEAP = 1 << 10  #: rounds of scrypt: tests log in often
PASSWORD = {"ada": "ada-ada-ada", "bob": "bob-bob-bob", "eve": "eve-eve-eve"}
ROLES = {"ada": "operator", "bob": "operator", "eve": "viewer"}


@dataclass
class Place:
    """A served machine."""

    runtime: Runtime
    desk: Desk
    served: Served
    folder: Path
    cookies: dict[str, str] = field(default_factory=dict)

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.served.port}"

    def client(self, user: str = "ada") -> Client:
        return Client.connect(self.url, user, PASSWORD[user])

    @contextmanager
    def http(self, user: str | None = "ada", **headers: str):
        with httpx.Client(base_url=self.url, headers=headers, timeout=30.0, trust_env=False) as made:
            if user is not None:
                answer = made.post("/api/login", json={"user": user, "password": PASSWORD[user]})
                assert answer.status_code == 200, answer.text
            yield made

    def cookie(self, user: str) -> str:
        """Return the cookie of a login, one for all sockets of a user."""
        if user not in self.cookies:
            with self.http(user) as http:
                self.cookies[user] = "; ".join(f"{name}={value}" for name, value in http.cookies.items())
        return self.cookies[user]

    def socket(self, user: str | None = "ada", *, origin: str | None = None, host: str | None = None,
               cookie: str | None = None):  # fmt: skip
        headers = {} if cookie is None else {"Cookie": cookie}
        if user is not None:
            headers["Cookie"] = self.cookie(user)
        if host is not None:
            headers["Host"] = host
        line = socket.create_connection(("127.0.0.1", self.served.port))
        try:
            return connect(self.url.replace("http", "ws") + "/api/socket", sock=line, origin=origin,
                           additional_headers=headers, compression=None, proxy=None, max_size=None)  # fmt: skip
        except BaseException:
            line.close()  # the library leaves it open when it is refused
            raise

    def log(self) -> list[dict]:
        """Return what the log holds once its thread has caught up."""
        time.sleep(0.6)
        return list(entries(self.folder / "journal" / "access"))

    def journal(self) -> list[dict]:
        return list(entries(self.folder / "journal"))

    def close(self) -> None:
        self.served.close()
        bring_to_rest(self.runtime)
        self.desk.close()
        self.runtime.close()


def told(socket, want, timeout=20.0):
    """Return the first message of a raw socket that has what is wanted."""
    end = time.monotonic() + timeout
    while time.monotonic() < end:
        message = socket.recv(timeout=max(end - time.monotonic(), 0.1))
        if isinstance(message, bytes):
            if want == "frame":
                return message
            continue
        found = decode_told(message)
        if want != "frame" and getattr(found, want) is not None:
            return getattr(found, want)
    raise AssertionError(f"no {want} came")


def say(socket, message) -> None:
    """Send something on a raw socket."""
    socket.send(message if isinstance(message, (str, bytes)) else msgspec.json.encode(message).decode())


@pytest.fixture
def tell():
    return say


@pytest.fixture
def hear():
    return told


def _open(name: str, folder: Path) -> Place:
    """Serve a machine of the wheel."""
    machine = trochia.load(name)
    users = Users(folder / "users.json", cost=CHEAP)
    for user, role in ROLES.items():
        users.put(user, role, PASSWORD[user])
    runtime = Runtime(LiveTwin(machine, switches=switches_of(machine)), journal=folder / "journal",
                      now=time.monotonic())  # fmt: skip
    listening = listen("127.0.0.1", 0)
    desk = Desk(runtime, users, Doors.of(listening.getsockname()[1]), log=folder / "journal" / "access")
    runtime.start()
    served = Served(desk, listening)
    served.start()
    return Place(runtime, desk, served, folder)


@pytest.fixture
def place(tmp_path):
    made = _open("reference-mill", tmp_path)
    yield made
    made.close()


@pytest.fixture(scope="module")
def served_once(tmp_path_factory):
    """One machine for many examples."""
    made = _open("reference-mill", tmp_path_factory.mktemp("served"))
    yield made
    made.close()
