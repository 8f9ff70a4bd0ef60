"""Real-time bytes: they act as they come, whatever waits.  In: a byte.  Out: commands to the controller."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.backends.grbl.overrides import stepped
from trochia.messages import command as c

if TYPE_CHECKING:
    from trochia.gateways.grbl.session import Session

_RAPID = {0x95: 1.0, 0x96: 0.5, 0x97: 0.25}
_FEED, _SPINDLE = range(0x90, 0x95), range(0x99, 0x9E)
_DOOR, _JOG_CANCEL, _RESET = 0x84, 0x85, 0x18


class Realtime:
    """Takes the real-time bytes of one session."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._feed = self._spindle = 100  # percent

    def take(self, byte: int) -> bool:
        """Act on a byte; return whether it was one of these.  Bytes above 127 that mean nothing are dropped."""
        session = self._session
        if byte == _RESET:
            self._feed = self._spindle = 100
            session.ask(c.Override(feed=1.0, rapid=1.0, spindle=1.0))
            session.reset()
        elif byte == ord("?"):
            session.report()
        elif byte in {ord("!"), _DOOR}:
            self._hold()
        elif byte == ord("~"):
            session.held = False
            if session.status.state == "held":
                session.ask(c.Resume())
        elif byte == _JOG_CANCEL:
            session.drop_jogs()
            if session.status.state == "jogging":
                session.ask(c.JogStop())
        elif byte < 0x80:
            return False
        else:
            self._override(byte)
        return True

    def _hold(self) -> None:
        session = self._session
        if session.status.state == "jogging":
            session.drop_jogs()
            session.ask(c.JogStop())
        elif session.busy or session.unread:
            session.held = session.status.state in {"idle", "off"}  # what waits does not begin
            session.ask(c.Hold())

    def _override(self, byte: int) -> None:
        session = self._session
        if byte in _RAPID:
            session.ask(c.Override(rapid=_RAPID[byte]))
        elif byte in _FEED:
            self._feed = stepped(self._feed, byte) or self._feed
            session.ask(c.Override(feed=self._feed / 100.0))
        elif byte in _SPINDLE:
            self._spindle = stepped(self._spindle, byte) or self._spindle
            session.ask(c.Override(spindle=self._spindle / 100.0))
