"""A machine whose amplifiers close the speed: its file, its check, its run on the twin."""

from __future__ import annotations

import math
from importlib import resources
from typing import TYPE_CHECKING

import pytest

from trochia.analysis.check import judge
from trochia.analysis.plan import make
from trochia.analysis.prove import prove
from trochia.languages import gcode
from trochia.machine.dump import dumps
from trochia.machine.load import loads
from trochia.machine.servo_plant import Mode
from trochia.machine.servos.drive import servo_drive

if TYPE_CHECKING:
    from pathlib import Path

TEXT = (resources.files("trochia") / "data" / "machines" / "xy-table.toml").read_text(encoding="utf-8")
TORQUE = 'amplifier = { mode = "current", command = "10 V", current = "11.5 A"'
SPEED = 'amplifier = { mode = "speed", speed = "3000 rpm", bandwidth = "80 Hz", command = "10 V", current = "11.5 A"'
JOB = b"G21 G90 G94\nF1800\nG1 X20\nG1 X0\nM2\n"


def text_of(forward: float) -> str:
    """Return the xy-table with amplifiers of speed and plain proportional control of position."""
    head, *rest = TEXT.replace(TORQUE, SPEED).split("[joints.X.loop]")
    middle = rest[0].split("\n\n", 1)[1]
    body, tail = middle.split("[joints.Y.loop]")
    loop = f'kind = "pid"\nkp = "1 V/rad"\nvelocity_forward = {forward:.1f}\n'
    return f"{head}[joints.X.loop]\n{loop}\n{body}[joints.Y.loop]\n{loop}\n{tail.split(chr(10) + chr(10), 1)[1]}"


@pytest.mark.parametrize("forward", [0.0, 1.0])
def test_it_lags_by_speed_over_gain_and_not_with_feed_forward(forward: float, tmp_path: Path) -> None:
    """v / (kp · speed a volt), both on the shaft: 30 mm/s are 94 rad/s, a radian 31.4 rad/s."""
    machine = loads(text_of(forward))
    drive = servo_drive(machine, 0)
    assert drive is not None
    assert drive.plant.amplifier.mode is Mode.SPEED
    assert drive.plant.amplifier.gain == pytest.approx(31.416, rel=1e-4)
    assert loads(dumps(machine)) == machine
    verdict = judge(make(gcode.read(JOB.decode(), name="part.ngc"), machine))
    assert not {p.code for p in verdict.problems} & {"loop-unstable", "torque-short"}
    seen = prove(verdict, JOB, tmp_path).following_error["X"].peak
    per_radian = 2.0 / math.tau  # mm
    offset = 0.0568 * per_radian  # of the amplifier, over kp
    expected = 30.0 / per_radian / 31.416 * per_radian if forward == 0.0 else 0.0
    assert seen == pytest.approx(expected + offset, abs=0.03)
