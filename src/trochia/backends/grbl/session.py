"""One connection to a GRBL 1.1 board, without a port and without a clock: bytes in, bytes out, what is known.

It sends only what fits the board's receive buffer.  A refused line, noise amid a job, a restart, a lost answer or
silence end the job: hold, reset at rest, and a fault that names the line.  States are those of :mod:`.links`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.backends.grbl import codes
from trochia.backends.grbl.links import TABLE, Link, Seen
from trochia.backends.grbl.replies import Alarm, Error, Noise, Ok, Setting, StatusLine, Told, Welcome, parse
from trochia.backends.grbl.stream import HOMING, Stream
from trochia.backends.grbl.view import INCH, View
from trochia.backends.program import Doing
from trochia.languages.gcode.write import Line
from trochia.messages import Cause, Fault

if TYPE_CHECKING:
    from trochia.backends.grbl.replies import Reply

HOLD, RESUME, RESET, STATUS, JOG_CANCEL = b"!", b"~", b"\x18", b"?", b"\x85"
QUESTIONS = ("$I", "$$", "$#", "$G", "$N")  #: asked at connection, in this order
POLL = 0.1  #: between status queries [s]
SILENCE = 1.5  #: without a word the board counts as gone [s]
PATIENCE = 4.0  #: for the first word, and for the welcome after a reset [s]
UNANSWERED = 2.0  #: idle for so long with lines that have no answer [s]
MOST_ASKS = 3  #: times all questions are asked again
MOST_LINE = 400  #: a line longer than this is noise
_CABLE = "Look at the cable, the supply and the baud rate ($I answers at the right one), then connect again."
_MOVING = frozenset({Doing.RUN, Doing.JOG, Doing.HOME})


class Session:
    """One board.

    Attributes
    ----------
    link
        State of the connection.
    settings, told
        ``$100`` and the like, and what stands in brackets by its name (``G54``, ``VER``, ``GC``).
    faults
        Until acknowledged.
    """

    def __init__(self, now: float, *, baud: int | None = None) -> None:
        self.link = Link.CONNECTING
        self.view, self.stream = View(), Stream()
        self.settings: dict[str, str] = {}
        self.told: dict[str, str] = {}
        self.version = ""
        self.alarm = 0  # number of the alarm the board is in
        self.faults: list[Fault] = []
        self._baud = baud
        self._out = bytearray()
        self._partial = bytearray()
        self._began = self._heard = self._polled = self._idle_since = now
        self._noise = 0
        self._again = False  # connected before: what still moves is ours to end
        self._asked: list[str] = []
        self._asked_at, self._asks = now, 0
        self._after: list[str] = []  # lines to send once a reset is over
        self._now = now

    # -- bytes

    def receive(self, data: bytes, now: float) -> None:
        """Take what the board has said."""
        self._now = now
        if data:
            self._heard = now
        self._partial += data
        *lines, rest = self._partial.replace(b"\r", b"").split(b"\n")
        self._partial = bytearray(rest)
        if len(rest) > MOST_LINE:
            lines, self._partial = [*lines, rest], bytearray()
        for line in lines:
            text = bytes(line).decode("latin-1")
            if text:
                self._take(parse(text))

    def turn(self, now: float) -> bytes:
        """Return what to send now: questions of status, and lines as there is room."""
        self._now = now
        if not self.stream.sent:
            self._idle_since = now
        if self.link is not Link.LOST:
            self._watch()
        if self.link is Link.LOST:
            self._out.clear()
            return b""
        if now - self._polled >= POLL:
            self._polled = now
            self._out += STATUS
        if self.link in {Link.ASKING, Link.READY}:
            self._out += self.stream.more()
        data = bytes(self._out)
        self._out.clear()
        return data

    # -- what is asked

    def say(self, data: bytes) -> None:
        """Send real-time bytes, ahead of all lines."""
        self._out[:0] = data

    def stop(self) -> None:
        """Hold, and reset at rest: the job is given up, the position stays known."""
        if self._go(Seen.STOP):
            self.stream.waiting.clear()
            self.say(HOLD)

    def reset(self, *after: str) -> None:
        """Reset now; lines to send once the board is back."""
        if self._go(Seen.RESET):
            self._reset()
            self._after = list(after)

    def cut(self, why: str, remedy: str = _CABLE) -> None:
        """Note that nobody is at the other end."""
        if self._go(Seen.CUT):
            self._fault(Cause.LINK, why, remedy)
            self.stream.clear()
            self.view.doing = Doing.LOST

    def again(self, now: float) -> None:
        """Begin to connect anew; whatever still moves is held first."""
        if self._go(Seen.AGAIN):
            self._again = True
            self._began = self._heard = self._polled = now
            self._noise = 0
            self._partial.clear()
            self._out.clear()
            self.view.doing = Doing.CONNECTING
            self.say(HOLD)

    # -- what is heard

    def _take(self, reply: Reply) -> None:
        match reply:
            case Ok():
                self._answer(taken=True)
            case Error(number=number):
                self._refused(number, self._answer(taken=False))
            case Alarm(number=number):
                self._alarmed(number)
            case Welcome(version=version):
                self._welcome(version)
            case Setting(name=name, value=value):
                self.settings[name] = value
                self.view.unit = INCH if self.settings.get("$13") == "1" else 1.0
            case Told(name=name, value=value):
                self.told[name] = value
                if name == "OPT":
                    self._options(value)
            case StatusLine():
                self._status(reply)
            case Noise(text=text):
                self._garbage(text)

    def _answer(self, *, taken: bool) -> Line | None:
        line = self.stream.answered(taken=taken)
        if self.link is Link.ASKING and self._asked:
            self._asked.pop(0)
            if not self._asked:
                self._go(Seen.ANSWERED)
        return line

    def _refused(self, number: int, line: Line | None) -> None:
        if self.link is Link.ASKING:
            if number == 8:  # in motion for somebody else: leave it alone
                self.cut("the board is busy with somebody else's job", "Wait for its end, or close the other program.")
            return
        if self.link is not Link.READY:
            return  # what follows a refused line is dropped by the reset
        meaning = codes.error(number)
        text = f"error {number}: {meaning.sentence}" + (f" ({line.text})" if line else "")
        self._fault(meaning.cause, text, meaning.remedy, line.source if line else 0)
        if line is not None and not line.text.startswith("$"):
            self.stop()

    def _alarmed(self, number: int) -> None:
        meaning = codes.alarm(number)
        self.alarm = number
        self.view.doing = Doing.ALARM
        self._fault(meaning.cause, f"alarm {number}: {meaning.sentence}", meaning.remedy, self.stream.line)
        self.stream.clear()

    def _welcome(self, version: str) -> None:
        self.version = version
        was = self.link
        if was is Link.READY:
            self._fault(Cause.LINK, "the board restarted by itself; its position is lost",
                        "Look at its supply and its reset button, then home.", self.stream.line)  # fmt: skip
        self.stream.clear()
        if not self._go(Seen.WELCOME):
            return
        if self.link is Link.ASKING:
            self._ask()
        else:
            self.stream.add(Line(text, 0) for text in self._after)
        self._after = []

    def _status(self, status: StatusLine) -> None:
        self.view.take(status)
        if self.link is Link.CONNECTING:
            self._first(self.view.doing)
        idle = self.view.doing in {Doing.IDLE, Doing.CHECK}
        if not idle:
            self._idle_since = self._now
        if self.view.doing is not Doing.ALARM:
            self.alarm = 0
        self.stream.reported(self.view.free, idle=idle)
        still = self.view.resting and self.view.doing not in _MOVING
        if self.link is Link.STOPPING and still and self._go(Seen.STILL):
            self._reset()

    def _first(self, doing: Doing) -> None:
        """Begin to ask; where a job of ours is still held from before, end it first."""
        if not self._again or doing in {Doing.IDLE, Doing.ALARM, Doing.CHECK, Doing.SLEEP}:
            self._go(Seen.STATUS)
            self._ask()
        elif self.view.resting and doing not in _MOVING:
            self.say(RESET)  # its welcome goes on

    def _garbage(self, text: str) -> None:
        self._noise += 1
        if self.link is Link.READY and not self.stream.done:
            self._fault(Cause.LINK, f"the board said what GRBL does not say: {text[:40]!r}", _CABLE, self.stream.line)
            self.stop()

    def _options(self, value: str) -> None:
        """Take the sizes of the board's buffers: letters, planner blocks, bytes."""
        parts = value.split(",")
        if len(parts) >= 3 and parts[1].isdigit() and parts[2].isdigit():
            self.stream.blocks, self.stream.receive = int(parts[1]), int(parts[2])

    # -- inside

    def _ask(self) -> None:
        self._asked = list(QUESTIONS)
        self._asked_at = self._now
        self.stream.clear()
        self.stream.add(Line(text, 0) for text in QUESTIONS)

    def _reset(self) -> None:
        self.stream.clear()
        self._began = self._now
        self.say(RESET)

    def _watch(self) -> None:
        """See to what does not come."""
        now = self._now
        if self.link is Link.CONNECTING and now - self._began > PATIENCE:
            at = f" at {self._baud} baud" if self._baud else ""
            if self._noise or self._partial:
                self.cut(
                    f"what answers does not speak GRBL 1.1{at}", "Try another baud rate (115200 is usual) or port."
                )
            else:
                self.cut(f"nothing answers{at}", "Look at the port's name, the cable and the board's supply.")
        elif self.link is Link.RESETTING and now - self._began > PATIENCE:
            self.cut("the board did not come back from its reset")
        elif self.link in {Link.READY, Link.STOPPING, Link.ASKING} and now - self._heard > self._silence():
            self.cut(f"the board has been silent for {now - self._heard:.1f} s; it ends by itself what it had taken")
        elif self.link is Link.ASKING and now - self._asked_at > UNANSWERED:
            self._ask()  # an answer was lost, or never came: ask all of it again
            self._asks += 1
            if self._asks > MOST_ASKS:
                self.cut("the board does not answer $I, $$, $#, $G and $N in GRBL's way")
        elif self.link is Link.READY and now - self._idle_since > UNANSWERED + self.stream.dwell:
            line = self.stream.sent[0]
            self._idle_since = now
            self._fault(Cause.LINK, f"no answer came to {line.text!r}", _CABLE, line.source)
            self.stop()

    def _silence(self) -> float:
        """Return how long the board may say nothing [s]: while it homes it answers nobody."""
        return HOMING if self.stream.homing else SILENCE

    def _go(self, seen: Seen) -> bool:
        """Change the state, if the table has a row for it."""
        target = TABLE.get((self.link, seen))
        if target is None or (target is Link.LOST and self.link is Link.LOST):
            return False
        self.link = target
        return True

    def _fault(self, cause: Cause, message: str, remedy: str, line: int = 0) -> None:
        if any(fault.cause is cause and fault.message == message for fault in self.faults):
            return
        self.faults.append(Fault(cause=cause, time=self._now, message=message, remedy=remedy, line=line))
