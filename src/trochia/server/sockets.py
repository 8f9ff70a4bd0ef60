"""One WebSocket: commands in, answers and the newest status out.

A client says which status it has seen; at most :data:`AHEAD` are on their way to it.  So a slow client, or one whose
network was away, gets the newest next, and nothing waits for it anywhere.
"""

from __future__ import annotations

import asyncio
from collections import deque
from typing import TYPE_CHECKING, Any

from starlette.websockets import WebSocketDisconnect

from trochia.errors import RemoteProtocolError
from trochia.messages import Ack, Told, decode_message, encode
from trochia.messages.command import Command, EmergencyStop, Jog, JogStop
from trochia.messages.session import Release, Seen, ShowPath, Take, Watch
from trochia.server.shape import path_frame

if TYPE_CHECKING:
    from collections.abc import Coroutine

    from starlette.websockets import WebSocket

    from trochia.messages import AnyCommand, AnyMessage
    from trochia.server.desk import Desk
    from trochia.server.sessions import Session

MOST_BYTES = 4 << 20  #: of one message on a socket; greater programs are loaded by POST
AHEAD = 8  #: statuses sent that the client has not seen yet: 0.16 s
UNDER_WAY = 32  #: commands of one socket that have not been answered
WAITING = 256  #: messages for a client that does not read: then it is cut off
MISTAKES = 20  #: messages that cannot be read: then it is cut off
TASKS = 2  #: bulk that is made at a time for one socket
SAMPLES = 0.1  #: between frames of samples [s]
POLICY, TOO_SLOW = 1008, 1013  #: why a socket is closed (RFC 6455)


class Connection:
    """One socket of a session."""

    def __init__(self, desk: Desk, socket: WebSocket, session: Session, address: str) -> None:
        self._desk, self._socket, self._session, self._address = desk, socket, session, address
        self._loop = asyncio.get_running_loop()
        self._wake = asyncio.Event()
        self._outbox: deque[str | bytes] = deque()
        self._sent: deque[int] = deque()  # numbers of statuses that are on their way
        self._last = -1  # number of the last status sent
        self._seen = -1
        self._under_way = 0
        self._mistakes = 0
        self._jogs = False
        self._since: int | None = None  # next row of samples, where they are wanted
        self._tasks: set[asyncio.Task[None]] = set()

    async def run(self) -> None:
        """Serve the socket to its end; a jog it began ends with it."""
        desk = self._desk
        await self._socket.accept()
        desk.audit.note("connect", self._session, self._address)
        desk.hub.join(self._wake.set)
        desk.join(self._control_changed)
        self._control_changed()
        writer = asyncio.create_task(self._write())
        try:
            await self._read()
        finally:
            writer.cancel()
            desk.hub.leave(self._wake.set)
            desk.part(self._control_changed)
            self._watch(on=False)
            if self._jogs and desk.authority.holder is self._session:
                desk.runtime.send(JogStop())
            desk.audit.note("disconnect", self._session, self._address)

    # -- out

    def _put(self, message: str | bytes) -> None:
        self._outbox.append(message)
        self._wake.set()

    def _control_changed(self) -> None:
        self._put(encode(Told(session=self._desk.who(self._session))).decode())

    async def _write(self) -> None:
        hub, socket = self._desk.hub, self._socket
        try:
            while self._desk.sessions.alive(self._session) and len(self._outbox) <= WAITING:
                await self._wake.wait()
                self._wake.clear()
                if hub.sequence != self._last and len(self._sent) < AHEAD:
                    self._last = hub.sequence
                    self._sent.append(self._last)
                    await socket.send({"type": "websocket.send", "text": hub.text})
                while self._outbox:
                    message = self._outbox.popleft()
                    form = "text" if isinstance(message, str) else "bytes"
                    await socket.send({"type": "websocket.send", form: message})
            await socket.close(POLICY if self._session.over else TOO_SLOW)
        except (WebSocketDisconnect, RuntimeError, OSError):
            return  # it is gone: the reader sees it too

    # -- in

    async def _read(self) -> None:
        while self._mistakes < MISTAKES:
            message = await self._socket.receive()
            if message["type"] == "websocket.disconnect":
                if message.get("code") == 1009:
                    self._refused("a message that is too long")
                return
            if not self._desk.sessions.alive(self._session):
                break
            data = message.get("text")
            try:
                said = decode_message(message.get("bytes") or b"" if data is None else data, most=MOST_BYTES)
            except RemoteProtocolError as error:
                self._mistakes += 1
                self._refused(error.message)
                self._answer(Ack(id=0, ok=False, reason=error.message))
                continue
            self._take(said)
        await self._socket.close(POLICY)

    def _take(self, said: AnyMessage) -> None:
        match said:
            case Seen():
                self._saw(said.sequence)
            case Command():
                self._command(said)
            case Take():
                self._answer(self._ack(said.id, self._desk.take(self._session, over=said.over)))
            case Release():
                self._desk.release(self._session)
                self._answer(Ack(id=said.id, ok=True))
            case Watch():
                self._watch(on=said.samples)
                self._answer(Ack(id=said.id, ok=True))
            case ShowPath() if len(self._tasks) < TASKS:
                self._spawn(self._show_path(said))
            case ShowPath():
                self._answer(Ack(id=said.id, ok=False, reason="a path is being made already"))

    def _saw(self, sequence: int) -> None:
        self._seen = max(self._seen, min(sequence, self._last))
        while self._sent and self._sent[0] <= sequence:
            self._sent.popleft()
        self._session.used = self._loop.time()
        if self._last != self._desk.hub.sequence:
            self._wake.set()

    def _command(self, command: AnyCommand) -> None:
        if self._under_way >= UNDER_WAY and not isinstance(command, EmergencyStop):
            self._answer(Ack(id=command.id, ok=False, reason=f"{UNDER_WAY} commands wait for their answers already"))
            return
        self._under_way += 1
        self._jogs = isinstance(command, Jog)
        self._desk.command(self._session, command, self._answered, age=self._desk.hub.age(self._seen))

    def _answered(self, ack: Ack) -> None:
        """Pass an answer on; in whichever thread."""
        try:
            self._loop.call_soon_threadsafe(self._done, ack)
        except RuntimeError:
            return  # the server has been closed

    def _done(self, ack: Ack) -> None:
        self._under_way -= 1
        self._answer(ack)

    def _answer(self, ack: Ack) -> None:
        self._put(encode(Told(ack=ack)).decode())

    def _ack(self, number: int, refused: str) -> Ack:
        return Ack(id=number, ok=not refused, reason=refused)

    def _refused(self, reason: str) -> None:
        self._desk.audit.note("refused", self._session, self._address, reason=reason)

    # -- bulk

    def _spawn(self, work: Coroutine[Any, Any, None]) -> None:
        task = self._loop.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _show_path(self, asked: ShowPath) -> None:
        made = self._desk.runtime.controller.preview
        if made is None:
            self._answer(Ack(id=asked.id, ok=False, reason="no program is loaded"))
            return
        frame = await asyncio.to_thread(path_frame, made.plan, made.name, asked.points)
        self._put(frame)
        self._answer(Ack(id=asked.id, ok=True))

    def _watch(self, *, on: bool) -> None:
        samples = self._desk.samples
        if on == (self._since is not None):
            return
        samples.lookers += 1 if on else -1
        self._since = samples.count if on else None
        if on:
            self._spawn(self._send_samples())

    async def _send_samples(self) -> None:
        while True:
            await asyncio.sleep(SAMPLES)
            since = self._since
            if since is None:
                return
            if len(self._sent) < AHEAD and not self._outbox:
                frame, self._since = self._desk.samples.frame(since)
                self._put(frame)
