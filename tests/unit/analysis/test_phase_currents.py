"""Phase currents at an even speed: against the twin, against closed forms, and what they must keep."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from trochia.analysis.phase_currents import phase_currents
from trochia.errors import LimitError
from trochia.machine.motors import motor
from trochia.machine.motors.curves import pull_out_torque
from trochia.pulses.excitation import excitation

SHIELD = motor("SM-42BYG011-25").parameters()
VOLTS = 9.4


@pytest.mark.parametrize("mode", ["one-phase", "two-phase", "half-step", "microstep-8"])
@pytest.mark.parametrize("full_steps", [50.0, 300.0])
def test_they_are_what_integration_of_the_public_equations_gives(mode: str, full_steps: float):
    """The rotor led evenly at the angle found; after some turns the currents repeat, and are these."""
    table, omega, load = excitation(mode), SHIELD.speed(full_steps), 0.02
    found = phase_currents(SHIELD, table, VOLTS, omega, load)
    pulse, parts = 1.0 / (full_steps * table.steps_per_full_step), 48
    h = pulse / parts
    current, got = np.zeros(2), []
    for row in range(4 * len(table.levels)):
        volts = VOLTS * table.levels[row % len(table.levels)]
        for part in range(parts):
            got.append(current)
            theta0 = table.first_angle - 0.5 * table.step_angle - found.load_angle
            at = (row + part / parts) * table.step_angle + theta0

            def rate(i, ahead, volts=volts, at=at):
                theta = np.array((at + ahead * omega * SHIELD.teeth) / SHIELD.teeth)
                induced = SHIELD.back_emf(theta, np.array(omega))
                return (volts - SHIELD.resistance * i - induced) / SHIELD.inductance

            k1 = rate(current, 0.0)
            k2 = rate(current + h / 2 * k1, h / 2)
            k3 = rate(current + h / 2 * k2, h / 2)
            current = current + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(current + h * k3, h))
    np.testing.assert_allclose(found.currents, got[-len(found.currents) :], atol=2e-4 * VOLTS / SHIELD.resistance)


@pytest.mark.parametrize("mode", ["one-phase", "two-phase", "half-step", "microstep-16"])
@pytest.mark.parametrize("full_steps", [50.0, 300.0, 700.0])
def test_the_most_torque_is_the_closed_forms_pull_out(mode: str, full_steps: float):
    table, omega = excitation(mode), SHIELD.speed(full_steps)
    expected = float(pull_out_torque(SHIELD, np.array(omega), VOLTS * table.fundamental))
    if expected > 0:
        assert phase_currents(SHIELD, table, VOLTS, omega).torque == pytest.approx(expected, rel=2e-3)


def test_the_mean_torque_is_the_load_and_grows_with_the_load_angle():
    table, omega = excitation("two-phase"), SHIELD.speed(200.0)
    angles = []
    for load in (0.0, 0.03, 0.06, 0.09):
        found = phase_currents(SHIELD, table, VOLTS, omega, load)
        field = table.first_angle + (found.steps - 0.5) * table.step_angle
        theta = (field - found.load_angle) / SHIELD.teeth
        torque = SHIELD.torque(found.currents, theta) - SHIELD.detent_torque(theta)
        assert float(torque.mean()) == pytest.approx(load, abs=2e-4)
        angles.append(found.load_angle)
    assert all(b > a for a, b in pairwise(angles))


def test_slowly_it_is_ohms_law_with_a_square_wave():
    found = phase_currents(SHIELD, excitation("two-phase"), VOLTS, SHIELD.speed(0.5))
    np.testing.assert_allclose(np.abs(found.currents[40::48]), VOLTS / SHIELD.resistance, rtol=5e-3)


def test_the_faster_the_later_and_smaller():
    size = [float(np.abs(phase_currents(SHIELD, excitation("two-phase"), VOLTS, SHIELD.speed(f)).currents).max())
            for f in (50.0, 400.0, 700.0)]  # fmt: skip
    assert all(b < a for a, b in pairwise(size[1:]))


def test_what_it_cannot_carry_is_told_with_what_it_has():
    with pytest.raises(LimitError, match=r"at 90 rpm on 9.4 V the motor has 0\.098\d* N·m, not more than 0.2 N·m"):
        phase_currents(SHIELD, excitation("two-phase"), VOLTS, 90 / 60 * math.tau, 0.2)
