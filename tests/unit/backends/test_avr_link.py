"""The link's session without any I/O: what is dropped, flipped, doubled or cut arrives once and in order, or not."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from trochia.backends.avr.session import Greeted, Session
from trochia.errors import LocalProtocolError, VersionMismatch
from trochia.kernels.link import ACK, ANSWER, PART, SCHEMA, SPAN, TYPES, FrameReader, frame, pulses

FAULTS = 2_000


class Chip:
    """The other end, as the protocol asks: takes the order it expects, and says which that is."""

    def __init__(self, schema: int = SCHEMA):
        self.reader, self.expected, self.taken, self.session, self.schema = FrameReader(), 0, [], -1, schema

    def receive(self, data: bytes) -> bytes:
        answers = b""
        for got in self.reader.feed(data):
            if got.kind == TYPES["hello"]:
                if got.payload[9] != self.session:
                    self.session, self.expected = got.payload[9], 0
                answer = np.zeros((), ANSWER)
                answer["schema"], answer["room"], answer["session"] = self.schema, 1000, self.session
                answer["expected"] = self.expected
                answers += frame(0, TYPES["answer"], answer.tobytes())
                continue
            if 0 <= got.kind < TYPES["hello"] and got.number == self.expected:
                self.taken.append(got.payload)
                self.expected = (self.expected + 1) & 255
            ack = np.zeros((), ACK)
            ack["expected"], ack["room"] = self.expected, 1000
            answers += frame(0, TYPES["ack"], ack.tobytes())
        return answers

    def exchange(self, data: bytes, _now: float) -> bytes:
        return self.receive(data)


def test_orders_arrive_once_and_in_order_whatever_the_line_does():
    rng = np.random.default_rng(8)
    host, chip, now = Session(1_000_000), Chip(), 0.0
    line = sys.modules["spoilt_line"].SpoiltLine(chip, 8, rate=0.01)
    host.greet(now)
    sent: list[bytes] = []
    while line.faults < FAULTS or host.waiting:
        if line.faults >= FAULTS:
            line.mend()
        back = line.exchange(host.outgoing(now), now + 0.002)
        now += 0.002
        host.receive(back, now)
        if host.state in {"open", "lost"} and line.faults < FAULTS and host.waiting < 6:
            sent.append(rng.bytes(int(rng.integers(1, 90))))
            host.order("switch", sent[-1])
    assert len(sent) > 300
    assert chip.taken == sent
    assert host.repeated
    assert host.broken


def test_another_schema_is_refused_with_both_named():
    host, chip = Session(), Chip(schema=0x12345678)
    host.greet(0.0)
    with pytest.raises(VersionMismatch, match=f"12345678.*{SCHEMA:08x}"):
        host.receive(chip.receive(host.outgoing(0.0)), 0.01)
    with pytest.raises(LocalProtocolError, match="refused"):
        host.order("go")


def test_another_schema_is_told_whatever_else_its_answer_holds():
    host = Session()
    host.greet(0.0)
    with pytest.raises(VersionMismatch, match="12345678"):
        host.receive(frame(0, TYPES["answer"], bytes.fromhex("78563412")), 0.01)


def test_a_board_that_was_not_reset_takes_orders_of_the_next_host_with_the_same_number():
    chip = Chip()
    for payload in (b"first", b"second"):
        host = Session()
        host.greet(0.0)
        host.receive(chip.receive(host.outgoing(0.0)), 0.01)
        token = host.order("switch", payload)
        host.receive(chip.receive(host.outgoing(0.01)), 0.02)
        assert (host.taken > token, host.waiting) == (True, 0)
    assert chip.taken == [b"first", b"second"]


def test_an_answer_to_an_earlier_hello_is_none():
    host, chip = Session(), Chip()
    host.greet(0.0)
    late = chip.receive(host.outgoing(0.0))
    host.greet(0.1)
    assert host.receive(late, 0.2) == []
    assert host.state == "greeting"
    assert len(host.receive(chip.receive(host.outgoing(0.2)), 0.3)) == 1


def test_a_greeting_is_answered_once():
    host, chip = Session(), Chip()
    host.greet(0.0)
    first = chip.receive(host.outgoing(0.0))
    again = chip.receive(host.outgoing(1.0))
    assert again  # it was asked for again
    events = host.receive(first + again, 1.1)
    assert [type(event) for event in events] == [Greeted]


def test_silence_is_told():
    host, chip = Session(), Chip()
    host.greet(0.0)
    host.receive(chip.receive(host.outgoing(0.0)), 0.01)
    assert host.state == "open"
    assert host.receive(b"", 0.4) == []
    (lost,) = host.receive(b"", 0.6)
    assert lost.silence == pytest.approx(0.59)
    assert host.state == "lost"


@pytest.mark.parametrize("count", [1, 2, 7, 40, 300])
def test_every_pulse_of_a_span_is_told_also_in_its_last_slice(count: int):
    head, part = np.zeros((), SPAN), np.zeros((), PART)
    head["duration"], head["motors"] = 1000 * (count + 1), 1
    part["first"], part["interval"], part["stride"], part["count"] = 256_000, 256_000, 1, count - 1
    made = pulses(head.tobytes() + part.tobytes())
    assert [tick // 128 for tick in made["tick"].tolist()] == [1000 * (k + 1) // 128 for k in range(count)]
