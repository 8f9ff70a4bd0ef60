"""Excitation tables and latch bytes against what a shield really puts out."""

from __future__ import annotations

import math

import numpy as np
import pytest

from trochia.errors import ConfigError
from trochia.pulses.excitation import EXCITATIONS, excitation, microstep
from trochia.pulses.latch import latch_byte, serial_bits

MODES = [*EXCITATIONS, "microstep-2", "microstep-10", "microstep-64", "microstep-256"]
#: mode -> bytes for motor 1 and for motor 2, one electrical turn
BYTES = {
    "one-phase": ("04 02 08 10", "20 01 80 40"),
    "two-phase": ("06 0a 18 14", "21 81 c0 60"),
    "half-step": ("04 06 02 0a 08 18 10 14", "20 21 01 81 80 c0 40 60"),
}


@pytest.mark.parametrize("mode", BYTES)
@pytest.mark.parametrize("shield_motor", [1, 2])
def test_latch_bytes(mode: str, shield_motor: int):
    expected = list(bytes.fromhex(BYTES[mode][shield_motor - 1]))
    assert [latch_byte(row, shield_motor) for row in EXCITATIONS[mode].levels] == expected


def test_latch_keeps_the_other_motor():
    both = latch_byte((1, -1), 1, image=latch_byte((-1, -1), 2))
    assert both == 0x14 | 0xC0
    assert latch_byte((0, 0), 1, image=both) == 0xC0  # released


def test_latch_is_shifted_out_from_bit_seven():
    assert serial_bits(0x14) == (0, 0, 0, 1, 0, 1, 0, 0)


@pytest.mark.parametrize(("motor", "image"), [(0, 0), (3, 0), (1, 256), (1, -1)])
def test_latch_refuses_what_the_shield_has_not(motor: int, image: int):
    with pytest.raises(ConfigError):
        latch_byte((1, 0), motor, image)


@pytest.mark.parametrize("name", MODES)
def test_the_field_turns_by_even_steps(name: str):
    mode = excitation(name)
    angle = np.unwrap(np.arctan2(mode.levels[:, 1], mode.levels[:, 0]))
    tolerance = 3e-3 if name == "microstep-table" else 1e-12  # the table has 8 bits
    np.testing.assert_allclose(np.diff(angle), mode.step_angle, atol=tolerance)
    assert angle[0] == pytest.approx(mode.first_angle)
    assert len(mode.levels) == 4 * mode.steps_per_full_step
    assert np.abs(mode.levels).max() <= 1


@pytest.mark.parametrize("name", MODES)
def test_backwards_is_the_same_table_read_backwards(name: str):
    mode = excitation(name)
    n = len(mode.levels)
    forward, back = mode.sequence(3 * n + 1), mode.sequence(-3 * n - 1)
    np.testing.assert_array_equal(forward[-1], mode.levels[1])
    np.testing.assert_array_equal(forward[: n - 1], back[: n - 1][::-1])
    np.testing.assert_array_equal(mode.sequence(1, start=n - 1)[0], mode.levels[0])


def test_clockwise_is_a_plus_b_plus_a_minus_b_minus():
    turn = [(1, 0), (0, 1), (-1, 0), (0, -1)]
    assert [tuple(row) for row in EXCITATIONS["one-phase"].levels] == turn


def test_torque_of_the_modes_at_rest():
    peaks = {name: EXCITATIONS[name].peak for name in EXCITATIONS}
    assert peaks["two-phase"] / peaks["one-phase"] == pytest.approx(math.sqrt(2))  # the usual 30 to 40 % more
    assert microstep(32).peak / peaks["two-phase"] == pytest.approx(1 / math.sqrt(2))  # the usual 30 % less
    half = np.hypot(*EXCITATIONS["half-step"].levels.T).mean()  # one phase and both in turn
    assert half / peaks["two-phase"] == pytest.approx(0.85, abs=0.01)  # the usual 15 % less


@pytest.mark.parametrize("name", MODES)
def test_fundamental_is_fouriers(name: str):
    mode = excitation(name)
    n = len(mode.levels)
    fine = 512
    held = np.repeat(mode.levels[:, 0], fine)
    turn = np.exp(-2j * np.pi * (np.arange(n * fine) + 0.5) / (n * fine))
    assert mode.fundamental == pytest.approx(2 * abs((held * turn).mean()), rel=1e-6)


def test_fundamentals_of_full_steps():
    assert EXCITATIONS["two-phase"].fundamental == pytest.approx(4 / math.pi)
    assert EXCITATIONS["one-phase"].fundamental == pytest.approx(2 * math.sqrt(2) / math.pi)


def test_microstep_table_is_eight_bits_of_a_sine():
    duty = EXCITATIONS["microstep-table"].levels[:17, 1] * 255
    np.testing.assert_allclose(duty, np.rint(duty), atol=1e-12)
    assert (duty[0], duty[8], duty[16]) == (0, 180, 255)
    assert len(EXCITATIONS["microstep-table"].levels) == 64


def test_tables_cannot_be_changed():
    with pytest.raises(ValueError, match="read-only"):
        EXCITATIONS["one-phase"].levels[0, 0] = 2


@pytest.mark.parametrize("name", ["microstep-1", "microstep-257", "microstep-", "full", ""])
def test_unknown_modes_are_refused(name: str):
    with pytest.raises(ConfigError):
        excitation(name)
