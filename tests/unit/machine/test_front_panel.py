"""The amplifier's panel: the procedure of a first jog, step by step, and what ends it."""

from __future__ import annotations

import pytest

from trochia.machine.servos.panel import FrontPanel, Key


def jogging() -> FrontPanel:
    panel = FrontPanel()
    panel.supply(0.0, on=True)
    panel.press(Key.MODE, 6.0)
    panel.press(Key.ENTER, 7.0)
    panel.release(Key.ENTER, 8.0)
    panel.press(Key.ENTER, 9.0)
    panel.release(Key.ENTER, 9.1)
    return panel


def test_the_first_jog():
    panel = FrontPanel()
    panel.supply(0.0, on=True)
    assert not panel.ready(4.9)
    assert panel.ready(5.0)
    assert panel.display == "PSoF"
    panel.press(Key.MODE, 6.0)
    assert panel.display == "Fn01"
    panel.press(Key.ENTER, 7.0)
    panel.release(Key.ENTER, 7.5)
    assert panel.display == "Fn01"  # not held long enough
    panel.press(Key.ENTER, 8.0)
    panel.release(Key.ENTER, 9.0)
    assert (panel.display, panel.energised) == ("JOG", False)
    panel.press(Key.ENTER, 9.5)
    assert (panel.display, panel.energised) == ("_JOG", True)
    panel.press(Key.UP, 10.0)
    assert (panel.display, panel.jogging) == ("PJOG", 1)
    panel.release(Key.UP, 10.5)
    panel.press(Key.DOWN, 11.0)
    assert (panel.display, panel.jogging) == ("nJOG", -1)
    panel.release(Key.DOWN, 11.5)
    assert (panel.display, panel.jogging, panel.energised) == ("_JOG", 0, True)
    panel.press(Key.MODE, 12.0)
    assert not panel.energised


@pytest.mark.parametrize("key", [Key.UP, Key.DOWN])
def test_nothing_moves_before_it_is_energised(key):
    panel = FrontPanel()
    panel.supply(0.0, on=True)
    panel.press(key, 6.0)
    assert (panel.jogging, panel.energised) == (0, False)


def test_a_lost_supply_takes_the_drive():
    panel = jogging()
    panel.press(Key.UP, 10.0)
    panel.supply(10.5, on=False)
    assert (panel.energised, panel.jogging, panel.ready(11.0)) == (False, 0, False)


def test_a_fault_latches_until_it_is_reset():
    panel = jogging()
    panel.press(Key.UP, 10.0)
    panel.trip("oC")
    assert (panel.energised, panel.jogging, panel.ready(20.0)) == (False, 0, False)
    panel.press(Key.ENTER, 20.0)
    assert not panel.energised
    panel.reset()
    assert panel.ready(21.0)
    assert panel.display == "PSoF"
