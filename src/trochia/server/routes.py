"""The HTTP side: in and out, commands one by one, status, path, description of all of it.

Each handler takes a request and returns a response; what it refuses it raises.
"""

from __future__ import annotations

import asyncio
import time
from importlib.resources import files
from typing import TYPE_CHECKING, TypeVar

import msgspec
from starlette.responses import JSONResponse, Response

from trochia.errors import RemoteProtocolError
from trochia.messages import Ack, Credentials, Release, Take, decode_command
from trochia.messages.codec import MOST_BYTES
from trochia.messages.command import EmergencyStop, Jog
from trochia.messages.session import MOST_POINTS
from trochia.server.openapi import document
from trochia.server.requests import Refused, address_of, answer, body_of, cookie_name, need_session
from trochia.server.sessions import IDLE
from trochia.server.shape import path_frame

if TYPE_CHECKING:
    from starlette.requests import Request

    from trochia.messages import AnyCommand
    from trochia.server.desk import Desk
    from trochia.server.sessions import Session

_Kind = TypeVar("_Kind", bound=msgspec.Struct)

SMALL = 4096  #: bytes of a login
PAGE = {"/": ("index.html", "text/html"), "/page.js": ("page.js", "text/javascript"),
        "/page.css": ("page.css", "text/css")}  # fmt: skip
PATIENCE = 120.0  #: for the controller's answer: a long program is planned before it is loaded [s]
ATTEMPTS = 4  #: passwords that may wait to be looked at


class Routes:
    """The handlers of one desk."""

    def __init__(self, desk: Desk) -> None:
        self._desk = desk
        self._checking = asyncio.Lock()  # scrypt takes 32 MB: one at a time
        self._attempts = 0

    async def page(self, request: Request) -> Response:
        """Return a file of the status page."""
        name, kind = PAGE[request.url.path]
        return Response(files("trochia").joinpath("data", "server", name).read_bytes(), media_type=kind)

    async def openapi(self, _request: Request) -> Response:
        """Return the description of the interface."""
        return JSONResponse(document())

    async def login(self, request: Request) -> Response:
        """Open a session for who knows a password; answer with its cookie."""
        desk, address = self._desk, address_of(request)
        wait = desk.throttle.wait(address, time.monotonic())
        if wait or self._attempts >= ATTEMPTS:
            desk.audit.note("refused", None, address, reason="too many logins")
            raise Refused(429, "too many attempts; wait a little", {"retry-after": str(int(wait) + 1)})
        said = _decoded(await body_of(request, SMALL), Credentials)
        self._attempts += 1
        try:
            async with self._checking:
                user = await asyncio.to_thread(desk.users.verify, said.user, said.password)
        finally:
            self._attempts -= 1
        if user is None:
            desk.throttle.failed(address, time.monotonic())
            desk.audit.note("login-failed", None, address, name=said.user)
            raise Refused(401, "name or password is wrong")
        desk.throttle.succeeded(address)
        token, session = desk.sessions.open(user, address)
        desk.audit.note("login", session, address)
        response = answer(desk.who(session))
        response.set_cookie(cookie_name(desk, request), token, max_age=int(IDLE), httponly=True, samesite="strict",
                            secure=desk.doors.secure, path="/")  # fmt: skip
        return response

    async def logout(self, request: Request) -> Response:
        """End the session."""
        self._desk.leave(need_session(self._desk, request))
        response = Response(status_code=204)
        response.delete_cookie(cookie_name(self._desk, request), path="/", httponly=True, samesite="strict",
                               secure=self._desk.doors.secure)  # fmt: skip
        return response

    async def session(self, request: Request) -> Response:
        """Return who one is."""
        return answer(self._desk.who(need_session(self._desk, request)))

    async def take(self, request: Request) -> Response:
        """Take control."""
        session = need_session(self._desk, request)
        said = _decoded(await body_of(request, SMALL), Take)
        refused = self._desk.take(session, over=said.over)
        return answer(Ack(id=said.id, ok=not refused, reason=refused), 409 if refused else 200)

    async def release(self, request: Request) -> Response:
        """Give control back."""
        session = need_session(self._desk, request)
        said = _decoded(await body_of(request, SMALL), Release)
        self._desk.release(session)
        return answer(Ack(id=said.id, ok=True))

    async def status(self, request: Request) -> Response:
        """Return the latest status."""
        need_session(self._desk, request)
        return answer(self._desk.runtime.status)

    async def command(self, request: Request) -> Response:
        """Have a command taken."""
        session = need_session(self._desk, request)
        # only who may move the machine may send a whole program
        most = MOST_BYTES if self._desk.authority.holder is session else SMALL
        try:
            command = decode_command(await body_of(request, most))
        except RemoteProtocolError as error:
            self._desk.audit.note("refused", session, address_of(request), reason=error.message)
            raise Refused(400, error.message) from None
        if isinstance(command, Jog):
            raise Refused(400, "a jog lives by renewal, and so on a socket; jog-by and jog-to work here")
        return await self._taken(session, command)

    async def stop(self, request: Request) -> Response:
        """Stop everything now."""
        return await self._taken(need_session(self._desk, request), EmergencyStop())

    async def path(self, request: Request) -> Response:
        """Return the path of the loaded program, a binary frame."""
        need_session(self._desk, request)
        made = self._desk.runtime.controller.preview
        if made is None:
            raise Refused(404, "no program is loaded")
        wanted = request.query_params.get("points", "200000")
        points = int(wanted) if wanted.isdecimal() and len(wanted) < 8 else 0
        if not 2 <= points <= MOST_POINTS:
            raise Refused(400, f"points: a whole number, 2 to {MOST_POINTS}")
        frame = await asyncio.to_thread(path_frame, made.plan, made.name, points)
        return Response(frame, media_type="application/octet-stream")

    async def _taken(self, session: Session, command: AnyCommand) -> Response:
        loop = asyncio.get_running_loop()
        future: asyncio.Future[Ack] = loop.create_future()
        allowed = not self._desk.authority.refusal(session, command)

        def answered(ack: Ack) -> None:
            loop.call_soon_threadsafe(lambda: future.cancelled() or future.set_result(ack))

        self._desk.command(session, command, answered)
        try:
            ack = await asyncio.wait_for(future, PATIENCE)
        except TimeoutError:
            raise Refused(504, f"the controller has not answered in {PATIENCE:g} s") from None
        return answer(ack, (200 if ack.ok else 409) if allowed else 403)


def _decoded(data: bytes, kind: type[_Kind]) -> _Kind:
    try:
        return msgspec.json.decode(data, type=kind)
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise Refused(400, str(error)) from None
