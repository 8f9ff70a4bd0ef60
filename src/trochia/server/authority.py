"""Who may move the machine: one session at a time.  In: sessions and what they ask.  Out: why not, or nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.messages.command import EmergencyStop

if TYPE_CHECKING:
    from trochia.messages import AnyCommand
    from trochia.server.sessions import Session


class Authority:
    """The one operator's token."""

    def __init__(self) -> None:
        self._holder: Session | None = None

    @property
    def holder(self) -> Session | None:
        """The session that may move the machine."""
        if self._holder is not None and self._holder.over:
            self._holder = None
        return self._holder

    def take(self, session: Session, *, over: bool) -> str:
        """Give control to a session, and return why not; empty: it has control now."""
        if session.role != "operator":
            return "viewers cannot take control"
        holder = self.holder
        if holder is not None and holder is not session and not over:
            return f"{holder.user} has control; take it over if you must"
        self._holder = session
        return ""

    def release(self, session: Session) -> None:
        """Let nobody have control, if this session has it."""
        if self._holder is session:
            self._holder = None

    def refusal(self, session: Session, command: AnyCommand) -> str:
        """Return why a session may not give a command; empty: it may.  STOP is everybody's."""
        if isinstance(command, EmergencyStop):
            return ""
        if session.role != "operator":
            return "viewers watch, and may press STOP"
        holder = self.holder
        if holder is None:
            return "nobody has control; take it first"
        return "" if holder is session else f"{holder.user} has control; take it over first"
