"""A strict model of a GRBL 1.1 board, by its documented protocol: bytes in and time in, bytes out.

It knows nothing of Trochia.  What a real board would suffer in silence is an offence here, kept in ``offences``: a byte
that does not fit the 128 of the receive buffer, a line of more than 79 characters.  Motion is at constant speed: the
protocol is what is modelled, not the planner's speeds.
"""

from __future__ import annotations

import math
import re
from collections import deque
from dataclasses import dataclass, field

from grbl_language import SETTINGS, STARTING, Block, Refused, arc_points, words_of

RECEIVE, BLOCKS, WIDTH = 128, 15, 79


@dataclass
class Board:
    """One board; ``brake`` is how long a hold takes to come to rest [s]."""

    settings: dict[str, str] = field(default_factory=lambda: dict(SETTINGS))
    brake: float = 0.04

    def __post_init__(self) -> None:
        self.out = bytearray()
        self.rx: deque[int] = deque()
        self.now = 0.0
        self.offences: list[str] = []
        self.position = [0.0, 0.0, 0.0]
        self.systems = [[0.0] * 3 for _ in range(6)]
        self.shift = [0.0] * 3
        self.executed: list[tuple[float, float, float]] = []  # ends of moves, as they were reached
        self.lines: list[str] = []
        self.deaf = False
        self._boot()

    def power_up(self) -> None:
        """Start as after power-up."""
        self.position = [0.0, 0.0, 0.0]
        self._boot()

    def _boot(self) -> None:
        self.state = "Alarm" if self.settings["$22"] == "1" else "Idle"
        self.planner: deque[Block] = deque()
        self.chords: deque[Block] = deque()  # of an arc, as there is room
        self.rx.clear()
        self.modes = dict(STARTING)
        self.feed = self.speed = 0.0
        self.target = list(self.position)
        self.over = [100, 100, 100]
        self.held_until = self.busy_until = 0.0
        self.after: str | None = None  # answer owed once the present line is done
        self.stuck = False  # a critical alarm: only a reset helps
        self.paused = False
        self.homing = False
        self._since = 0
        self._say("")
        self._say("Grbl 1.1h ['$' for help]")
        if self.state == "Alarm":
            self._say("[MSG:'$H'|'$X' to unlock]")

    def _say(self, text: str) -> None:
        self.out += text.encode() + b"\r\n"

    # -- bytes

    def feed_bytes(self, data: bytes) -> None:
        """Take bytes as the receive interrupt does."""
        if self.deaf:
            return
        for byte in data:
            if byte in b"?!~\x18" or byte >= 0x80:
                self._realtime(byte)
            elif len(self.rx) >= RECEIVE:
                self.offences.append("receive buffer overflow")
            else:
                self.rx.append(byte)

    def take(self) -> bytes:
        """Return what it says."""
        data = bytes(self.out)
        self.out.clear()
        return data

    def _realtime(self, byte: int) -> None:  # noqa: C901, PLR0912 - one branch a byte
        if byte == 0x18:
            moving = self.state in {"Run", "Jog", "Home"} or (self.state == "Hold" and self.now < self.held_until)
            if moving:
                self._say(f"ALARM:{6 if self.state == 'Home' else 3}")
            locked = moving or self.state == "Alarm"
            self._boot()
            if locked and self.state != "Alarm":
                self.state = "Alarm"
                self._say("[MSG:'$H'|'$X' to unlock]")
        elif byte == ord("?"):
            if not self.homing:
                self._status()
        elif byte == ord("!"):
            if self.state in {"Run", "Jog"}:
                self.held_until = self.now + self.brake
                if self.state == "Jog":
                    self._cancel_jog()
                else:
                    self.state = "Hold"
        elif byte == ord("~"):
            if self.state == "Hold" and self.now >= self.held_until:
                self.paused = False
                self.state = "Run" if self.planner else "Idle"
        elif byte == 0x85 and self.state == "Jog":
            self._cancel_jog()
        else:
            self._override(byte)

    def _cancel_jog(self) -> None:
        self.planner.clear()
        self.target = list(self.position)
        self.state = "Idle"

    def _override(self, byte: int) -> None:
        for row, at in (((0x90, 0x91, 0x92, 0x93, 0x94), 0), ((0x99, 0x9A, 0x9B, 0x9C, 0x9D), 2)):
            if byte in row:
                change = (100 - self.over[at], 10, -10, 1, -1)[row.index(byte)]
                self.over[at] = min(max(self.over[at] + change, 10), 200)
        if byte in {0x95, 0x96, 0x97}:
            self.over[1] = {0x95: 100, 0x96: 50, 0x97: 25}[byte]

    def _status(self) -> None:
        mask = int(self.settings["$10"])
        digit = f":{0 if self.now >= self.held_until else 1}" if self.state == "Hold" else ""
        offset = [a + b for a, b in zip(self.systems[self._system()], self.shift, strict=True)]
        values = self.position if mask & 1 else [p - o for p, o in zip(self.position, offset, strict=True)]
        fields = [f"{'MPos' if mask & 1 else 'WPos'}:" + ",".join(f"{v:.3f}" for v in values)]
        if mask & 2:
            fields.append(f"Bf:{BLOCKS - len(self.planner)},{RECEIVE - len(self.rx)}")
        speed = self.planner[0].speed if self.state in {"Run", "Jog"} and self.planner else 0.0
        fields.append(f"FS:{60 * speed:.0f},{self.speed if self.modes[12] != 'M5' else 0:.0f}")
        if self._since % 10 == 0:
            fields.append("WCO:" + ",".join(f"{v:.3f}" for v in offset))
        elif self._since % 10 == 1:
            fields.append("Ov:" + ",".join(str(v) for v in self.over))
        self._since += 1
        self._say(f"<{self.state}{digit}|{'|'.join(fields)}>")

    # -- time

    def advance(self, now: float) -> None:
        """Let time pass."""
        left = now - self.now
        while True:
            self._lines()
            if self.state not in {"Run", "Jog"} or not self.planner or left <= 0.0:
                break
            left = self._move(left, now)
        self.now = now
        if self.homing and now >= self.busy_until:
            self.homing = False
            self.position = [0.0, 0.0, 0.0]
            self.target = list(self.position)
            self.state = "Idle"
            self._answer()
        elif self.after is not None and not self.chords and now >= self.busy_until and not self.paused:
            self._answer()
        self._lines()

    def _move(self, left: float, now: float) -> float:
        block = self.planner[0]
        scale = (self.over[1] if block.rapid else 100 if block.jog else self.over[0]) / 100.0
        needs = (block.length - block.done) / (block.speed * scale)
        if needs > left:
            block.done += left * block.speed * scale
            share = block.done / block.length
            self.position = [a + share * (b - a) for a, b in zip(block.start, block.end, strict=True)]
            return 0.0
        self.planner.popleft()
        self.position = list(block.end)
        self.executed.append(tuple(block.end))
        self.now = now - (left - needs)
        if not self.planner and not self.chords:
            self.state = "Idle"
        return left - needs

    def _answer(self) -> None:
        if self.after is not None:
            self._say(self.after)
            self.after = None

    # -- lines

    def _lines(self) -> None:
        """Take lines as long as nothing is in their way."""
        while True:
            while self.chords and len(self.planner) < BLOCKS:
                self._plan(self.chords.popleft())
            if self.chords or self.stuck or self.homing or self.paused:
                return
            if self.after is not None:
                if self.now < self.busy_until or (self._waits and self.planner):
                    return
                self._answer()
            if len(self.planner) >= BLOCKS or (self.state == "Hold") or 10 not in self.rx:
                return
            data = bytearray()
            while (byte := self.rx.popleft()) != 10:
                data.append(byte)
            self._line(data.decode("latin-1").rstrip("\r"))

    _waits = False

    def _line(self, text: str) -> None:
        self.lines.append(text)
        self._waits = False
        self.after = "ok"
        try:
            if len(text) > WIDTH:
                self.offences.append("line too long")
                raise Refused(11)  # noqa: TRY301 - as any other
            plain = re.sub(r"\(.*?\)|;.*|\s", "", text).upper()
            if plain.startswith("$J="):
                self._jog(plain[3:])
            elif plain.startswith("$"):
                self._command(plain)
            elif plain:
                if self.state in {"Alarm", "Jog"}:
                    raise Refused(9)  # noqa: TRY301 - as any other
                self._block(plain)
        except Refused as refused:
            self.after = f"error:{refused.number}"
        if self.after is not None and not (self.chords or self.homing or self.paused or self.now < self.busy_until
                                           or (self._waits and self.planner)):  # fmt: skip
            self._answer()

    def _command(self, text: str) -> None:  # noqa: C901, PLR0912 - one branch a command
        if text in {"$$", "$I", "$#", "$N"} and self.state not in {"Idle", "Alarm", "Check"}:
            raise Refused(8)
        if text == "$$":
            for name, value in self.settings.items():
                self._say(f"{name}={value}")
        elif text == "$I":
            self._say("[VER:1.1h.20190830:]")
            self._say(f"[OPT:V,{BLOCKS},{RECEIVE}]")
        elif text == "$#":
            for number, system in enumerate([*self.systems, [0.0] * 3, [0.0] * 3, self.shift]):
                name = ("G54", "G55", "G56", "G57", "G58", "G59", "G28", "G30", "G92")[number]
                self._say(f"[{name}:" + ",".join(f"{v:.3f}" for v in system) + "]")
            self._say("[TLO:0.000]")
            self._say("[PRB:0.000,0.000,0.000:0]")
        elif text == "$G":
            modes = [self.modes[at] for at in (0, 8, 1, 5, 2, 4, 12, 13)]
            self._say(f"[GC:{' '.join(modes)} T0 F{self.feed:.0f} S{self.speed:.0f}]")
        elif text == "$N":
            self._say("$N0=")
            self._say("$N1=")
        elif text == "$X":
            if self.state == "Alarm":
                self.state = "Idle"
                self._say("[MSG:Caution: Unlocked]")
        elif text == "$H":
            if self.settings["$22"] != "1":
                raise Refused(5)
            if self.state not in {"Idle", "Alarm"}:
                raise Refused(8)
            self.state, self.homing, self.busy_until = "Home", True, self.now + 3.0
        elif match := re.fullmatch(r"\$(\d+)=([\d.]+)", text):
            if self.state not in {"Idle", "Alarm"}:
                raise Refused(8)
            if f"${match[1]}" not in self.settings:
                raise Refused(3)
            self.settings[f"${match[1]}"] = match[2]
        else:
            raise Refused(3)

    def _system(self) -> int:
        return int(self.modes[8][1:]) - 54

    def _block(self, text: str) -> None:  # noqa: C901 - the order of execution
        codes, values = words_of(text)
        axes = {"XYZ".index(letter): value for letter, value in values.items() if letter in "XYZ"}
        words = set(values) - {"F", "S", "T", "N", "X", "Y", "Z"}
        modes = self.modes | {at: code for at, code in codes.items() if at in STARTING}
        feed = values.get("F", self.feed / 25.4 if modes[5] == "G20" else self.feed)
        self.feed = feed * (25.4 if modes[5] == "G20" else 1.0)
        self.speed = values.get("S", self.speed)
        self.modes = modes
        once, motion = codes.get(10), modes[0]
        if once == "G4":
            if "P" not in words:
                raise Refused(28)
            self._waits, self.busy_until = True, self.now + values["P"] + sum(
                b.length / b.speed for b in self.planner)  # fmt: skip
            words -= {"P"}
        elif once in {"G10", "G92", "G92.1", "G28", "G30", "G28.1", "G30.1"}:
            words -= {"P", "L"}
            axes = self._offsets(once, axes, values)
        elif axes:
            if once == "G53" and motion not in {"G0", "G1"}:
                raise Refused(30)
            words = self._motion(motion, axes, words, values, machine=once == "G53")
        elif 0 in codes and codes[0] in {"G2", "G3"}:
            raise Refused(26)
        if words:
            raise Refused(36)
        if codes.get(11) in {"M0", "M2", "M30"}:
            self._waits = True
            if codes[11] == "M0":
                self.paused, self.state, self.held_until = True, "Hold", self.now
                while self.planner:  # it waits for the planner to run dry first
                    block = self.planner.popleft()
                    self.position = list(block.end)
                    self.executed.append(tuple(block.end))
            else:
                self.modes |= {0: "G1", 1: "G17", 2: "G90", 4: "G94", 8: "G54", 12: "M5", 13: "M9"}

    def _offsets(self, once: str, axes: dict[int, float], values: dict[str, float]) -> dict[int, float]:
        system = self.systems[int(values["P"]) - 1 if values.get("P") else self._system()]
        for at, value in axes.items():
            if once == "G10":
                system[at] = value if values.get("L") == 2 else self.target[at] - self.shift[at] - value
            elif once == "G92":
                self.shift[at] = self.target[at] - self.systems[self._system()][at] - value
        if once == "G92.1":
            self.shift = [0.0] * 3
        return {}

    def _ends(self, axes: dict[int, float], modes: dict[int, str], *, machine: bool) -> list[float]:
        scale = 25.4 if modes[5] == "G20" else 1.0
        end = list(self.target)
        for at, value in axes.items():
            offset = 0.0 if machine else self.systems[self._system()][at] + self.shift[at]
            end[at] = self.target[at] + value * scale if modes[2] == "G91" else value * scale + offset
        return end

    def _inside(self, end: list[float]) -> bool:
        if self.settings["$20"] != "1":
            return True
        return all(-float(self.settings[f"$13{at}"]) <= v <= 0.0 for at, v in enumerate(end))

    def _motion(
        self, motion: str, axes: dict[int, float], words: set[str], values: dict[str, float], *, machine: bool
    ) -> set[str]:  # fmt: skip
        if motion == "G80":
            raise Refused(31)
        end = self._ends(axes, self.modes, machine=machine)
        if motion != "G0" and self.feed <= 0.0:
            raise Refused(22)
        points = [end]
        if motion in {"G2", "G3"}:
            scale = 25.4 if self.modes[5] == "G20" else 1.0
            offsets = {letter: scale * value for letter, value in values.items() if letter in "IJKR"}
            points = arc_points(motion, self.modes[1], self.target, end, offsets, float(self.settings["$12"]))
            words = words - {"I", "J", "K", "R"}
        if not self._inside(end):
            self._say("ALARM:2")
            self._say("[MSG:Reset to continue]")
            self.state, self.stuck, self.after = "Alarm", True, None
            self.planner.clear()
            self.rx.clear()
            return set()
        for point in points:
            self._queue(point, jog=False, rapid=motion == "G0", feed=self.feed / 60.0)
        return words

    def _queue(self, end: list[float], *, jog: bool, rapid: bool, feed: float) -> None:
        length = math.dist(self.target, end)
        if length < 1e-9:
            return
        share = [abs(b - a) / length for a, b in zip(self.target, end, strict=True)]
        most = min(float(self.settings[f"$11{at}"]) / 60.0 / s for at, s in enumerate(share) if s > 0)
        self.chords.append(Block(list(self.target), list(end), most if rapid else min(feed, most), jog=jog,
                                 rapid=rapid))  # fmt: skip
        self.target = list(end)

    def _plan(self, block: Block) -> None:
        self.planner.append(block)
        if self.state == "Idle":
            self.state = "Jog" if block.jog else "Run"

    def _jog(self, text: str) -> None:
        if self.state not in {"Idle", "Jog"}:
            raise Refused(9 if self.state == "Alarm" else 8)
        codes, values = words_of(text)
        if set(codes.values()) - {"G20", "G21", "G90", "G91", "G53"} or "F" not in values:
            raise Refused(16 if set(codes.values()) - {"G20", "G21", "G90", "G91", "G53"} else 22)
        axes = {"XYZ".index(letter): value for letter, value in values.items() if letter in "XYZ"}
        if not axes:
            raise Refused(26)
        end = self._ends(axes, self.modes | codes, machine=codes.get(10) == "G53")
        if not self._inside(end):
            raise Refused(15)
        self._queue(end, jog=True, rapid=False, feed=values["F"] / 60.0)
