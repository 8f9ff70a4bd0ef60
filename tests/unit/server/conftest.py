"""A machine on its twin in real time, served on loopback, and clients that misbehave on request."""

from __future__ import annotations

import socket
import time
from contextlib import contextmanager
from dataclasses import dataclass
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
from trochia.server import Desk, Doors, Served, Users, bring_to_rest, listen

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

    def socket(self, user: str | None = "ada", *, origin: str | None = None, host: str | None = None):
        headers = {}
        if user is not None:
            with self.http(user) as http:
                headers["Cookie"] = "; ".join(f"{name}={value}" for name, value in http.cookies.items())
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


@pytest.fixture
def serve(tmp_path):
    """Serve a machine of the wheel."""
    places = []

    def start(name: str = "reference-mill") -> Place:
        machine = trochia.load(name)
        users = Users(tmp_path / "users.json", cost=CHEAP)
        for user, role in ROLES.items():
            users.put(user, role, PASSWORD[user])
        runtime = Runtime(LiveTwin(machine, switches=switches_of(machine)), journal=tmp_path / "journal",
                          now=time.monotonic())  # fmt: skip
        listening = listen("127.0.0.1", 0)
        desk = Desk(runtime, users, Doors.of(listening.getsockname()[1]), log=tmp_path / "journal" / "access")
        runtime.start()
        served = Served(desk, listening)
        served.start()
        places.append(Place(runtime, desk, served, tmp_path))
        return places[-1]

    yield start
    for place in places:
        place.close()


@pytest.fixture
def place(serve) -> Place:
    return serve()
