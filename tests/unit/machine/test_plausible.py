"""Slips of a unit in a catalogue's row are told with what would do."""

from __future__ import annotations

from dataclasses import replace

import pytest

from trochia.errors import ConfigError
from trochia.machine.motors import library, motor

ROW = motor("QSH5718-55")


@pytest.mark.parametrize(
    ("changes", "key", "said"),
    [
        ({"inductance": 2.1}, "inductance", ["2100 mH over 0.8 ohm is a time constant of 2.625 s",
                                             "0.04 to 80 mH would do", "Is it 2.1 mH, not 2.1 H?"]),
        ({"inductance": 2.1e-6}, "inductance", ["Is it 2.1 mH, not 2.1 uH?"]),
        ({"current": 3e-3}, "current", ["0.003 A through 0.8 ohm take 0.0024 V", "Is it 3 A, not 3 mA?"]),
        ({"current": 3000.0}, "current", ["0.12 to 190 A would do", "Is it 3000 mA (3 A), not 3000 A?"]),
        ({"inertia": 209e-3}, "inertia", ["would turn the rotor at 4.689 rad/s²", "4.9 to 4900 g·cm² would do"]),
        ({"inertia": 209e-4}, "inertia", ["Is it 209 g·cm², not 209 kg·cm²?"]),
        ({"inertia": 209e-11}, "inertia", ["would do"]),
        ({"holding_torque": 10.0}, "holding_torque", ["times the current's", "0.11 to 5.3 N·m would do",
                                                      "10 kgf·cm (0.981 N·m)", "not 10 N·m?"]),
        ({"holding_torque": 139.0}, "holding_torque", ["139 oz·in (0.982 N·m)", "not 139 N·m?"]),
        ({"holding_torque": 98.0}, "holding_torque", ["not 98 N·m?"]),
        ({"holding_torque": 98e-5}, "holding_torque", ["0.11 to 5.3 N·m would do"]),
        ({"voltage": 24.0}, "voltage", ["24 V are 10 times what 3 A take", "0.96 to 6 V would do", "supply"]),
        ({"full_steps": 4}, "holding_torque", ["with 4 full steps"]),
    ],
)  # fmt: skip
def test_absurd_values_are_named_with_what_would_do(changes: dict[str, float], key: str, said: list[str]):
    with pytest.raises(ConfigError) as caught:
        replace(ROW, **changes)
    assert caught.value.key == key
    for words in said:
        assert words in str(caught.value)


@pytest.mark.parametrize("name", library())
@pytest.mark.parametrize(
    ("key", "factor"),
    [("inductance", 1e3), ("inductance", 1e-3), ("current", 1e-3), ("holding_torque", 1 / 7.0615518e-3),
     ("holding_torque", 1 / 0.0980665), ("holding_torque", 100.0), ("inertia", 1e3), ("inertia", 1e7)],
)  # fmt: skip
def test_every_slip_of_a_unit_is_found_in_every_motor_of_the_library(name: str, key: str, factor: float):
    """L in H for mH, mH for uH; mA for A; oz·in, kgf·cm, N·cm as N·m; kg·cm², kg·m² for g·cm²."""
    row = motor(name)
    if row.kind == "permanent-magnet" and key == "holding_torque":
        factor *= 10.0  # a tin can's flux ratio has a wide range, and this motor stands low in it
    with pytest.raises(ConfigError, match="cannot be right"):
        replace(row, **{key: factor * getattr(row, key)})
