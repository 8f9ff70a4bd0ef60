"""Boards at their pins: nothing at reset, steps and directions where the board's header says."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from trochia.backends.simulated_chip import PIN, PWM

if TYPE_CHECKING:
    from collections.abc import Callable

#: step pins, direction pins, the pin that switches the drives on when low
PINS = {
    "uno-stepdir": (("D2", "D3", "D4", "B4"), ("D5", "D6", "D7", "B5"), "B0"),
    "mega-stepdir": (("A2", "A3", "A4", "A5", "A6", "A7"), ("C7", "C6", "C5", "C4", "C3", "C2"), "D7"),
}


def edges(events: np.ndarray, pin: str) -> np.ndarray:
    mine = (events["kind"] == PIN) & (events["unit"] == pin[0].encode()) & (events["line"] == int(pin[1:]))
    return events["value"][mine]


@pytest.mark.parametrize("board", PINS)
def test_nothing_moves_or_is_energised_at_reset(talk: Callable[[str], Any], board: str):
    steps, turns, enable = PINS[board]
    told = talk(board)
    told.pass_on(0.3)
    events = told.events()
    assert all(edges(events, pin).size == 0 for pin in (*steps, *turns))
    assert edges(events, enable).tolist() == [1]
    assert not np.any(events["kind"] == PWM)


@pytest.mark.parametrize("board", PINS)
def test_every_motor_has_its_pins(talk: Callable[[str], Any], board: str):
    steps, turns, enable = PINS[board]
    told = talk(board)
    told.switch(enable=1)
    counts = {motor: (100 + 10 * motor) * (-1 if motor % 2 else 1) for motor in range(len(steps))}
    told.begin()
    told.span(counts, 4000)
    status = told.go(0.1)
    events = told.events()
    assert status["position"][: len(steps)].tolist() == list(counts.values())
    assert [int(edges(events, pin).sum()) for pin in steps] == [abs(count) for count in counts.values()]
    assert [edges(events, pin).tolist() for pin in turns] == [[1] if motor % 2 else [] for motor in counts]
    assert edges(events, enable).tolist()[-1] == 0
    told.begin()
    told.span({motor: -count for motor, count in counts.items()}, 4000)
    assert told.go(0.1)["position"].tolist() == [0] * 6
