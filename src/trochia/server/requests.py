"""What every request has in common: who sends it, from where, and a body that is not too long."""

from __future__ import annotations

import asyncio
import ipaddress
from typing import TYPE_CHECKING

from starlette.responses import Response

from trochia.messages import encode

if TYPE_CHECKING:
    from starlette.requests import HTTPConnection, Request

    from trochia.messages import Ack, SessionStatus, Status
    from trochia.server.desk import Desk
    from trochia.server.sessions import Session

PATIENCE = 30.0  #: a body must have arrived in [s]


class Refused(Exception):  # noqa: N818 - it is an answer, not a fault
    """A request that gets a status and a reason instead of an answer."""

    def __init__(self, status: int, reason: str, headers: dict[str, str] | None = None) -> None:
        super().__init__(reason)
        self.status, self.reason, self.headers = status, reason, headers


def address_of(connection: HTTPConnection) -> str:
    """Return the address a request comes from; a network of 64 bits stands for all of IPv6's addresses in it."""
    host = connection.client.host if connection.client else ""
    try:
        found = ipaddress.ip_address(host)
    except ValueError:
        return host
    return (
        str(ipaddress.ip_network((found, 64), strict=False)) if found.version == 6 and not found.is_loopback else host
    )


def cookie_name(desk: Desk, connection: HTTPConnection) -> str:
    """Return the name of the session's cookie; it carries the port, for cookies do not heed ports."""
    port = connection.url.port or (443 if desk.doors.secure else 80)
    return f"{'__Host-' if desk.doors.secure else ''}trochia-{port}"


def session_of(desk: Desk, connection: HTTPConnection) -> Session | None:
    """Return the session of a request's cookie, or None."""
    token = connection.cookies.get(cookie_name(desk, connection), "")
    return desk.sessions.of(token) if token else None


def need_session(desk: Desk, request: Request) -> Session:
    """Return the session of a request.

    Raises
    ------
    Refused
        When there is none: 401.
    """
    session = session_of(desk, request)
    if session is None:
        desk.audit.note("refused", None, address_of(request), path=request.url.path, reason="not logged in")
        raise Refused(401, "log in first")
    return session


async def body_of(request: Request, most: int) -> bytes:
    """Return a request's body, JSON by its own account.

    Raises
    ------
    Refused
        When it is no JSON (415), too long (413) or too slow (408).
    """
    if request.headers.get("content-type", "").partition(";")[0].strip().lower() != "application/json":
        raise Refused(415, "the body must be application/json")
    parts: list[bytes] = []
    size = 0
    try:
        async with asyncio.timeout(PATIENCE):
            async for part in request.stream():
                size += len(part)
                if size > most:
                    raise Refused(413, f"the body has at most {most} bytes", {"connection": "close"})
                parts.append(part)
    except TimeoutError:
        raise Refused(408, "the body did not arrive in time", {"connection": "close"}) from None
    return b"".join(parts)


def answer(message: Status | Ack | SessionStatus, status: int = 200) -> Response:
    """Return a message as a response."""
    return Response(encode(message), status, media_type="application/json")
