"""Talks to an image on the simulated chip in its own protocol: orders in, what the pins did out."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.backends.avr.session import Greeted, Session, Told
from trochia.backends.avr.transports import ChipTransport
from trochia.backends.avr.wiring import BOARDS
from trochia.kernels.link import AT_REST, BEGIN, PART, PUT, SET_OUTPUTS, SPAN, STATES
from trochia.kernels.ticks import BACKWARDS

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

STRIDE = 0.0005  # s


class Talk:
    """One board, greeted."""

    def __init__(self, program: Path, image: Path, board: str) -> None:
        self.board = BOARDS[board]
        self.line = ChipTransport(program, image, mcu=self.board.mcu)
        self.line.edges = []
        self.session, self.now = Session(self.line.baud), 0.0
        self.answer: Any = None
        self.status: Any = None
        self.number = 0
        self.session.greet(0.0)
        while self.answer is None:
            self.pass_on(STRIDE)
            assert self.now < 1.0

    def pass_on(self, seconds: float) -> None:
        end = self.now + seconds
        while self.now < end - 1e-9:
            self.now += STRIDE
            for event in self.session.receive(self.line.exchange(self.session.outgoing(self.now), self.now), self.now):
                if isinstance(event, Greeted):
                    self.answer = event.answer
                elif isinstance(event, Told):
                    self.status = event.status

    def ask(self) -> Any:
        self.status = None
        self.session.ask()
        while self.status is None:
            self.pass_on(STRIDE)
        return self.status

    def switch(self, *, enable: int = 255, mask: int = 0, outputs: int = 0) -> None:
        order = np.zeros((), PUT)
        order["enable"], order["lit"], order["mask"], order["outputs"] = enable, 255, mask, outputs
        self.session.order("switch", order.tobytes())
        self.pass_on(0.01)

    def begin(self) -> None:
        order = np.zeros((), BEGIN)
        order["epoch"], self.number = 1, 0
        self.session.order("begin", order.tobytes())

    def span(self, counts: dict[int, int], interval: int, *, last: bool = True, outputs: int | None = None) -> None:
        """Every motor makes its steps, signed, at one interval [ticks], and there is an interval of rest behind."""
        self.spans({motor: (interval, count) for motor, count in counts.items()}, last=last, outputs=outputs)

    def spans(self, rows: dict[int, tuple[int, int]], *, last: bool = True, outputs: int | None = None) -> None:
        """As ``span``, with an interval for each motor."""
        head, parts = np.zeros((), SPAN), b""
        for motor, (interval, count) in sorted(rows.items()):
            part = np.zeros((), PART)
            part["first"], part["interval"], part["stride"] = interval * 256, interval * 256, 1
            part["count"], part["flags"] = abs(count) - 1, BACKWARDS if count < 0 else 0
            parts += part.tobytes()
            head["motors"] |= 1 << motor
        head["number"], head["slew"] = self.number, 3000
        head["duration"] = max(interval * (2 + abs(count)) for interval, count in rows.values())
        head["flags"] = (AT_REST if last else 0) | (0 if outputs is None else SET_OUTPUTS)
        head["outputs"] = outputs or 0
        self.number += 1
        self.session.order("span", head.tobytes() + parts)

    def go(self, seconds: float) -> Any:
        """Run through what is held, and return the last status."""
        self.session.order("go")
        self.pass_on(seconds)
        return self.ask()

    def stream(self, spans: list[bytes], *, status: float = 0.01) -> Any:
        """Send spans as there is room, a status asked for every so often, until all is done; return the last one."""
        self.switch(enable=1)
        self.begin()
        sent, started, asked = 0, False, self.now
        while True:
            while sent < len(spans) and self.session.room >= len(spans[sent]) and self.session.waiting < 3:
                self.session.order("span", spans[sent])
                sent += 1
            full = sent == len(spans) or self.session.room < len(spans[sent])
            if not started and full and not self.session.waiting:
                self.session.order("go")
                started, self.status = True, None
            if self.now - asked >= status:
                self.session.ask()
                asked = self.now
            self.pass_on(STRIDE)
            if started and self.status is not None and STATES[int(self.status["state"])] in {"idle", "stopped"}:
                return self.ask()

    def events(self) -> NDArray[np.void]:
        """Return what happened at the pins since this was asked last."""
        happened = np.concatenate(self.line.edges)
        self.line.edges.clear()
        return happened
