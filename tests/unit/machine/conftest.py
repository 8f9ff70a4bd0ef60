"""A small right machine file, and ways to make it wrong."""

from __future__ import annotations

from pathlib import Path

import pytest

GOOD = """\
format = 1
name = "small"
kinematics = "cartesian"

[axes.X]
minimum = "0 mm"
maximum = "100 mm"
velocity = "50 mm/s"
acceleration = "500 mm/s²"

[axes.A]
minimum = "-360 deg"
maximum = "360 deg"
velocity = "1 rev/s"
acceleration = "720 deg/s²"

[joints.X]
motor = { kind = "stepper", full_steps = 200, microsteps = 4 }
transmission = { kind = "leadscrew", lead = "0.2 in" }
pulses = { length = "5 us", space = "5 us" }

[joints.A]
motor = { kind = "stepper" }
transmission = { kind = "direct", ratio = "5/2" }

[io.lamp]
kind = "latched"
electrical = "ttl"
load = "10 mA"
"""


@pytest.fixture
def good() -> str:
    return GOOD


@pytest.fixture
def settings() -> Path:
    """Folder of other controllers' settings."""
    return Path(__file__).parent / "settings"
