"""Experiments are refused before they move, stopped while they do, and leave the motor off by whatever way they end."""

from __future__ import annotations

import numpy as np
import pytest

from trochia.errors import ConfigError, LimitError
from trochia.experiments import Bounds, TwinAxis, perform, powered
from trochia.experiments.reversal import at_switch
from trochia.experiments.signals import multisine, parabolic, steady
from trochia.machine.friction import Friction
from trochia.machine.servo_plant import Amplifier, Mode, ServoPlant
from trochia.servo import Loop, Pid

PERIOD = 1e-3
PLANT = ServoPlant(amplifier=Amplifier(current=10.0), torque_constant=0.1, motor_inertia=1e-3, counts=5000.0,
                   motor_friction=Friction(coulomb=0.02, viscous=1e-3))  # fmt: skip
LOOP = Loop(period=PERIOD, position=Pid(kp=20.0), speed=Pid(kp=0.8, ki=8.0), speed_forward=1.0, limit=10.0)
BOUNDS = Bounds(low=-5.0, high=5.0, speed=50.0, command=10.0, current=10.0)


class Broken(TwinAxis):
    """An axis whose line breaks."""

    def advance(self, wanted, injected=None):  # type: ignore[no-untyped-def]
        super().advance(wanted, injected)
        raise RuntimeError("the line is dead")


@pytest.mark.parametrize(
    ("wanted", "injected", "what"),
    [
        (steady(0.0, 60.0, 50, PERIOD), None, "would run at 60"),
        (steady(0.0, 20.0, 500, PERIOD), None, "would go from 0 to 9.98"),
        (steady(0.0, 0.0, 50, PERIOD), np.full(50, 11.0), "would command 11"),
    ],
)
def test_what_would_leave_the_bounds_is_refused_before_it_moves(
    wanted: np.ndarray, injected: np.ndarray | None, what: str
) -> None:
    axis = TwinAxis(PLANT, PERIOD)
    with pytest.raises(LimitError, match=what) as raised:
        perform(axis, LOOP, BOUNDS, wanted, injected)
    assert "Nothing has moved" in str(raised.value)
    assert axis.position == 0.0
    assert not axis.enabled


def test_an_axis_that_runs_away_is_stopped_and_off() -> None:
    axis = TwinAxis(PLANT, PERIOD)
    wrong = Loop(period=PERIOD, position=Pid(kp=-20.0), speed=Pid(kp=0.8, ki=8.0), limit=10.0)
    with pytest.raises(LimitError, match="stopped: travel was exceeded"):
        perform(axis, wrong, BOUNDS, np.tile([1.0, 0.0, 0.0], (20000, 1)))
    assert not axis.enabled
    assert abs(axis.position) < 6.5  # a block of 10 ms late, not more
    samples = axis.advance(np.zeros((3000, 3)), np.full(3000, 5.0))
    assert (samples.command == 0.0).all(), "an axis that is off takes no command"


def test_too_much_current_is_stopped() -> None:
    axis = TwinAxis(PLANT, PERIOD)
    with pytest.raises(LimitError, match="stopped: current was exceeded"):
        perform(axis, LOOP, Bounds(low=-50.0, high=50.0, current=2.0), np.tile([10.0, 0.0, 0.0], (500, 1)))
    assert not axis.enabled


@pytest.mark.parametrize("failure", [RuntimeError, KeyboardInterrupt, SystemExit])
def test_whatever_happens_inside_the_motor_is_off_behind_it(failure: type[BaseException]) -> None:
    axis = TwinAxis(PLANT, PERIOD)

    def inside() -> None:
        with powered(axis, LOOP):
            assert axis.enabled
            raise failure

    with pytest.raises(failure):
        inside()
    assert not axis.enabled


def test_a_broken_line_leaves_the_motor_off() -> None:
    axis = Broken(PLANT, PERIOD)
    with pytest.raises(RuntimeError, match="dead"):
        perform(axis, LOOP, BOUNDS, steady(0.0, 1.0, 500, PERIOD))
    assert not axis.enabled


def test_a_loop_of_another_period_is_refused_with_the_motor_off() -> None:
    axis = TwinAxis(PLANT, PERIOD)
    with pytest.raises(ConfigError, match=r"ticks every 0\.001 s"):
        perform(axis, Loop(period=2e-3), BOUNDS, steady(0.0, 1.0, 10, PERIOD))
    assert not axis.enabled


def test_bounds_and_amplifiers_that_cannot_be_are_named() -> None:
    with pytest.raises(ConfigError, match="before it begins"):
        Bounds(low=1.0, high=0.0)
    with pytest.raises(ConfigError, match="current: must be above zero"):
        Bounds(low=0.0, high=1.0, current=0.0)
    with pytest.raises(ConfigError, match="one of current"):
        TwinAxis(ServoPlant(amplifier=Amplifier(mode=Mode.VOLTAGE), motor_inertia=1.0), PERIOD)


def test_a_move_s_set_points_are_each_other_s_derivatives() -> None:
    wanted = parabolic(1.0, 2.0, 0.5, PERIOD)
    assert wanted[0, 0] == 1.0
    assert wanted[-1, 0] == pytest.approx(3.0)
    np.testing.assert_allclose(np.gradient(wanted[:, 0], PERIOD)[1:-1], wanted[1:-1, 1], atol=1e-4)
    np.testing.assert_allclose(np.gradient(wanted[:, 1], PERIOD)[1:-1], wanted[1:-1, 2], atol=1e-9)


def test_a_multisine_is_on_its_lines_only_and_of_unit_size() -> None:
    sines = multisine(4000, PERIOD, (1.0, 300.0))
    spectrum = np.abs(np.fft.rfft(sines.values))
    assert np.sqrt(np.mean(sines.values**2)) == pytest.approx(1.0)
    assert (sines.lines % 2 == 1).all()
    assert np.delete(spectrum, sines.lines).max() < 1e-9 * spectrum.max()
    with pytest.raises(ConfigError, match="no band"):
        multisine(4000, PERIOD, (1.0, 450.0))


GAPPED = ServoPlant(
    amplifier=Amplifier(current=10.0), torque_constant=0.1, motor_inertia=5e-4, load_inertia=5e-4, stiffness=20.0,
    damping=5e-3, gap=0.01, counts=5000.0, motor_friction=Friction(coulomb=0.02, viscous=1e-3),
    load_friction=Friction(coulomb=0.03, viscous=1e-3),
)  # fmt: skip


def test_the_limit_switch_tells_the_gap_to_a_count() -> None:
    axis = TwinAxis(GAPPED, PERIOD, limit=0.5)
    run = at_switch(axis, LOOP, BOUNDS, speed=0.2, wind_up=2.0 * 0.03 / 20.0)
    assert abs(run.gap - GAPPED.gap) < 1.0 / 5000.0
    assert run.gap == pytest.approx(run.back_length - run.slip - 0.003)
    assert not axis.enabled


def test_a_switch_that_never_closes_is_named_and_the_motor_off() -> None:
    axis = TwinAxis(GAPPED, PERIOD)
    with pytest.raises(LimitError, match="did not close within the travel"):
        at_switch(axis, LOOP, Bounds(low=-0.2, high=0.2), speed=0.5)
    assert not axis.enabled
