"""Gains from bandwidth and damping for a joint: its closed loop has the poles asked for, in its own form."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

from trochia import api
from trochia.analysis.tuning.commission import commissioned
from trochia.analysis.tuning.trial import parabola_of, trial
from trochia.cli import tune
from trochia.errors import ConfigError
from trochia.machine.servo_plant import Amplifier, Mode
from trochia.machine.servos import PidLoop, PmacLoop
from trochia.machine.servos.drive import ServoDrive, servo_drive
from trochia.servo.nominal import nominal_loop
from trochia.servo.sampled import closed_poles


def drive_of(machine: str) -> ServoDrive:
    drive = servo_drive(api.load(machine), 0)
    assert drive is not None
    return drive


@pytest.mark.parametrize(
    ("machine", "kind", "bandwidth", "period"), [("xy-table", PmacLoop, 2.0, 442e-6), ("lathe", PidLoop, 9.0, 1e-4)]
)
@pytest.mark.parametrize("damping", [0.7, 1.2])
def test_the_closed_loop_has_the_poles_asked_for(
    machine: str, kind: type, bandwidth: float, period: float, damping: float
) -> None:
    drive = drive_of(machine)
    amplifier = replace(drive.plant.amplifier, lag=0.0)
    # ticks, lag and winding shift the poles: here the placing itself is looked at
    drive = replace(drive, plant=replace(drive.plant, amplifier=amplifier, inductance=0.0), period=period)
    data = commissioned(drive, drive.plant, bandwidth=bandwidth, damping=damping)
    assert isinstance(data, kind)
    loop = nominal_loop(replace(drive, loop=data))
    poles = np.log(closed_poles(drive.plant, loop)) / loop.period
    w = math.tau * bandwidth
    root = np.sqrt(complex(damping**2 - 1.0))
    for wanted in (-w, -w * (damping + root), -w * (damping - root)):
        assert np.abs(poles - wanted).min() < 0.05 * abs(wanted)


def test_a_card_s_offset_and_feed_forward_are_those_of_its_plant() -> None:
    drive = drive_of("xy-table")
    data = commissioned(drive, drive.plant, bandwidth=15.0, damping=0.7)
    assert isinstance(data, PmacLoop)
    assert data.i29 == -186  # the one the machine was built with, of its amplifier's 56.8 mV
    assert data.i34 == 1
    tuned = replace(drive, loop=data)
    wanted = parabola_of(0.0, 5.0, 0.5, drive.period, round(0.2 / drive.period))
    seen = trial(tuned, "parabolic", wanted, start=0.0, travel=(-150.0, 150.0))
    assert seen.following is not None
    assert seen.following.peak < 0.01


def test_what_cannot_be_had_is_named() -> None:
    drive = drive_of("xy-table")
    with pytest.raises(ConfigError, match="i30: must be within"):
        commissioned(drive, drive.plant, bandwidth=400.0, damping=0.7)
    with pytest.raises(ConfigError, match="less than a card's least"):
        commissioned(replace(drive, plant=replace(drive.plant, counts=1e12)), drive.plant, bandwidth=5.0, damping=0.7)
    with pytest.raises(ConfigError, match="closes the speed itself"):
        commissioned(drive, replace(drive.plant, amplifier=Amplifier(mode=Mode.SPEED)), bandwidth=5.0, damping=0.7)
    slow = drive_of("lathe")
    with pytest.raises(ConfigError, match="quicker than the loop"):
        commissioned(slow, slow.plant, bandwidth=0.5, damping=0.7)


def test_on_the_command_line() -> None:
    words = ["-m", "xy-table", "--rule", "bandwidth", "--bandwidth", "15", "--json"]
    found = json.loads(CliRunner().invoke(tune.command, words, catch_exceptions=False).output)
    assert found["gains"]["kind"] == "pmac"
    assert found["gains"]["i29"] == -186
    result = CliRunner().invoke(tune.command, words[:4])
    assert result.exit_code == 2
    assert "needs --bandwidth" in result.output
