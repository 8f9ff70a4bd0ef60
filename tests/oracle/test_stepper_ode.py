"""The stepper's twin against the textbook's other form of it, integrated by SciPy with steps of its own choice.

The twin follows the phases; here the equations are those of a permanent magnet machine in the rotor's axes (Krause):
d along the magnet, q across it, W = p w.

    L did/dt = vd - R id + W L iq        L diq/dt = vq - R iq - W L id - K w        T = K iq - D sin(4 p x)
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from trochia.backends.stepper_twin import StepperTwin
from trochia.machine.drivers import HBridge, fed
from trochia.machine.motors import HybridStepper, ShaftLoad

STIFF = HybridStepper(teeth=50, resistance=0.8, inductance=2.1e-3, current=3.0, inertia=209e-7, torque_constant=0.231,
                      detent=0.02, viscous=1e-3)  # fmt: skip
SLOW = HybridStepper(teeth=12, resistance=47.0, inductance=0.4, current=0.24, inertia=45e-7, torque_constant=0.25,
                     detent=5e-3, viscous=2e-4)  # fmt: skip
LOAD = ShaftLoad(inertia=1e-5, viscous=2e-4, constant=0.03)


def by_axes_of_the_rotor(
    motor: HybridStepper, load: ShaftLoad, volts: float, pulses: np.ndarray, end: float
) -> tuple[float, float, float, float]:
    """Return angle, speed and both currents at the end, from rest without current, both phases on by turns."""
    inertia, viscous = motor.inertia + load.inertia, motor.viscous + load.viscous

    def rates(_: float, y: np.ndarray, turn: float) -> tuple[float, ...]:
        i_d, i_q, x, w = y
        angle = motor.teeth * x
        v_d = math.sqrt(2) * volts * math.cos(turn - angle)
        v_q = math.sqrt(2) * volts * math.sin(turn - angle)
        cross = motor.teeth * w * motor.inductance
        torque = motor.torque_constant * i_q - motor.detent * math.sin(4 * angle)
        return (
            (v_d - motor.resistance * i_d + cross * i_q) / motor.inductance,
            (v_q - motor.resistance * i_q - cross * i_d - motor.torque_constant * w) / motor.inductance,
            w,
            (torque - viscous * w - load.constant) / inertia,
        )

    field = math.pi / 4
    y = np.array([0.0, 0.0, field / motor.teeth, 0.0])
    for begin, until in zip([0.0, *pulses], [*pulses, end], strict=True):
        solved = solve_ivp(rates, (begin, until), y, args=(field,), method="DOP853", rtol=1e-11, atol=1e-13)
        y, field = solved.y[:, -1], field + math.pi / 2
    angle = motor.teeth * y[2]
    a = y[0] * math.cos(angle) - y[1] * math.sin(angle)
    b = y[0] * math.sin(angle) + y[1] * math.cos(angle)
    return float(y[2]), float(y[3]), a, b


@pytest.mark.parametrize(
    ("motor", "load", "volts", "fastest"),
    [
        (STIFF, LOAD, 5.0, 300.0),
        (STIFF, LOAD, 24.0, 1500.0),  # swings hard
        (STIFF, LOAD, 5.0, 2500.0),  # falls out of step
        (SLOW, ShaftLoad(inertia=2e-6), 12.0, 150.0),
    ],
)
def test_a_ramp_ends_where_the_rotor_s_axes_say(motor: HybridStepper, load: ShaftLoad, volts: float, fastest: float):
    """An uneven ramp of 60 steps; one that swings hard shows the twin's 20 us most, at 7e-8 rad."""
    speeds = np.linspace(0.2, 1.0, 60) * fastest
    pulses = 0.01 + np.cumsum(1.0 / speeds)
    end = round((pulses[-1] + 0.01) / 20e-6) * 20e-6
    x, w, a, b = by_axes_of_the_rotor(motor, load, volts, pulses, end)
    twin = StepperTwin(fed(motor, HBridge(supply=volts, drop=0.0, excitation="two-phase")), load)
    twin.queue(pulses)
    run = twin.run(end)
    assert run.theta[-1] == pytest.approx(x, abs=2e-7)
    assert run.omega[-1] == pytest.approx(w, abs=2e-4)
    np.testing.assert_allclose(run.currents[-1], [a, b], atol=1e-5 * motor.current)
    assert (run.lost_steps[-1] != 0) == (fastest > 2000)
