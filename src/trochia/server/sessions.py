"""Who is in.  In: users who have shown their password.  Out: secret tokens, and the session of a token."""

from __future__ import annotations

import hashlib
import secrets
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.messages import Role
    from trochia.server.users import User

IDLE = 12 * 3600.0  #: a session ends when it was not used for so long [s]
MOST = 64  #: sessions at a time; the one idle longest makes room


@dataclass(slots=True, kw_only=True, eq=False)
class Session:
    """One login.

    Attributes
    ----------
    number
        Counts logins, for the log.
    key
        Of the password it was opened by.
    address
        Where it came from.
    used
        When it was used last [s].
    """

    number: int
    user: str
    role: Role
    key: bytes
    address: str
    used: float
    over: bool = False


class Sessions:
    """All that are open; tokens are kept as digests only.

    Parameters
    ----------
    clock
        A steady one [s].
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._open: dict[bytes, Session] = {}
        self._count = 0

    def open(self, user: User, address: str) -> tuple[str, Session]:
        """Return the token of a new session, and the session."""
        self._sweep()
        self._count += 1
        token = secrets.token_urlsafe(32)
        session = Session(number=self._count, user=user.name, role=user.role, key=user.key, address=address,
                          used=self._clock())  # fmt: skip
        self._open[_digest(token)] = session
        return token, session

    def of(self, token: str) -> Session | None:
        """Return the session of a token, and note that it is in use; None when there is none, or it has ended."""
        session = self._open.get(_digest(token))
        if session is None or not self.alive(session):
            return None
        session.used = self._clock()
        return session

    def all(self) -> tuple[Session, ...]:
        """Return those that are open."""
        return tuple(session for session in self._open.values() if self.alive(session))

    def alive(self, session: Session) -> bool:
        """Whether a session has neither been closed nor grown too old."""
        return not session.over and self._clock() - session.used < IDLE

    def close(self, session: Session) -> None:
        """End a session; its token opens nothing any more."""
        session.over = True
        self._sweep()

    def _sweep(self) -> None:
        for digest in [digest for digest, session in self._open.items() if not self.alive(session)]:
            self._open.pop(digest).over = True
        while len(self._open) >= MOST:
            oldest = min(self._open, key=lambda digest: self._open[digest].used)
            self._open.pop(oldest).over = True


def _digest(token: str) -> bytes:
    return hashlib.sha256(token.encode("utf-8", "surrogatepass")).digest()
