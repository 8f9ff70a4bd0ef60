"""An encoder's faults in a machine's file: refused where nothing reads them, told by check, seen in simulate."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

import pytest

from trochia import api
from trochia.analysis.check import judge
from trochia.analysis.prove import prove
from trochia.errors import ConfigError
from trochia.machine.encoders import Encoder
from trochia.machine.servos import CascadeLoop, ServoAmplifier

if TYPE_CHECKING:
    from pathlib import Path

    from trochia.machine.machine import Machine

JOB = b"G21 G90 G94\nF1200\nG1 X20\nG1 X5\nG1 X40\nM2\n"


def table(**faults: object) -> Machine:
    """Return the xy-table with faults of its X encoder."""
    machine = api.load("xy-table")
    joint = machine.joints[0]
    assert joint.encoder is not None
    return replace(machine, joints=(replace(joint, encoder=replace(joint.encoder, **faults)), *machine.joints[1:]))


def codes(machine: Machine, tmp_path: Path) -> dict[str, str]:
    """Return the problems of the job on its twin, by code."""
    verdict = judge(api.plan(api.gcode(JOB, machine), machine))
    return {p.code: f"{p.message}  {p.hint}" for p in prove(verdict, JOB, tmp_path).verdict.problems}


def test_missed_edges_are_told_before_and_after_the_run(tmp_path: Path) -> None:
    found = codes(table(missed=1e-3), tmp_path)
    assert "misses some" in found["encoder-misses"]
    assert "counts off" in found["counts-lost"]
    assert "index pulses tell" in found["counts-lost"]


def test_a_sound_encoder_is_not_told_of(tmp_path: Path) -> None:
    assert not {"encoder-misses", "counts-lost"} & set(codes(table(jitter=0.1), tmp_path))


def test_the_whole_way_is_what_edges_are_missed_of() -> None:
    machine = table(missed=1e-3)
    verdict = judge(api.plan(api.gcode(JOB, machine), machine))
    assert verdict.servos["X"].way == pytest.approx(70.0, rel=0.01)
    (problem,) = (p for p in verdict.problems if p.code == "encoder-misses")
    assert f"{70 * 4096 * 1e-3:.0f} of" in problem.message


@pytest.mark.parametrize(
    ("faults", "what"),
    [
        ({"channels": 1}, "one channel tells no direction"),
        ({"clock": 1e6}, "reads no speed; a cascade does"),
        ({"jitter": 0.5}, "must be 0 to 0.2 counts"),
        ({"missed": 1.0}, "below 1"),
        ({"channels": 3}, "must be 1 or 2"),
    ],
)
def test_faults_that_make_no_sense_are_named(faults: dict[str, object], what: str) -> None:
    with pytest.raises(ConfigError, match=what):
        table(**faults)


def test_faults_that_nothing_reads_are_refused() -> None:
    joint = api.load("router").joints[0]
    with pytest.raises(ConfigError, match="this joint has none"):
        replace(joint, encoder=Encoder(counts=Fraction(4000), missed=0.1))


def test_one_channel_serves_the_leadscrew_as_it_was_built() -> None:
    joint = api.load("lathe").joints[1]
    assert joint.encoder is not None
    assert joint.loop is not None
    built = replace(joint, encoder=replace(joint.encoder, channels=1), loop=replace(joint.loop, mended=False))
    assert built.encoder is not None
    assert built.encoder.edges is not None
    assert built.encoder.edges.single


def test_an_amplifier_of_speed_leaves_the_speed_to_itself() -> None:
    joint = api.load("xy-table").joints[0]
    speed = ServoAmplifier(mode="speed", speed=1200.0, current=11.5)
    assert replace(joint, amplifier=speed).amplifier is speed
    with pytest.raises(ConfigError, match="so does the amplifier"):
        replace(joint, amplifier=speed, loop=CascadeLoop(position_gain=10.0, speed_gain=0.1))
    with pytest.raises(ConfigError, match="in mode speed it is what"):
        ServoAmplifier(mode="speed")
