"""Step timing of corrected joints: steps are where motors are told to be, and no closer than their limits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import trochia
from trochia.api import gcode, plan, simulate
from trochia.machine.compensation import Compensation
from trochia.machine.error_table import ErrorTable
from trochia.pulses import CLOCK, step_blocks
from trochia.pulses.motor_way import MotorWay

PROGRAM = "G21 G90 G0 X20 Y10\nG1 X40 F2400\nG2 X40 Y10 I6 J0\nG1 X5 Y30\nM2\n"
PLACES = np.linspace(0.0, 400.0, 21)


def corrected(machine, **given):
    return replace(machine, joints=tuple(replace(j, compensation=Compensation(**given)) for j in machine.joints))


def steps_of(machine, planned):
    blocks = list(step_blocks(planned.trajectory, machine))
    return [(np.concatenate([b.ticks[j] for b in blocks]), np.concatenate([b.directions[j] for b in blocks]))
            for j in range(len(machine.joints))], blocks  # fmt: skip


def test_a_table_of_zeros_makes_as_many_steps():
    plain = trochia.load("laser")
    machine = corrected(plain, screw=ErrorTable(points=((0.0, 0.0), (400.0, 0.0))))
    planned = plan(gcode(PROGRAM, plain), plain)
    (exact, _), (cubic, _) = steps_of(plain, planned), steps_of(machine, planned)
    for (ticks, ways), (other, same) in zip(exact, cubic, strict=True):
        assert abs(len(ways) - len(same)) <= 4  # one a turn: these stand on the nearest step, those on the last passed
        counts = np.interp(other, ticks, np.cumsum(ways))
        assert np.abs(counts - np.cumsum(same)).max() <= 1.01


def test_a_step_falls_where_the_motor_is_told_to_be():
    table = ErrorTable(points=tuple(zip(PLACES.tolist(), (0.04 * np.sin(PLACES / 15)).tolist(), strict=True)))
    machine = corrected(trochia.load("laser"), screw=table, backlash=0.04)
    planned = plan(gcode(PROGRAM, machine), machine)
    steps, _ = steps_of(machine, planned)
    for j, (ticks, ways) in enumerate(steps):
        per_unit = float(machine.joints[j].steps_per_unit)
        assert np.all(np.diff(ticks) >= 0)
        way = MotorWay(machine, planned.trajectory)
        counts = np.cumsum(ways) + round(way.at(np.zeros(1))[0, j] * per_unit)
        at = way.at(ticks / CLOCK)[:, j] * per_unit
        assert np.abs(np.abs(at - counts) - 0.5).max() < 0.02  # between the steps before and behind it
        fastest = CLOCK / np.diff(ticks)[np.diff(ways) == 0].min()
        assert fastest / per_unit <= machine.axes[j].velocity * 1.01


def test_a_stepper_as_physics_is_corrected_too():
    machine = trochia.load("shield-stage")
    axis = machine.axes[0]
    places = np.linspace(axis.minimum, axis.maximum, 9)
    error = 0.05 * np.sin(places / (axis.maximum - axis.minimum) * 6)
    table = ErrorTable(points=tuple(zip(places.tolist(), error.tolist(), strict=True)))
    bad = replace(machine, joints=(replace(machine.joints[0], screw_error=table), *machine.joints[1:]))
    given = replace(bad.joints[0], compensation=Compensation(screw=table))
    good = replace(bad, joints=(given, *bad.joints[1:]))
    letter = axis.name
    way = 0.3 * axis.minimum + 0.7 * axis.maximum
    program = f"G21 G90 G1 {letter}{way:.3f} F{60 * 0.5 * axis.velocity:.1f}\nM2\n"
    rms = []
    for one in (bad, good):
        recorded = simulate(plan(gcode(program, one), one))
        error = recorded[f"{letter}.actual"] - recorded[f"{letter}.commanded"]
        rms.append(np.abs(error[-1]))
    assert rms[0] == pytest.approx(abs(float(table.at(way))), abs=0.02)
    assert rms[1] < 0.02
