"""The asyncio face of a machine at a distance.  In: commands.  Out: their answers, the newest status, frames."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import time
from collections import deque
from typing import TYPE_CHECKING, Self

import msgspec
from websockets.asyncio.client import connect as open_socket
from websockets.exceptions import InvalidHandshake, InvalidStatus, WebSocketException

from trochia.client.login import login
from trochia.errors import LinkError, LinkTimeout, RemoteProtocolError, VersionMismatch
from trochia.messages import Ack, Release, Seen, ShowPath, Take, Watch, decode_told, encode, unpack
from trochia.messages.command import EmergencyStop, Jog, JogStop, Load, Run
from trochia.messages.status import SCHEMA_VERSION

if TYPE_CHECKING:
    from collections.abc import Callable

    from websockets.asyncio.client import ClientConnection

    from trochia.messages import AnyCommand, Frame, SessionStatus, Status

PATIENCE = 60.0  #: for an answer: a long program is planned before it is loaded [s]
SEEN_EVERY = 4  #: statuses between two words that they have arrived
RENEW = 0.04  #: between renewals of a jog [s]
FRAMES = 64  #: of samples that are kept until they are taken
RESTS = frozenset({"idle", "off", "alarm", "estop"})  #: states in which no program is under way


class Refused(LinkError):  # noqa: N818 - it is an answer, not a fault
    """A command that was not taken; ``ack`` is the answer, with what is legal now."""

    code = "refused"

    def __init__(self, ack: Ack) -> None:
        super().__init__(ack.reason, hint=f"Legal now: {', '.join(ack.legal)}." if ack.legal else None)
        self.ack = ack


class AsyncClient:
    """One session at a machine; made by :meth:`connect`.

    Attributes
    ----------
    status
        The newest.
    session
        Who one is: ``session.control`` says whether one may move the machine.
    frames
        Frames of samples that have arrived and nobody has taken, at most :data:`FRAMES`.
    received
        How many statuses have arrived.
    """

    def __init__(self, socket: ClientConnection) -> None:
        self.status: Status | None = None
        self.session: SessionStatus | None = None
        self.frames: deque[Frame] = deque(maxlen=FRAMES)
        self.received = 0
        self._socket = socket
        self._numbers = itertools.count(1)
        self._answers: dict[int, asyncio.Future[Ack]] = {}
        self._path: Frame | None = None
        self._unsaid = 0  # statuses that have arrived since the server was told
        self._news = asyncio.Condition()
        self._lost: LinkError | None = None
        self._reader = asyncio.create_task(self._read())

    @classmethod
    async def connect(cls, url: str, user: str, password: str) -> Self:
        """Log in at ``url`` (``http://host:port``) and connect.

        Raises
        ------
        LinkError
            When nobody answers there, or name and password are not taken.
        VersionMismatch
            When the server speaks a newer schema.
        """
        cookie = await asyncio.to_thread(login, url.rstrip("/"), user, password)
        address = "ws" + url.rstrip("/").removeprefix("http") + "/api/socket"
        try:
            socket = await open_socket(address, additional_headers={"Cookie": cookie}, compression=None,
                                       max_size=None, proxy=None)  # fmt: skip
        except (OSError, InvalidStatus, InvalidHandshake, TimeoutError) as error:
            raise LinkError(f"no connection to {url}: {error}") from error
        client = cls(socket)
        try:
            status = await client.wait_until(lambda _: True, timeout=10.0)
        except LinkError:
            await client.close()
            raise
        if status.schema > SCHEMA_VERSION:
            await client.close()
            raise VersionMismatch(f"the server speaks schema {status.schema}, this client {SCHEMA_VERSION}")
        return client

    async def close(self) -> None:
        """Disconnect; a program that runs goes on, a jog ends."""
        await self._socket.close()
        await self._reader

    async def __aenter__(self) -> Self:
        """Return itself."""
        return self

    async def __aexit__(self, *_: object) -> None:
        """Disconnect."""
        await self.close()

    # -- asking

    async def command(self, command: AnyCommand, *, timeout: float = PATIENCE) -> Ack:  # noqa: ASYNC109 - part of the face
        """Have a command taken, and return the answer; every status that comes later shows what it did.

        Raises
        ------
        Refused
            When it was not taken, by the machine or because one has no control.
        LinkError
            When the connection is lost, or no answer comes in time.
        """
        return await self._ask(command, timeout)

    async def take(self, *, over: bool = False) -> None:
        """Become the one who may move the machine; ``over`` takes that from whoever has it.

        Raises
        ------
        Refused
            When somebody else has it, or one is a viewer.
        """
        await self._ask(Take(over=over), PATIENCE)

    async def release(self) -> None:
        """Be no longer the one who may move the machine."""
        await self._ask(Release(), PATIENCE)

    async def stop(self) -> None:
        """Stop everything now; for everybody."""
        await self._ask(EmergencyStop(), PATIENCE)

    async def watch(self, *, samples: bool) -> None:
        """Have samples of every turn of the controller put into ``frames``, or no more."""
        await self._ask(Watch(samples=samples), PATIENCE)

    async def path(self, points: int = 200_000) -> Frame:
        """Return the path of the loaded program: columns ``points`` (n, axes), ``lines`` (n,), ``rapid`` (n,)."""
        await self._ask(ShowPath(points=points), PATIENCE)
        if self._path is None:
            raise RemoteProtocolError("the server answered, and sent no path")
        return self._path

    async def jog(self, axis: str, speed: float, seconds: float) -> None:
        """Move an axis for a while [signed mm/s or degree/s], renewing the lease; returns when it was told to stop."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0.0:
            if self.status is not None:
                await self._send(encode(Seen(sequence=self.status.sequence)))
            await self.command(Jog(axis=axis, speed=speed))
            await asyncio.sleep(min(RENEW, left))
        if self.status is not None and "jog-stop" in self.status.legal:
            with contextlib.suppress(Refused):  # it may have come to the end of its travel by itself
                await self.command(JogStop())

    async def wait_until(
        self, wanted: str | Callable[[Status], bool], *, timeout: float | None = None  # noqa: ASYNC109 - part of the face
    ) -> Status:  # fmt: skip
        """Return the first status, from the newest one on, that is wanted: a state's name, or a condition.

        Raises
        ------
        LinkTimeout
            When there is none in time.
        LinkError
            When the connection is lost.
        """

        def right() -> bool:
            status = self.status
            if status is None:
                return self._lost is not None
            return self._lost is not None or (status.state == wanted if isinstance(wanted, str) else wanted(status))

        try:
            async with asyncio.timeout(timeout), self._news:
                await self._news.wait_for(right)
        except TimeoutError:
            state = "unknown" if self.status is None else self.status.state
            what = repr(wanted) if isinstance(wanted, str) else "what was waited for"
            raise LinkTimeout(f"{what} has not come in {timeout:g} s; the state is {state}") from None
        if self._lost is not None or self.status is None:
            raise self._lost or LinkError("the connection is lost")
        return self.status

    async def run(self, name: str, text: str, *, timeout: float | None = None) -> Status:  # noqa: ASYNC109 - part of the face
        """Load a program, run it, and return the status at its end: idle, or what stopped it.

        A hold, a pause or a tool change is not its end; somebody has to resume.
        """
        await self.command(Load(name=name, text=text))
        await self.command(Run())
        return await self.wait_for_new(lambda status: status.state in RESTS, timeout=timeout)

    async def wait_for_new(
        self, wanted: Callable[[Status], bool], *, timeout: float | None = None  # noqa: ASYNC109 - part of the face
    ) -> Status:  # fmt: skip
        """Return the first status that is wanted of those that come from now on."""
        last = -1 if self.status is None else self.status.sequence
        return await self.wait_until(lambda status: status.sequence > last and wanted(status), timeout=timeout)

    # -- inside

    async def _ask(self, asked: AnyCommand | Release | ShowPath | Take | Watch, patience: float) -> Ack:
        number = next(self._numbers)
        answer: asyncio.Future[Ack] = asyncio.get_running_loop().create_future()
        self._answers[number] = answer
        try:
            await self._send(encode(msgspec.structs.replace(asked, id=number)))
            async with asyncio.timeout(patience):
                ack = await answer
        except TimeoutError:
            raise LinkTimeout(f"no answer in {patience:g} s") from None
        finally:
            del self._answers[number]
        if not ack.ok:
            raise Refused(ack)
        return ack

    async def _send(self, message: bytes) -> None:
        if self._lost is not None:
            raise self._lost
        try:
            await self._socket.send(message.decode())
        except WebSocketException as error:
            raise LinkError(f"the connection is lost: {error}") from error

    async def _read(self) -> None:
        try:
            async for message in self._socket:
                await self._take(message)
            self._lost = LinkError("the connection was closed")
        except (WebSocketException, RemoteProtocolError, OSError) as error:
            self._lost = LinkError(f"the connection is lost: {error}")
        for answer in self._answers.values():
            if not answer.done():
                answer.set_exception(self._lost)
        async with self._news:
            self._news.notify_all()

    async def _take(self, message: str | bytes) -> None:
        if isinstance(message, bytes):
            frame = unpack(message)
            if frame.head.kind == "path":
                self._path = frame
            else:
                self.frames.append(frame)
            return
        told = decode_told(message)
        if told.session is not None:
            self.session = told.session
        if told.ack is not None:
            answer = self._answers.get(told.ack.id)
            if answer is not None and not answer.done():
                answer.set_result(told.ack)
        if told.status is not None:
            self.status = told.status
            self.received += 1
            self._unsaid += 1
            if self._unsaid >= SEEN_EVERY:
                self._unsaid = 0
                await self._socket.send(encode(Seen(sequence=told.status.sequence)).decode())
            async with self._news:
                self._news.notify_all()
