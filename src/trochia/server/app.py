"""The application: every path to its handler, behind the guard.  In: a desk.  Out: an ASGI application."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING

from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.responses import JSONResponse
from starlette.routing import Route, WebSocketRoute

from trochia.server.guard import Guard
from trochia.server.openapi import PATHS, SOCKET
from trochia.server.requests import Refused, address_of, session_of
from trochia.server.routes import PAGE, Routes
from trochia.server.sockets import Connection

if TYPE_CHECKING:
    from collections.abc import AsyncGenerator

    from starlette.requests import Request
    from starlette.responses import Response
    from starlette.websockets import WebSocket

    from trochia.server.desk import Desk


LOOK = 1.0  #: between looks at the users file [s]


async def _look_at_users(desk: Desk) -> None:
    while True:
        await asyncio.sleep(LOOK)
        desk.look_at_users()


def make_app(desk: Desk) -> Starlette:
    """Return the application that serves a desk."""
    routes = Routes(desk)

    async def socket(socket: WebSocket) -> None:
        session, address = session_of(desk, socket), address_of(socket)
        if session is None:
            desk.audit.note("refused", None, address, path=SOCKET, reason="not logged in")
            await socket.close(1008)
            return
        await Connection(desk, socket, session, address).run()

    async def refused(request: Request, error: Exception) -> Response:
        if not isinstance(error, Refused):
            raise error
        if error.status in {400, 408, 413, 415}:
            desk.audit.note("refused", session_of(desk, request), address_of(request), path=request.url.path,
                            reason=error.reason)  # fmt: skip
        return JSONResponse({"error": error.reason}, error.status, headers=error.headers)

    @asynccontextmanager
    async def life(_app: Starlette) -> AsyncGenerator[None]:
        desk.hub.begin(asyncio.get_running_loop())
        looking = asyncio.create_task(_look_at_users(desk))
        yield
        looking.cancel()
        desk.hub.end()

    return Starlette(
        routes=[
            *(Route(path, routes.page) for path in PAGE),
            *(Route(path.path, getattr(routes, path.handler), methods=[path.method.upper()]) for path in PATHS),
            WebSocketRoute(SOCKET, socket),
        ],
        middleware=[Middleware(Guard, desk=desk)],
        exception_handlers={Refused: refused},
        lifespan=life,
    )
