"""What a board is held to be able to do: just under it the image misses nothing; what it cannot do is refused."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from click.testing import CliRunner

from trochia.backends.avr.load import COSTS, FULL, Load
from trochia.backends.avr.spans import Span
from trochia.cli import check as check_command
from trochia.kernels.link import CAUSES, SPAN

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

CLOCK = 16e6
SECONDS = 0.6  # more than the queue holds


def spans(rates: list[float], ticks: int, stride: int, seconds: float = SECONDS) -> list[bytes]:
    count = round(seconds * CLOCK / ticks)
    made: list[bytes] = sys.modules["steady_spans"].steady(rates, count, ticks=ticks, stride=stride, slew=3000)
    return made


def judged(payloads: list[bytes], baud: int = 1_000_000, board: str = "uno-stepdir") -> Load:
    load, at = Load(board, baud), 0
    for number, payload in enumerate(payloads):
        end = at + int(np.frombuffer(payload, SPAN, 1)[0]["duration"])
        load.add(Span(number=number, start=at, end=end, before=np.zeros(4, np.int64), payload=payload))
        at = end
    return load


def apart(total: float, motors: int) -> list[float]:
    each = 1.0 + 0.013 * np.arange(motors)
    return (total * each / each.sum()).tolist()


@pytest.mark.parametrize("motors", [1, 2, 3, 4])
@pytest.mark.parametrize("ticks", [1 << 16, 1 << 17, 1 << 18])
@pytest.mark.parametrize("stride", [2, 30])
def test_just_under_the_limit_nothing_is_missed(talk: Callable[[str], Any], motors: int, ticks: int, stride: int):
    """The greatest rate that is not refused, a hundredth less."""
    cost = COSTS["uno-stepdir"][int(stride < 8) if motors < 2 else motors]
    total = 0.99 * (FULL * CLOCK - cost.span * CLOCK / ticks) / (cost.step + cost.bend / stride)
    payloads = spans(apart(total, motors), ticks, stride)
    load = judged(payloads)
    assert "processor" not in load.worst
    assert load.busiest > 0.9 * FULL
    status = talk("uno-stepdir").stream(payloads)
    assert CAUSES[int(status["cause"])] == "no_cause"


@pytest.mark.parametrize(
    ("rates", "ticks", "stride"),
    [([33_000, 33_400, 34_000], 1 << 16, 16), ([40_000, 39_000, 41_000], 1 << 17, 16), ([24_000.0] * 4, 1 << 16, 16)],
)
def test_what_the_image_cannot_do_is_refused(talk: Callable[[str], Any], rates: list[float], ticks: int, stride: int):
    payloads = spans(rates, ticks, stride, 1.0)
    assert judged(payloads).worst["processor"].part > 1.0
    assert CAUSES[int(talk("uno-stepdir").stream(payloads)["cause"])] in {"missed", "low"}


@pytest.mark.parametrize(
    ("rates", "ticks"), [([160_000], 1 << 18), ([200_000], 1 << 18), ([30_000, 31_000, 32_000], 1 << 18)]
)
def test_what_the_image_can_do_is_not_refused(rates: list[float], ticks: int):
    assert not judged(spans(rates, ticks, 100)).worst


def test_steps_closer_than_slots_beside_others_are_refused():
    assert "slots" in judged(spans([130_000, 300], 1 << 18, 100)).worst


PROGRAM = "G21 G90 G64 P0.01\nG1 X10 F600\nG1 X40 Y{y} F{feed}\nX20 Y5\nM2\n"


@pytest.fixture
def check(tmp_path: Path) -> Callable[..., Any]:
    def judge(text: str, *options: str) -> Any:
        (tmp_path / "job.ngc").write_text(text)
        return CliRunner().invoke(
            check_command.command, [str(tmp_path / "job.ngc"), "-m", "reference-mill", "--board", *options]
        )

    return judge


def test_a_program_above_the_limit_is_refused_at_its_line(check: Callable[..., Any]):
    done = check(PROGRAM.format(y=30, feed=2400), "uno-stepdir", "--baud", "1000000")
    assert done.exit_code == 0, done.output
    done = check("G21 G90 G64 P0.01\nG1 X10 F600\nX250 Y200 Z-60 F30000\nX20 Y5 Z0\nM2\n", "uno-stepdir")
    assert done.exit_code == 1, done.output
    assert "job.ngc:3: uno-stepdir: " in done.output
    assert "tick segments a second are more than its processor can do" in done.output
    assert "Lower the feed" in done.output


def test_a_machine_that_is_not_for_the_board_is_refused(check: Callable[..., Any]):
    done = check(PROGRAM.format(y=30, feed=1200), "uno-l293d")
    assert done.exit_code == 1
    assert "the board has 2 motors, the machine 3 joints" in done.output
    done = check(PROGRAM.format(y=30, feed=1200), "due")
    assert done.exit_code == 2
    assert "no board is called 'due'" in done.output
