"""One sender's connection, without a port and without a clock: bytes in, commands to the controller, bytes out.

Real-time bytes act at once, ahead of all lines.  A line is answered when it has been read and has found room to wait;
what the controller refuses later, as motion beyond the travel, is an alarm that drops what waits.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.gateways.grbl import commands
from trochia.gateways.grbl.modes import WIDTH, Modes, Refused, plain
from trochia.gateways.grbl.queue import MOST, Home, Jog, Queue, Text, Words
from trochia.gateways.grbl.realtime import Realtime
from trochia.gateways.grbl.reports import ALARMS, LETTERS, OTHER, STATES, Reporter, machine_position, origin_of
from trochia.messages import command as c

if TYPE_CHECKING:
    from collections.abc import Callable
    from concurrent.futures import Future

    from trochia.controller.runtime import Runtime
    from trochia.messages import Ack, AnyCommand, Status

WELCOME = "Grbl 1.1h ['$' for help]"
LOCKED = "[MSG:'$H'|'$X' to unlock]"
RECEIVE = 128  #: bytes a sender may have on the way


class Session:
    """One sender.

    Parameters
    ----------
    arm
        Whether lines may light the beam.

    Attributes
    ----------
    locked
        Lines are refused until the machine is homed or unlocked.
    checking
        Lines are read and moved nowhere ($C).
    """

    def __init__(self, runtime: Runtime, *, arm: bool = False) -> None:
        self.runtime = runtime
        self.modes, self.queue, self.reporter = Modes(user=runtime.controller.hooked), Queue(), Reporter()
        self.locked = any(not axis.trusted for axis in runtime.status.axes)
        self.checking = False
        self.held = False
        self.jog_ends: dict[str, float] | None = None  # where the last jog that waits or runs ends, {axis: mm}
        self.text: Text | None = None
        self.realtime = Realtime(self)
        self._out = bytearray()
        self._line = bytearray()
        self._waiting: list[bytes] = []  # lines for which there is no room yet
        self._pending: tuple[Future[Ack], Callable[[Ack], None]] | None = None
        self._homing = self._resetting = self._alarmed = False
        self._planned = False  # the text is loaded, and may begin
        self._started = self._returned = False
        self._now = 0.0
        if runtime.status.state == "off":
            self.ask(c.Enable())
        if arm:
            self.ask(c.ArmBeam(on=True))
        self.say(WELCOME)
        if self.locked:
            self.say(LOCKED)

    # -- bytes

    def receive(self, data: bytes, now: float) -> None:
        """Take what the sender says."""
        self._now = now
        for byte in data:
            if self.realtime.take(byte):
                continue
            after_return, self._returned = self._returned, byte == ord("\r")
            if byte == ord("\n") and after_return:
                continue  # the second half of one line's end
            if byte in b"\r\n":
                self._waiting.append(bytes(self._line))
                self._line.clear()
            elif len(self._line) <= WIDTH:
                self._line.append(byte)
        self._lines()

    def turn(self, now: float) -> bytes:
        """Do what is due, and return what to say."""
        self._now = now
        self._answers()
        self._follow()
        self._begin()
        self._lines()
        data = bytes(self._out)
        self._out.clear()
        return data

    def say(self, text: str) -> None:
        """Say a line."""
        self._out += text.encode("ascii", "replace") + b"\r\n"

    def ask(self, command: AnyCommand) -> None:
        """Have the controller do something whose answer does not matter here: legal or without effect."""
        self.runtime.send(command)

    @property
    def status(self) -> Status:
        """Of the machine."""
        return self.runtime.status

    @property
    def busy(self) -> bool:
        """Whether something waits or is under way."""
        return bool(self.queue.items) or self._pending is not None or self.text is not None or self._homing

    @property
    def unread(self) -> bool:
        """Whether lines have come that have not been read."""
        return bool(self._waiting)

    # -- what real-time bytes ask

    def report(self) -> None:
        """Say how things stand."""
        status = self.status
        origin = origin_of(self.runtime.controller.work, int(self.modes.codes["system"][1:]) - 53)
        free = max(MOST - self._left(status), 0), RECEIVE - min(sum(map(len, self._waiting)), RECEIVE)
        self.say(self.reporter.line(status, self._state(status), origin, free, self._number(status)))

    def reset(self) -> None:
        """Give up everything; the welcome comes when motion is at rest, and the position stays known."""
        self.queue.items.clear()
        self._waiting.clear()
        self._line.clear()
        self.held = self.checking = False
        self._homing = self._planned = False
        self.modes = Modes(user=self.runtime.controller.hooked)
        if "abort" in self.status.legal:
            self.ask(c.Abort())
        self._resetting = True

    def unlock(self) -> None:
        """Take note of alarms; power on."""
        if self.status.state == "estop":
            self.ask(c.Reset())
        self.ask(c.Acknowledge())
        if self.status.state in {"off", "estop"}:
            self.ask(c.Enable())
        self.locked = self._alarmed = False

    def drop_jogs(self) -> None:
        """Forget jogs that wait."""
        while self.queue.items and isinstance(self.queue.items[-1], Jog):
            self.queue.items.pop()
        self.jog_ends = None

    def at_rest(self) -> bool:
        """Whether nothing moves and nothing waits: GRBL's Idle."""
        return not self.busy and self.status.state in {"idle", "off", "alarm"}

    # -- lines

    def _lines(self) -> None:
        while self._waiting and not self.queue.full and not self._homing and not self._resetting:
            raw = self._waiting.pop(0)
            try:
                if len(raw) > WIDTH:
                    raise Refused(11)  # noqa: TRY301 - answered like any other
                owed = self._take(plain(raw.decode("latin-1")))
            except Refused as refused:
                self.say(f"error:{refused.number}")
            else:
                if not owed:
                    self.say("ok")

    def _take(self, line: str) -> bool:
        """Take a line; return whether its answer is owed until later."""
        if line.startswith("$"):
            return commands.run(self, line, self._now)
        if not line:
            return False
        if self._refusing() or self.status.state == "jogging":
            raise Refused(9)
        if set("XYZ") & set(line) and any(not axis.trusted for axis in self.status.axes):
            self.say("[MSG:home the machine first; unlocked, it takes jogs only]")
            raise Refused(9)
        number = commands.number_of(line)
        before = self.modes.preamble()
        text, stop = self.modes.take(line)
        if text.strip() and not self.checking:
            self.queue.add(Words(text, stop, before, number), self._now)
        return False

    def add(self, item: Jog | Home) -> None:
        """Queue a jog or a search for the reference."""
        self._homing = self._homing or isinstance(item, Home)
        self.queue.add(item, self._now)

    def _refusing(self) -> bool:
        return self.locked or self._alarmed or self.status.state in {"alarm", "estop"}

    # -- the controller

    def _answers(self) -> None:
        if self._pending is None or not self._pending[0].done():
            return
        future, then = self._pending
        self._pending = None
        then(future.result())

    def _follow(self) -> None:
        """See what has come about: the end of a text, an alarm, the end of a reset."""
        state = self.status.state
        if state != "jogging" and not self.queue.items and self._pending is None:
            self.jog_ends = None
        if (
            self.text is not None
            and self._pending is None
            and not self._planned
            and state in {"idle", "off", "alarm", "estop"}
        ):
            self.text = None
        if state in {"alarm", "estop"} and not self._alarmed and self.status.alarms:
            self._alarm(ALARMS.get(self.status.alarms[-1].cause, OTHER), self.status.alarms[-1].message)
        if self.held and state in {"running", "stepping", "resuming", "probing"}:
            self.ask(c.Hold())  # it began while the hold was on its way
        elif self.held and state == "jogging":
            self.held = False
            self.drop_jogs()
            self.ask(c.JogStop())
        if self._resetting and "abort" in self.status.legal:
            self.ask(c.Abort())  # it began while the reset was on its way
        if self._resetting and state in {"idle", "off", "alarm", "estop"} and self._pending is None:
            self._resetting = False
            self.text = None
            self.say(WELCOME)
            if self._refusing():
                self.say(LOCKED)
        if self._homing and self._started and self._pending is None and state == "idle":
            self._homing = self._started = self.locked = False
            self.say("ok")

    def _alarm(self, number: int, text: str) -> None:
        self._alarmed = True
        self._planned = False
        self.queue.items.clear()
        self._waiting.clear()
        self._homing = self._started = False
        self.say(f"ALARM:{number}")
        self.say(f"[MSG:{text.splitlines()[0]}]")

    def _begin(self) -> None:
        """Begin what is next, when the machine is free."""
        free = self.status.state == "idle" and self._pending is None and not self.held
        if free and self._planned and not self._resetting:
            self._planned = False
            self._send(c.Run(), self._checked)
            return
        free = free and self.text is None
        if not free or self._resetting or self._homing is not isinstance(self.queue.items[0] if self.queue.items
                                                                        else None, Home):  # fmt: skip
            return
        if not self.queue.ready(self._now):
            return
        known = all(axis.trusted for axis in self.status.axes)
        match self.queue.next(bounded=not known):
            case Jog(end=end, speed=speed):
                here = dict(zip(LETTERS, machine_position(self.status), strict=True))
                self._send(c.JogBy(way={name: at - here[name] for name, at in end.items()}, speed=speed), self._checked)
            case Home():
                self._started = True
                self._send(c.Home(), self._homed)
            case Text() as text:
                self.text = text
                if known:
                    self._send(c.Load(name="<sender>", text=text.text), self._loaded)
                else:
                    self._send(c.Mdi(text=text.text), self._checked)

    def _send(self, command: AnyCommand, then: Callable[[Ack], None]) -> None:
        self._pending = (self.runtime.send(command), then)

    def _loaded(self, ack: Ack) -> None:
        self._planned = ack.ok and not (self._resetting or self._alarmed)
        if not ack.ok:
            self._checked(ack)

    def _checked(self, ack: Ack) -> None:
        if not ack.ok:
            self.text = None
            self._alarm(2, ack.reason)

    def _homed(self, ack: Ack) -> None:
        if not ack.ok:
            self._homing = self._started = False
            self.say("error:5")

    # -- what is told

    def _state(self, status: Status) -> str:
        if self.checking:
            return "Check"
        if self._alarmed or (self.locked and status.state in {"idle", "off"}):
            return "Home" if self._homing else "Alarm"
        if status.state == "idle" and (self.held or self.busy):
            jogs = self.queue.items and isinstance(self.queue.items[0], Jog)
            return "Hold:0" if self.held else "Jog" if jogs else "Run"
        if status.state == "held" and status.request is not None and status.request.kind == "hook":
            return "Run"  # a program of the machine's own; the job goes on by itself
        return STATES.get(status.state, "Alarm")

    def _left(self, status: Status) -> int:
        """Return how many lines wait or are under way."""
        if self.text is None:
            return len(self.queue.items)
        running = status.program is not None and status.state not in {"idle", "off"}
        done = self.text.done(status.program.line) if running and status.program else 0
        return len(self.queue.items) + len(self.text.lines) - done

    def _number(self, status: Status) -> int:
        if self.text is None or status.program is None:
            return 0
        at = self.text.done(status.program.line)
        return self.text.lines[min(at, len(self.text.lines) - 1)].number
