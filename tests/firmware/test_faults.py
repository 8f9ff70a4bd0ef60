"""Faults on the line: a sample of the campaign of ``make soak``, on the firmware's C and on the image; and whether it
would find what it looks for."""

from __future__ import annotations

import shutil
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from trochia.backends.avr.transports import ChipTransport
from trochia.kernels.link import PART, SPAN

if TYPE_CHECKING:
    from collections.abc import Callable

ROOT = Path(__file__).parents[2]
session, lines = sys.modules["faulty_session"], sys.modules["spoilt_line"]


@pytest.fixture(scope="session")
def host_chip() -> Path:
    """The firmware's C as a program of this computer."""
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    sys.modules["chip_fixtures"].make(ROOT / "firmware" / "host")
    return ROOT / "build" / "host" / "chip"


@pytest.mark.parametrize("style", session.STYLES)
def test_the_same_motion_or_an_alarm_with_the_true_position(host_chip: Path, style: str):
    told = [session.run(session.case_of(seed, style), host_chip, Path()) for seed in range(12)]
    assert sum(one.faults for one in told) >= 5
    assert any("same" in one.ends for one in told)


def test_the_same_on_the_image(chip_program: Path, board_image: Callable[[str], Path]):
    image = board_image("uno-stepdir-1000000")
    cases = [session.case_of(seed, style) for style in session.STYLES for seed in range(1 + 8 * (style == "rate"))]
    told = [session.run(case, chip_program, image) for case in cases]
    assert sum(one.faults for one in told) >= 200


def test_faults_happen_where_they_are_told_to():
    class Wire:
        edges = None

        def exchange(self, data: bytes, _now: float) -> bytes:
            return data.upper()

    def passed(*faults: Any, pieces: tuple[bytes, ...] = (b"abc", b"def")) -> list[bytes]:
        line = lines.SpoiltLine(Wire(), 1, faults=faults)
        return [line.exchange(piece, 0.1 * (k + 1)) for k, piece in enumerate((*pieces, b""))]

    def fault(kind: str, *, way: int = 0, at: int = 1, size: float = 0.0) -> Any:
        return lines.Fault(kind=kind, way=way, at=at, size=size)

    assert passed() == [b"ABC", b"DEF", b""]
    assert passed(fault("drop"), fault("double", way=1, at=3)) == [b"AC", b"DEEF", b""]
    assert passed(fault("flip", way=1, at=4, size=0.0)) == [b"ABC", b"DDF", b""]
    assert passed(fault("delay", at=0, size=0.15)) == [b"", b"", b"ABCDEF"]
    assert passed(fault("cut", at=2, size=0.05)) == [b"", b"DEF", b""]  # nothing comes back either
    burst = passed(fault("burst", way=1, at=1, size=3.0))
    assert (burst[0][:1], burst[1][1:], len(burst[0])) == (b"A", b"EF", 3)


def test_a_step_too_many_is_found(host_chip: Path, monkeypatch: pytest.MonkeyPatch):
    drawn = session._spans.drawn

    def other(*arguments: Any, **named: Any) -> list[bytes]:
        """What is planned has a step less than what is sent."""
        spans = drawn(*arguments, **named)
        part = np.frombuffer(spans[0][SPAN.itemsize : SPAN.itemsize + PART.itemsize], PART)[0].copy()
        part["count"] -= 1
        changed = spans[0][: SPAN.itemsize] + part.tobytes() + spans[0][SPAN.itemsize + PART.itemsize :]
        planned = session._spans.planned
        monkeypatch.setattr(session._spans, "planned", lambda _: planned([changed, *spans[1:]]))
        return spans

    monkeypatch.setattr(session._spans, "drawn", other)
    case = session.Case(seed=3, kind=session._spans.Kind(motors=1, fastest=9000.0, rests=0.0), counts=(4,))
    with pytest.raises(AssertionError, match="steps"):
        session.run(case, host_chip, Path())


def test_a_position_that_is_told_wrong_is_found(host_chip: Path, monkeypatch: pytest.MonkeyPatch):
    at_pins = session._spans.at_pins

    def one_less(*arguments: Any) -> Any:
        made, cycles = at_pins(*arguments)
        return [steps[:-1] for steps in made], [cycle[:-1] for cycle in cycles]

    monkeypatch.setattr(session._spans, "at_pins", one_less)
    case = session.Case(seed=3, kind=session._spans.Kind(motors=1, fastest=9000.0, rests=0.0), counts=(4,))
    with pytest.raises(AssertionError, match="told"):
        session.run(case, host_chip, Path())


def test_a_chip_that_falls_dumb_is_found(host_chip: Path):
    transport = ChipTransport(host_chip, Path())
    run = session.Run(session.Case(seed=4, kind=session._spans.Kind(motors=1, fastest=9000.0), counts=(4,)), transport)
    exchange = transport.exchange
    transport.exchange = lambda data, now: exchange(data, now) and b""
    with pytest.raises(AssertionError, match="it hangs"):
        run.whole()
    transport.close()


@pytest.mark.parametrize("seed", [589, 666])
def test_motion_that_begins_with_a_step_or_two_far_apart(
    chip_program: Path, board_image: Callable[[str], Path], seed: int
):
    """The line of pulses is filled before it is run through, also where its first stretch holds next to nothing."""
    case = replace(session.case_of(seed), start=(), at_hold=(), at_reconnect=(), rate=0.0, hold=None)
    told = session.run(case, chip_program, board_image("uno-stepdir-1000000"))
    assert told.ends == ["same", "same"]
