"""Steps at the pins: a sample of the campaign of ``make soak``, and whether it would find what it looks for."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

SOAK = Path(__file__).parents[1] / "soak"


@pytest.fixture
def run(chip_program: Path, board_image: Callable[[str], Path]) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Runs a program beside the campaign, whose chip and image are there."""
    board_image("uno-stepdir-1000000")
    assert chip_program.exists()
    return lambda *arguments: subprocess.run(
        [sys.executable, *arguments], capture_output=True, text=True, check=False,
        env={**os.environ, "PYTHONPATH": str(SOAK)},
    )  # fmt: skip


def test_a_sample_loses_and_doubles_none(run: Callable[..., subprocess.CompletedProcess[str]]):
    done = run(str(SOAK / "steps_on_chip.py"), "--steps", "200000", "--seed", "3")
    assert done.returncode == 0, done.stdout + done.stderr
    assert " 0 failed" in done.stdout


def test_a_step_lost_doubled_turned_or_late_is_found(run: Callable[..., subprocess.CompletedProcess[str]]):
    program = """
        import tempfile
        from pathlib import Path
        import numpy as np
        import steps_on_chip as s

        at_pins, s.SPANS = s.spans.at_pins, 8

        def changed(how):
            def other(*arguments):
                made, cycles = at_pins(*arguments)
                if how == "lost":
                    made[0], cycles[0] = made[0][:-1], cycles[0][:-1]
                elif how == "doubled":
                    made[0], cycles[0] = np.append(made[0], [1, -1]), np.append(cycles[0], cycles[0][-1] + [900, 1800])
                elif how == "turned":
                    made[0][3], made[0][4] = -made[0][3], -made[0][4]
                    made[0][5:7] *= -1
                elif how == "exchanged":
                    cycles[0][-1] += 2000
                elif how == "late":
                    since = np.quantile(np.concatenate(cycles), 0.9)
                    cycles = [np.where(one > since, one + 600, one) for one in cycles]
                return made, cycles
            s.spans.at_pins = other
            return s.case(2, chip).wrong

        with tempfile.TemporaryDirectory() as folder:
            chip = s.built(Path(folder), image=True)
            print([changed(how) for how in ("nothing", "lost", "doubled", "turned", "exchanged", "late")])
    """
    done = run("-c", textwrap.dedent(program))
    said = done.stdout
    assert done.returncode == 0, done.stderr
    assert said.startswith("['', 'motor 0: "), said
    for words in ("at its pins", "steps, ", "another stream of pulses", "cycles late"):
        assert words in said
