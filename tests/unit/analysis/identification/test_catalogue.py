"""A linear DC model made from a catalogue's row gives the catalogue's other numbers within 1 %.

The rows are maxon's own data sheets, as public source files quote them (the 30 mm and 40 mm motors of 48 V: full
"values at nominal voltage" blocks in MATLAB comments; DCX 22 L: ``MotorSpecs.m`` of ``mattchg/ELEC441``, which gives
no time constant and has the two speeds swapped, as its nominal speed above its no-load speed shows).
"""

from __future__ import annotations

import math

import pytest

from trochia.machine.motors.dc import DcMotor

RPM = math.tau / 60.0
#: voltage, resistance, inductance, torque constant, inertia, no-load current;
#: no-load speed, stall torque, time constant
ROWS = {
    "30 mm, 48 V": (48.0, 2.45, 0.513e-3, 53.8e-3, 34.7e-7, 78.6e-3, 8490.0, 1.050, 2.94e-3),
    "40 mm, 48 V": (48.0, 1.13, 0.330e-3, 60.3e-3, 137e-7, 68.6e-3, 7590.0, 2.560, 4.28e-3),
    "DCX 22 L, 9 V": (9.0, 0.168, 0.018e-3, 6.95e-3, 9.37e-7, 118e-3, 12300.0, 0.371, None),
}


@pytest.mark.parametrize("name", ROWS)
def test_a_catalogue_s_row_gives_its_other_numbers(name: str) -> None:
    voltage, resistance, inductance, constant, inertia, idle, speed, stall, lag = ROWS[name]
    motor = DcMotor.from_catalogue(voltage=voltage, resistance=resistance, inductance=inductance,
                                   torque_constant=constant, inertia=inertia, no_load_current=idle)  # fmt: skip
    assert motor.no_load_speed(voltage) / RPM == pytest.approx(speed, rel=0.01)
    assert motor.stall_torque(voltage) == pytest.approx(stall, rel=0.01)
    if lag is not None:
        assert motor.time_constants[1] == pytest.approx(lag, rel=0.01)
        assert -1.0 / motor.poles()[0].real == pytest.approx(lag, rel=0.1)  # the winding's pole pulls at it a little
