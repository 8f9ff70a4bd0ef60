"""Drivers: truth tables, dead time, currents and heat against Ohm's law and the datasheet's numbers."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from trochia.errors import ConfigError, LimitError
from trochia.machine.drivers import (
    L293D_DROPS,
    Bridge,
    Chopper,
    HBridge,
    Output,
    SeriesResistor,
    bridge_voltage,
    fed,
    half_bridge,
    heat,
    shoot_through,
)
from trochia.machine.drivers.bridge import check_dead_time, phase_voltage
from trochia.machine.motors import ShaftLoad, motor
from trochia.machine.motors.wiring import wired

SHIELD = motor("SM-42BYG011-25").parameters()
BIG = motor("QSH5718-55").parameters()
HIGH, LOW, OPEN = Output.HIGH, Output.LOW, Output.OPEN


def test_truth_table_of_a_half_bridge():
    """Enable high: the output follows the input; low: high impedance whatever the input."""
    table = {(level, enable): half_bridge(level, enable) for level in (True, False) for enable in (True, False)}
    assert table == {(True, True): HIGH, (False, True): LOW, (True, False): OPEN, (False, False): OPEN}


@pytest.mark.parametrize(
    ("a", "b", "expected"),
    [(HIGH, LOW, 9.4), (LOW, HIGH, -9.4), (LOW, LOW, 0.0), (HIGH, HIGH, 0.0), (OPEN, LOW, None), (HIGH, OPEN, None)],
)
def test_bridge_voltage_drives_shorts_or_opens_the_phase(a: Output, b: Output, expected: float | None):
    assert bridge_voltage(a, b, 12.0, L293D_DROPS) == (None if expected is None else pytest.approx(expected))


def test_what_an_l293d_drops_is_against_the_current_in_every_state():
    """Driven: two transistors.  Idle: transistor and diode, nothing flows below their drop.  Against: two diodes."""
    flows, back = np.array(0.6), np.array(-0.6)
    given = {"supply": 12.0, "drop": 2.6, "knee": 0.01}
    assert phase_voltage(np.array(1.0), flows, **given) == pytest.approx(12 - 2.6, abs=1e-3)
    assert phase_voltage(np.array(-1.0), back, **given) == pytest.approx(-12 + 2.6, abs=1e-3)
    assert phase_voltage(np.array(0.0), flows, **given) == pytest.approx(-2.6, abs=1e-3)
    assert phase_voltage(np.array(-1.0), flows, **given) == pytest.approx(-12 - 2.6, abs=1e-3)
    # at rest, 2 V of back-EMF drive next to nothing through an idle phase of 34 ohm, 5 V what is left above the drop
    for emf, expected in ((2.0, 0.01), (5.0, (5 - 2.6) / 34)):
        amps = brentq(lambda i, e=emf: e + phase_voltage(np.array(0.0), np.array(i), **given) - 34 * i, 0, 1)
        assert amps == pytest.approx(expected, abs=2e-3)


def test_a_leg_that_turns_off_slower_than_the_other_turns_on_shorts_the_supply():
    quick = Bridge(turn_on=750e-9, turn_off=200e-9, dead_time=0.0)
    slow = Bridge(turn_on=100e-9, turn_off=900e-9, dead_time=300e-9)
    assert shoot_through(quick) == 0.0
    assert shoot_through(slow) == pytest.approx(500e-9)
    with pytest.raises(LimitError, match="500 ns at each change") as caught:
        check_dead_time(slow)
    assert "800 ns or more" in str(caught.value)
    check_dead_time(replace(slow, dead_time=800e-9))
    with pytest.raises(LimitError):
        HBridge(supply=12.0, turn_off=1e-6)


def test_currents_follow_ohm():
    assert fed(SHIELD, HBridge(supply=12.0)).current == pytest.approx(9.4 / 34)
    assert fed(BIG, SeriesResistor(supply=24.0, series=7.2)).current == pytest.approx(3.0)
    assert fed(BIG, Chopper(supply=24.0, current=2.0), 16).current == 2.0


def test_a_series_resistor_raises_the_torque_at_speed():
    """L/R: the same current at rest, a shorter time constant, more torque at speed."""
    plain = fed(BIG, HBridge(supply=2.4, drop=0.0))
    fast = fed(BIG, SeriesResistor(supply=24.0, series=7.2))
    assert fast.current == pytest.approx(plain.current)
    assert fast.motor.time_constant == pytest.approx(plain.motor.time_constant / 10)
    omega = np.array([BIG.speed(600)])
    assert fast.pull_out(omega)[0] > 2 * plain.pull_out(omega)[0]


def test_a_chopper_holds_its_torque_up_to_the_corner():
    made = fed(BIG, Chopper(supply=24.0, current=2.0, on_resistance=0.2), 16)
    corner = made.corner
    assert corner is not None
    amplitude = made.current_amplitude
    assert amplitude is not None
    flat = made.pull_out(np.array([0.0, 0.5 * corner, 0.999 * corner, 1.5 * corner]))
    assert flat[:3] == pytest.approx(BIG.torque_constant * amplitude)
    assert flat[3] < 0.95 * flat[0]


def test_fastest_is_where_the_load_takes_all():
    made = fed(BIG, Chopper(supply=24.0, current=2.0), 16)
    load = ShaftLoad(constant=0.2, friction=0.02)
    omega = made.fastest(load)
    assert float(made.pull_out(np.array(omega), load)) == pytest.approx(0.2, rel=1e-6)
    assert made.fastest(ShaftLoad(constant=5.0)) == 0.0
    # fast enough, the magnet drives K/(p L), 2.2 A, through the coils by itself: more than the 2 A that are set
    assert made.fastest() < math.inf
    assert fed(BIG, Chopper(supply=24.0, current=2.5), 16).fastest() == math.inf


def test_bad_currents_name_what_would_do():
    with pytest.raises(ConfigError, match=r"A supply above 3\.9 V would do"):
        fed(BIG, Chopper(supply=3.0, current=3.0), 16)
    with pytest.raises(ConfigError, match="A current of 2 A would do"):
        fed(BIG, Chopper(supply=24.0, current=3.0, current_limit=2.0), 16)
    with pytest.raises(ConfigError, match=r"carries 0\.6 A"):
        fed(BIG, HBridge(supply=12.0, current_limit=0.6))
    with pytest.raises(ConfigError, match="microsteps = 2 would do"):
        fed(BIG, Chopper(supply=24.0, current=2.0, excitation="half-step"), 16)
    with pytest.raises(ConfigError, match="no excitation is called"):
        fed(BIG, Chopper(supply=24.0, current=2.0, excitation="quarter"), 1)
    with pytest.raises(ConfigError, match="below the supply"):
        HBridge(supply=2.0)
    with pytest.raises(ConfigError, match="below off_time"):
        Chopper(supply=24.0, current=2.0, blanking=30e-6)


def test_heat_is_current_squared_times_resistance():
    made = fed(SHIELD, HBridge(supply=12.0, power_limit=2.075))
    warm = heat(made)
    amps = 9.4 / 34
    assert warm.motor == pytest.approx(2 * 34 * amps**2)
    assert warm.driver == pytest.approx(2 * 2.6 * amps)
    assert warm.problems() == []
    hot = heat(fed(BIG, Chopper(supply=24.0, current=4.0, excitation="two-phase", power_limit=5.0)))
    assert hot.motor == pytest.approx(2 * 0.8 * 16)
    assert [text.partition(" heats")[0] for text in hot.problems()] == ["the motor", "the driver"]


def test_series_and_parallel_halves_heat_alike_and_give_the_same_torque():
    halves = {name: wired(BIG, name) for name in ("unipolar", "series", "parallel")}
    loss = {name: m.resistance * m.current**2 for name, m in halves.items()}
    torque = {name: m.torque_constant * m.current for name, m in halves.items()}
    assert loss["series"] == pytest.approx(loss["unipolar"]) == pytest.approx(loss["parallel"])
    assert torque["series"] == pytest.approx(torque["parallel"]) == pytest.approx(math.sqrt(2) * torque["unipolar"])
    constants = {name: m.time_constant for name, m in halves.items()}
    assert constants["series"] == pytest.approx(constants["parallel"]) == pytest.approx(2 * constants["unipolar"])
    with pytest.raises(ConfigError, match="expected one of"):
        wired(BIG, "star")


@pytest.mark.parametrize("decay", ["slow", "fast", "mixed"])
def test_mean_voltage_stays_within_the_bridge_and_holds_a_current(decay: str):
    chopper = Chopper(supply=24.0, current=2.0, decay=decay)
    currents = np.linspace(-3, 3, 61)
    for level in (-1.0, -0.3, 0.0, 0.4, 1.0):
        volts = chopper.mean_voltage(
            np.full(61, level), currents, np.zeros(61), resistance=1.3, inductance=2.1e-3, lag=40e-6
        )
        assert np.abs(volts).max() <= 24.0
        if level:
            assert volts[currents * np.sign(level) < abs(level) * 2 - 0.4].max(initial=0.0) >= 0.0
    # held steadily, the voltage is the resistive drop
    held = np.array([1.0])
    ripple = 20e-6 / 2.1e-3 * (1.3 * 2.0 + chopper.fast_part * 24.0)
    mean = np.array([2.0 - ripple / 2])
    volts = chopper.mean_voltage(held, mean, np.zeros(1), resistance=1.3, inductance=2.1e-3, lag=40e-6)
    assert volts[0] == pytest.approx(1.3 * mean[0])
