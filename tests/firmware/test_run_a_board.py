"""`trochia run --backend avr`: a program on the shield, a pseudo-terminal and the simulated chip behind it."""

from __future__ import annotations

import json
import time
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from click.testing import CliRunner

from trochia.cli import run as run_command
from trochia.errors import RemoteProtocolError

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

PROGRAM = "G1 G21 G90 X0.6 Y0.3 F240\nX0.2\nM2\n"


@pytest.fixture
def chips_time(monkeypatch: pytest.MonkeyPatch) -> Callable[[Any], None]:
    """The host's clock is the chip's, which stands still where the computer has no time for it."""

    def take(chip: Any) -> None:
        monkeypatch.setattr(run_command, "clock_of", lambda _backend: chip.clock)

    return take


@pytest.fixture
def invoke(tmp_path: Path) -> Callable[..., Any]:
    """Runs the program on a port."""
    (tmp_path / "job.ngc").write_text(PROGRAM)

    def begin(*options: str) -> Any:
        return CliRunner().invoke(
            run_command.command, [str(tmp_path / "job.ngc"), "-m", "shield-stage", "-y", *options]
        )

    return begin


def test_a_program_on_the_shield(
    plug: Callable[..., Any], invoke: Callable[..., Any], register: Any, chips_time: Callable[[Any], None]
):
    board = plug("uno-l293d")
    chips_time(board.board)
    done = invoke("--backend", "avr", "--port", str(board.link), "--board", "uno-l293d", "--json")
    assert done.exit_code == 0, done.output
    told = json.loads(done.stdout)
    assert (told["ok"], told["state"], told["alarms"]) == (True, "idle", [])
    board.board.leave()
    end = board.board.at + 0.1
    while board.board.at < end:
        time.sleep(0.01)
    register.feed(np.concatenate(board.board.runs))
    assert {byte & 0xE1 for byte in register.bytes} >= {0x21, 0x81, 0xC0, 0x60}  # motor 2, both phases on
    order = [0x06, 0x0A, 0x18, 0x14]
    turned = [order.index(byte & 0x1E) for byte in register.bytes if byte & 0x1E in order]
    way = np.cumsum([1, *((b - a + 1) % 4 - 1 for a, b in pairwise(turned))])  # the first from where it was held
    assert 58 <= way.max() <= 60  # 0.6 mm at 100 steps/mm, the corner within the path's tolerance
    assert way[-1] == 20
    assert register.bytes[-1] == 0  # drives off at the end


def test_the_wrong_board(plug: Callable[..., Any], invoke: Callable[..., Any]):
    done = invoke("--backend", "avr", "--port", str(plug("uno-stepdir").link), "--board", "uno-l293d")
    assert isinstance(done.exception, RemoteProtocolError)
    assert "the board is uno-stepdir, not uno-l293d\n  Say --board uno-stepdir." in str(done.exception)


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (("--backend", "avr"), "go together"),
        (("--port", "x"), "go together"),
        (("--backend", "avr", "--port", "x", "--virtual"), "own clock"),
        (("--backend", "avr", "--port", "x", "--board", "due"), "no board is called 'due'; there are uno-stepdir"),
    ],
)
def test_options_that_do_not_go_together(invoke: Callable[..., Any], options: tuple[str, ...], text: str):
    done = invoke(*options)
    assert done.exit_code == 2
    assert text in done.output
