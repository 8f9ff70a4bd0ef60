"""A GRBL 1.1 board as a program backend: its session on a port."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from trochia.backends.grbl import overrides
from trochia.backends.grbl.codes import CRITICAL
from trochia.backends.grbl.links import Link
from trochia.backends.grbl.session import HOLD, JOG_CANCEL, RESUME, Session
from trochia.backends.program import BoardReport, Doing, Order
from trochia.errors import LinkError, LocalProtocolError
from trochia.languages.gcode.targets import TARGETS
from trochia.languages.gcode.write import Line

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from trochia.backends.grbl.port import Port

_REALTIME = frozenset("!?~\x18")
_BYTES = {Order.HOLD: HOLD, Order.RESUME: RESUME, Order.JOG_STOP: JOG_CANCEL}
_BUSY = frozenset({Doing.RUN, Doing.HOLD, Doing.JOG, Doing.HOME})
_WIDTH = TARGETS["grbl"].width


class GrblBackend:
    """One board.

    Parameters
    ----------
    connect
        Opens its port; called again at every :meth:`open`.
    baud
        For messages only.

    Attributes
    ----------
    session
        What is known of the board.
    """

    kind: ClassVar[str] = "grbl"

    def __init__(self, connect: Callable[[], Port], *, baud: int | None = None) -> None:
        self._connect, self._baud = connect, baud
        self._port: Port | None = None
        self.session = Session(0.0, baud=baud)
        self._fresh = True

    @property
    def settings(self) -> Mapping[str, str]:
        """What the board says about itself: settings, offsets, version, modes."""
        return self.session.settings | self.session.told

    def open(self, now: float) -> BoardReport:
        """Begin to connect, or to connect again."""
        self._port = self._connect()
        if self._fresh:
            self.session = Session(now, baud=self._baud)
        self._fresh = False
        self.session.again(now)
        return self.poll(now)

    def poll(self, now: float) -> BoardReport:
        """Take what has come, send what there is room for, report."""
        if self._port is not None:
            try:
                self.session.receive(self._port.read(), now)
                data = self.session.turn(now)
                if data:
                    self._port.write(data)
            except LinkError as error:
                self.session.cut(error.message)
            if self.session.link is Link.LOST:
                self._port.close()
                self._port = None
        return self._report(now)

    def send(self, lines: Iterable[Line]) -> None:
        """Queue lines."""
        checked = list(lines)
        for line in checked:
            text = line.text
            if not text.isascii() or len(text) > _WIDTH or _REALTIME & set(text) or "\n" in text or not text:
                raise LocalProtocolError(f"GRBL takes lines of 1 to {_WIDTH} plain characters, not {text[:90]!r}")
        self._refuse_unready()
        self.session.stream.add(checked)

    def order(self, order: Order, now: float) -> None:
        """Ask for something now."""
        session = self.session
        if order is Order.ACKNOWLEDGE:
            session.faults.clear()
            return
        if session.link in {Link.LOST, Link.CONNECTING, Link.ASKING}:
            raise LocalProtocolError(f"{order.value} cannot be asked for while the board is {session.link.value}",
                                     hint="Connect first.")  # fmt: skip
        if order in _BYTES:
            session.say(_BYTES[order])
        match order:
            case Order.ABORT:
                session.stop()
            case Order.RESET:
                session.reset()
            case Order.UNLOCK if session.alarm in CRITICAL:
                session.reset("$X")
            case Order.UNLOCK:
                session.stream.add([Line("$X", 0)])
            case Order.HOME:
                session.stream.add([Line("$H", 0)])
            case _:
                pass
        self.poll(now)

    def override(self, *, feed: float = 1.0, rapid: float = 1.0, spindle: float = 1.0) -> None:
        """Scale feed and spindle (10 % to 200 %, to one percent) and rapids (100, 50 or 25 %)."""
        self.session.say(overrides.codes(feed=feed, rapid=rapid, spindle=spindle))

    def jog(self, way: Mapping[str, float], speed: float) -> None:
        """Move axes by a way [mm] at a speed [mm/s]."""
        words = "".join(f"{axis}{value:.4f}" for axis, value in way.items())
        self.send([Line(f"$J=G91G21{words}F{60.0 * speed:.3f}", 0)])

    def close(self) -> None:
        """Hold what moves, and disconnect."""
        if self._port is None:
            return
        try:
            if not self.session.stream.done or self.session.view.doing in {Doing.RUN, Doing.JOG}:
                self._port.write(HOLD)
        except LinkError:
            pass  # nobody is there to hold
        finally:
            self._port.close()
            self._port = None

    def _refuse_unready(self) -> None:
        session = self.session
        if session.link is not Link.READY:
            raise LocalProtocolError(f"the board is {session.link.value}", hint="Wait until it is ready.")
        if session.view.doing is Doing.ALARM:
            raise LocalProtocolError("the board is locked by an alarm", hint="Home it, or unlock it.")

    def _report(self, now: float) -> BoardReport:
        session = self.session
        view, stream = session.view, session.stream
        doing = {Link.LOST: Doing.LOST, Link.CONNECTING: Doing.CONNECTING, Link.ASKING: Doing.CONNECTING}.get(
            session.link, view.doing
        )
        quiet = session.link in {Link.READY, Link.LOST} and doing not in _BUSY
        return BoardReport(
            time=now, doing=doing, position=view.position(), origin=view.origin(), feed=view.feed,
            spindle=view.spindle, line=stream.line, waiting=len(stream.waiting), outstanding=len(stream.sent),
            overrides=view.overrides, inputs=view.inputs, faults=tuple(session.faults), done=quiet and stream.done,
        )  # fmt: skip
