"""What every switching of a chopper gives: ripple, the current that blanking keeps, the energy of the supply."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from trochia.backends.stepper_twin import MEAN, SWITCHED, StepperRun, StepperTwin
from trochia.machine.drivers import Chopper, Fed, fed
from trochia.machine.motors import ShaftLoad, motor

BIG = motor("QSH5718-55").parameters()
LOCKED = ShaftLoad(inertia=1e3)
US = 1e-6


def still(chopper: Chopper, *, row: int = 0, mean: bool = False) -> tuple[Fed, StepperRun]:
    """Return a rotor that cannot turn, 16 microsteps on some row, each microsecond of its last 5 ms or the mean."""
    made = fed(BIG, chopper, 16)
    twin = StepperTwin(made, LOCKED, levels=MEAN if mean else SWITCHED, step=20 * US if mean else US)
    if row:
        twin.queue(10 * US * np.arange(1, row + 1))
    twin.run(0.025)
    return made, twin.run(0.005)


@pytest.mark.parametrize("decay", ["slow", "fast", "mixed"])
@pytest.mark.parametrize("off_time", [20 * US, 50 * US])
def test_ripple_is_what_the_off_time_lets_fall(decay: str, off_time: float):
    """Peak at the set current, within a step's rise; from there R, L and what the bridge puts against it, exactly."""
    chopper = Chopper(supply=24.0, current=2.0, decay=decay, mixed=0.4, off_time=off_time)
    made, run = still(chopper)
    resistance, tau = made.motor.resistance, made.motor.time_constant
    fast = chopper.fast_part * off_time
    turn = (2.0 + 24.0 / resistance) * math.exp(-fast / tau) - 24.0 / resistance
    low = turn * math.exp(-(off_time - fast) / tau)
    amps = run.currents[:, 0]
    rise = US * 24.0 / made.motor.inductance
    assert 2.0 <= amps.max() <= 2.0 + rise
    assert low <= amps.min() <= low + rise
    rising = made.motor.inductance * (2.0 - low) / (24.0 - resistance * (2.0 + low) / 2)
    parts = (2.0 + turn) * fast + (turn + low) * (off_time - fast) + (low + 2.0) * rising  # three straight lines
    assert amps.mean() == pytest.approx(parts / 2 / (off_time + rising), abs=rise)
    linear = chopper.ripple(np.array(2.0), np.array(0.0), resistance=resistance, inductance=made.motor.inductance)
    assert 2.0 - low == pytest.approx(float(linear), rel=0.03)  # what the mean model has of it


@pytest.mark.parametrize("blanking", [1 * US, 2 * US])
@pytest.mark.parametrize("row", [13, 15])
def test_slow_decay_keeps_what_the_blanking_drives(blanking: float, row: int):
    """A known fault of slow decay: V t_blank/(R (t_off + t_blank)) flows whatever less is asked, in both models."""
    chopper = Chopper(supply=24.0, current=2.0, decay="slow", blanking=blanking)
    made, run = still(chopper, row=row)
    asked = 2.0 * math.cos(row * math.pi / 32)
    least = 24.0 * blanking / (made.motor.resistance * (chopper.off_time + blanking))
    assert least == pytest.approx(chopper.least_current(made.motor.resistance))
    assert asked < 0.8 * least
    assert run.currents[:, 0].mean() == pytest.approx(least, rel=5e-3)
    assert still(chopper, row=row, mean=True)[1].currents[-1, 0] == pytest.approx(least, rel=5e-3)


@pytest.mark.parametrize("decay", ["mixed", "fast"])
@pytest.mark.parametrize("row", [9, 13, 15])
def test_with_fast_decay_small_currents_are_held(decay: str, row: int):
    chopper = Chopper(supply=24.0, current=2.0, decay=decay, blanking=2 * US)
    made, run = still(chopper, row=row)
    asked = 2.0 * math.cos(row * math.pi / 32)
    below = chopper.ripple(np.array(asked), np.array(0.0), resistance=made.motor.resistance,
                           inductance=made.motor.inductance)  # fmt: skip
    assert chopper.least_current(made.motor.resistance) == 0
    # what falls is as great for a small current as for a great one; a diode ends it at nothing
    assert run.currents[:, 0].max() <= asked + 2 * US * 24.0 / made.motor.inductance
    assert asked - float(below) - 0.01 <= run.currents[:, 0].mean() <= asked
    assert still(chopper, row=row, mean=True)[1].currents[-1, 0] == pytest.approx(run.currents[:, 0].mean(), abs=0.05)


@pytest.mark.parametrize("decay", ["slow", "mixed", "fast"])
def test_energy_of_the_supply_is_kept(decay: str):
    """The bridge gives its supply, nothing, or takes it back; what came is heat, work, motion or in the windings."""
    stepper = replace(BIG, detent=0.0, viscous=2e-3)
    chopper = Chopper(supply=24.0, current=2.0, decay=decay, on_resistance=0.0)
    made, load = fed(stepper, chopper, 16), ShaftLoad(inertia=2e-5, constant=0.1)
    twin = StepperTwin(made, load, levels=SWITCHED, step=US)
    twin.run(0.05)
    twin.queue(twin.now + np.sqrt(np.arange(1, 800) / 20000.0))
    run = twin.run(0.15)
    i, theta, omega = run.currents, run.theta, run.omega
    left = math.exp(-US / made.motor.time_constant)
    gain = (1 - left) / made.motor.resistance
    emf = made.motor.back_emf(theta[:-1], omega[:-1])
    volts = emf + (i[1:] - left * i[:-1]) / gain
    ends = (i[1:] == 0) | (i[:-1] == 0)  # a diode cuts the step short
    put = 24.0 * np.rint(volts / 24.0)
    assert np.abs((volts - put)[~ends]).max() < 1e-6
    assert set(np.unique(put[~ends]).tolist()) <= {-24.0, 0.0, 24.0}
    put[ends] = volts[ends]

    def between(x: np.ndarray) -> np.ndarray:
        return (x[1:] + x[:-1]) / 2

    given = float((put * between(i)).sum() * US)
    heat = float(between((made.motor.resistance * i**2).sum(axis=1) + 2e-3 * omega**2).sum() * US)
    lifted = 0.1 * float(theta[-1] - theta[0])
    stored = 0.5 * (made.motor.inductance * (i**2).sum(axis=1) + (stepper.inertia + 2e-5) * omega**2)
    assert run.lost_steps[-1] == 0
    assert lifted > 0.08
    assert given == pytest.approx(heat + lifted + float(stored[-1] - stored[0]), rel=2e-3)
