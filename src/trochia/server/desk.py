"""What every connection shares: one machine, who is in, who may move it, and the log.

In: commands of sessions.  Out: their answers, from the controller, or why they were refused here.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import msgspec

from trochia.errors import ConfigError
from trochia.messages import Ack, SessionStatus, encode
from trochia.messages.command import EmergencyStop, Jog, Load
from trochia.server.audit import Audit
from trochia.server.authority import Authority
from trochia.server.hub import Hub
from trochia.server.samples import Samples
from trochia.server.sessions import Sessions
from trochia.server.throttle import Throttle

if TYPE_CHECKING:
    from collections.abc import Callable
    from concurrent.futures import Future
    from pathlib import Path

    from trochia.backends.live import Report
    from trochia.controller.runtime import Runtime
    from trochia.messages import AnyCommand, Status
    from trochia.server.doors import Doors
    from trochia.server.sessions import Session
    from trochia.server.users import Users

LEASE = 0.13  #: longest of a jog from a distance [s]: with a turn, an order and the link the axis brakes within 0.15
STALE = 0.25  #: a jog from who has seen no status younger than this is refused [s]


class Desk:
    """One machine as it is served.

    Parameters
    ----------
    log
        Folder of the log of who asked for what; None: it is not kept.
    """

    def __init__(self, runtime: Runtime, users: Users, doors: Doors, *, log: Path | None = None) -> None:
        self.runtime = runtime
        self.users = users
        self.doors = doors
        self.sessions = Sessions(time.monotonic)
        self.throttle = Throttle()
        self.authority = Authority()
        self.audit = Audit(log)
        self.hub = Hub(runtime.status)
        self.samples = Samples(runtime.backend.machine)
        self._users_changed = 0  # when, as far as has been looked at
        self._changed: set[Callable[[], None]] = set()  # who wants to know when control changes hands
        runtime.watchers.append(self._turned)

    def close(self) -> None:
        """Take no more from the runtime, and bring the log to the disk."""
        self.runtime.watchers.remove(self._turned)
        self.hub.end()
        self.audit.close()

    def _turned(self, status: Status, report: Report) -> None:
        """Take a turn's status and report; in the controller's thread."""
        self.samples.add(report)
        if status.sequence != self.hub.sequence:
            self.hub.give(status)

    # -- control

    def who(self, session: Session) -> SessionStatus:
        """Return who a session is to the machine."""
        holder = self.authority.holder
        return SessionStatus(user=session.user, role=session.role, control=holder is session,
                             holder="" if holder is None else holder.user)  # fmt: skip

    def take(self, session: Session, *, over: bool) -> str:
        """Give control to a session; return why not."""
        before = self.authority.holder
        refused = self.authority.take(session, over=over)
        lost = "" if before is None or before is session else before.user
        self.audit.note(
            "refused" if refused else "take", session, session.address, over=over, reason=refused, lost=lost
        )
        self._control_changed()
        return refused

    def release(self, session: Session) -> None:
        """Let nobody have control, if this session has it."""
        self.authority.release(session)
        self.audit.note("release", session, session.address)
        self._control_changed()

    def leave(self, session: Session) -> None:
        """End a session."""
        self.authority.release(session)
        self.sessions.close(session)
        self.audit.note("logout", session, session.address)
        self._control_changed()

    def look_at_users(self) -> None:
        """End the sessions of users who are gone, or have another role or password; when the file has changed."""
        try:
            changed = self.users.path.stat().st_mtime_ns
            if changed == self._users_changed:
                return
            known = {user.name: user for user in self.users.all()}
        except (OSError, ConfigError):
            return  # nobody can log in now either; those who are in stay
        self._users_changed = changed
        for session in self.sessions.all():
            user = known.get(session.user)
            if user is None or (user.key, user.role) != (session.key, session.role):
                self.leave(session)

    def join(self, changed: Callable[[], None]) -> None:
        """Call ``changed`` whenever control changes hands or a session ends."""
        self._changed.add(changed)

    def part(self, changed: Callable[[], None]) -> None:
        """Do so no more."""
        self._changed.discard(changed)

    def _control_changed(self) -> None:
        for changed in tuple(self._changed):
            changed()

    # -- commands

    def command(
        self, session: Session, command: AnyCommand, answered: Callable[[Ack], None], *, age: float = 0.0
    ) -> None:
        """Have a command taken, or refuse it; ``answered`` is called once, maybe from the controller's thread.

        Parameters
        ----------
        age
            Of the last status its sender has seen [s]: whoever does not see the machine move cannot jog it.
        """
        refused = self.authority.refusal(session, command)
        if not refused and isinstance(command, Jog):
            command = msgspec.structs.replace(command, lease=min(command.lease, LEASE))
            if age > STALE:
                refused = "this jog comes too late: its sender has not seen the machine's newest status"
        if refused:
            self._log(session, command, refused)
            answered(Ack(id=command.id, ok=False, reason=refused))
            return
        renewal = isinstance(command, Jog) and self.hub.latest.state == "jogging"

        def done(future: Future[Ack]) -> None:
            ack = future.result()
            if not (renewal and ack.ok):
                self._log(session, command, ack.reason)
            answered(ack)

        self.runtime.send(command).add_done_callback(done)

    def _log(self, session: Session, command: AnyCommand, refused: str) -> None:
        if isinstance(command, Load):
            text = f"load {command.name}, {len(command.text)} characters"
        else:
            text = encode(command).decode()
        stop = {"stop": True} if isinstance(command, EmergencyStop) else {}
        self.audit.note("refused" if refused else "command", session, session.address, command=text, reason=refused,
                        **stop)  # fmt: skip
