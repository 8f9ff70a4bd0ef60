"""Switches and ways home in a machine file: read, written again, and held to what they need."""

from __future__ import annotations

import re

import pytest

from trochia.errors import ConfigError
from trochia.machine.dump import dumps
from trochia.machine.load import loads

BASE = """format = 1
name = "m"
kinematics = "cartesian"
[axes.X]
minimum = "-150 mm"
maximum = "150 mm"
velocity = "40 mm/s"
acceleration = "133 mm/s²"
{keys}
[joints.X]
motor = {{ kind = "servo" }}
transmission = {{ kind = "leadscrew", lead = "2 mm" }}
encoder = {{ counts = 8192 }}
[io.home-x]
kind = "input"
[io.lim]
kind = "input"
[io.lamp]
kind = "latched"
"""
HOME = 'home = { input = "home-x", towards = "+", position = "140 mm", search = "10 mm/s" }'


def test_they_are_read_and_written_again() -> None:
    machine = loads(BASE.format(keys=HOME + '\nlimit_plus = { input = "lim", at = "151 mm" }'))
    (axis,) = machine.axes
    assert axis.home is not None
    assert axis.limit_plus is not None
    assert (axis.home.position, axis.home.search, axis.home.back_off) == (140.0, 10.0, 2.0)
    assert axis.limit_plus.at == 151.0
    assert loads(dumps(machine)) == machine


@pytest.mark.parametrize(
    ("keys", "key", "why"),
    [
        ('home = { towards = "-" }', "axes.X.home.input", "missing"),
        ('home = { input = "home-y" }', "axes.X.home.input", "no input 'home-y'"),
        ('home = { input = "lamp" }', "axes.X.home.input", "no input 'lamp'"),
        ('home = { method = "limit" }', "axes.X.limit_minus", "homed to it"),
        ('home = { method = "index" }', "axes.X.home.method", "index"),
        ('home = { method = "wish" }', "axes.X.home.method", "switch"),
        ('home = { input = "home-x", search = "0 mm/s" }', "axes.X.home.search", "above zero"),
        ('limit_minus = { input = "lim" }', "axes.X.limit_minus.at", "missing"),
    ],
)
def test_what_does_not_fit_is_named_by_its_key(keys: str, key: str, why: str) -> None:
    with pytest.raises(ConfigError, match=re.escape(key)) as refused:
        loads(BASE.format(keys=keys))
    assert why in str(refused.value)
