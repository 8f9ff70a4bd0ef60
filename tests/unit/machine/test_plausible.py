"""Slips of a unit in a catalogue's row are told with what would do."""

from __future__ import annotations

from dataclasses import replace

import pytest

from trochia.errors import ConfigError
from trochia.machine.motors import motor

ROW = motor("QSH5718-55")


@pytest.mark.parametrize(
    ("changes", "key", "said"),
    [
        ({"inductance": 2.1}, "inductance", "2100 mH over 0.8 ohm is a time constant of 2.625 s"),
        ({"inductance": 2.1e-6}, "inductance", "above"),
        ({"current": 3e-3}, "current", "0.003 A through 0.8 ohm take 0.0024 V"),
        ({"current": 3000.0}, "current", "below 312 A would do"),
        ({"inertia": 209e-3}, "inertia", "would turn the rotor at 4.689 rad/s²"),
        ({"inertia": 209e-11}, "inertia", "above"),
        ({"holding_torque": 98.0, "inertia": 2e-3}, "holding_torque", "times the current's"),
        ({"voltage": 24.0}, "voltage", "24 V are 10 times what 3 A take"),
    ],
)
def test_absurd_values_are_named_with_what_would_do(changes: dict[str, float], key: str, said: str):
    with pytest.raises(ConfigError) as caught:
        replace(ROW, **changes)
    assert caught.value.key == key
    assert said in str(caught.value)
    assert "would do with the others" in str(caught.value)
