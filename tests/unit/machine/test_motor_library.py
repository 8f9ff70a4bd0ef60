"""Catalogue rows to parameters, the library of motors, and the geometry of reluctance motors."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest

from trochia.errors import ConfigError, UnitError
from trochia.machine.motors import CatalogueStepper, ReluctanceStepper, library, motor, rows_of

ROW = """
[motors.M]
full_steps = 200
resistance = "2 ohm"
inductance = "4 mH"
current = "1.5 A"
holding_torque = "0.3 N·m"
inertia = "50 g·cm²"
source = "a data sheet"
checked = true
read = "2026-11-23"
"""


def with_line(line: str) -> str:
    key = line.split(" =", maxsplit=1)[0]
    kept = [row for row in ROW.splitlines() if not row.startswith(f"{key} ")]
    return "\n".join([*kept, line])


def test_torque_constant_takes_both_phases_on_unless_told():
    two = rows_of(ROW)["M"]
    one = rows_of(with_line("phases_on = 1"))["M"]
    assert two.torque_constant == pytest.approx(0.3 / (1.5 * math.sqrt(2)))
    assert one.torque_constant == pytest.approx(0.3 / 1.5)


def test_catalogue_units_become_si():
    parameters = rows_of(with_line('detent_torque = "2.1 N·cm"'))["M"].parameters()
    assert parameters.teeth == 50
    assert parameters.inertia == pytest.approx(50e-7)
    assert parameters.inductance == pytest.approx(4e-3)
    assert parameters.detent == pytest.approx(0.021)
    assert parameters.full_steps == 200
    assert math.degrees(parameters.step_angle) == pytest.approx(1.8)


@pytest.mark.parametrize("name", library())
def test_every_motor_of_the_library_is_plausible(name: str):
    row = motor(name)
    parameters = row.parameters()
    # both phases at rated current give back the catalogue's holding torque
    assert math.sqrt(row.phases_on) * parameters.torque_constant * row.current == pytest.approx(row.holding_torque)
    assert 0.2e-3 < parameters.time_constant < 20e-3
    # implied: rotors of steppers accelerate alike, and the magnet's flux is of the size of the rated current's
    assert 1e4 < row.holding_torque / row.inertia < 1e5
    assert 0.2 < parameters.torque_constant / (parameters.teeth * parameters.inductance * parameters.current) < 1.25
    assert row.detent_torque < 0.12 * row.holding_torque
    assert row.source
    assert row.checked == (row.read is not None)
    if row.voltage is not None:
        assert row.voltage == pytest.approx(row.current * row.resistance, rel=0.1)


def test_the_motor_of_the_shield_has_the_published_constant():
    parameters = motor("SM-42BYG011-25").parameters()
    assert parameters.torque_constant == pytest.approx(0.49, abs=0.005)
    assert parameters.time_constant == pytest.approx(1.35e-3, abs=0.01e-3)


@pytest.mark.parametrize(
    ("line", "error", "says"),
    [
        ('resistance = "0 ohm"', ConfigError, "motors.M.resistance: must be above zero"),
        ('resistance = "2 mH"', UnitError, "resistance"),
        ("full_steps = 201", ConfigError, "200 or 204 would do"),
        ("full_steps = 3", ConfigError, "4 is the least"),
        ("full_steps = 0", ConfigError, "above zero"),
        ("full_steps = 200.5", ConfigError, "whole number"),
        ('resistance = "-2 ohm"', ConfigError, 'above zero, not "-2 ohm"'),
        ('kind = "reluctance"', ConfigError, "one of hybrid, permanent-magnet"),
        ('read = "yesterday"', ConfigError, "expected a day"),
        ('assumed = "inertia, indctance"', ConfigError, "did you mean inductance"),
        ('inertia = "50 gcm"', UnitError, "inertia"),
        ("phases_on = 3", ConfigError, "must be 1 or 2, not 3"),
        ('detent_torque = "0.4 N·m"', ConfigError, "below the holding torque"),
        ('indutance = "4 mH"', ConfigError, "inductance"),
    ],
)
def test_an_absurd_row_is_named_with_its_line(line: str, error: type[Exception], says: str):
    with pytest.raises(error, match=says) as caught:
        rows_of(with_line(line), "my.toml")
    assert str(caught.value).startswith("my.toml:")


def test_unknown_motor_names_the_near_one():
    with pytest.raises(ConfigError, match="QSH5718-41"):
        motor("QSH5718-40")


def test_a_row_needs_no_source_but_one_that_was_checked_says_where_and_when():
    own = "\n".join(row for row in ROW.splitlines() if not row.startswith(("source", "checked", "read")))
    assert not rows_of(own)["M"].checked
    for missing in ("source", "read"):
        text = "\n".join(row for row in ROW.splitlines() if not row.startswith(missing))
        with pytest.raises(ConfigError, match=f"motors.M.{missing}: missing; a row that was checked"):
            rows_of(text)


def test_units_as_catalogues_print_them():
    for line, value in (('holding_torque = "3 kg.cm"', 0.2942), ('holding_torque = "42 oz-in"', 0.29659),
                        ('holding_torque = "30 N.cm"', 0.3), ('holding_torque = "3000 gf·cm"', 0.2942)):  # fmt: skip
        assert rows_of(with_line(line))["M"].holding_torque == pytest.approx(value, rel=1e-4)
    for line, value in (('inertia = "50 g.cm2"', 50e-7), ('inertia = "50 g-cm^2"', 50e-7),
                        ('inertia = "0.3 oz-in²"', 54.87e-7)):  # fmt: skip
        assert rows_of(with_line(line))["M"].inertia == pytest.approx(value, rel=1e-3)


@pytest.mark.parametrize("text", ["[motors.M\n", "[motor.M]\n", "motors = 3\n"])
def test_a_text_that_is_no_library_is_refused(text: str):
    with pytest.raises(ConfigError):
        rows_of(text)


def test_catalogue_checks_hold_without_a_file():
    with pytest.raises(ConfigError, match="inertia"):
        CatalogueStepper(full_steps=200, resistance=1.0, inductance=1e-3, current=1.0, holding_torque=0.1,
                         inertia=math.nan, source="", checked=False)  # fmt: skip


@pytest.mark.parametrize(
    ("poles", "teeth", "per_phase", "expected"),
    [(8, 6, 2, (15, 24, -1)), (6, 4, 2, (30, 12, -1)), (12, 8, 4, (15, 24, -1)), (8, 10, 2, (9, 40, 1))],
)
def test_reluctance_geometry(poles: int, teeth: int, per_phase: int, expected: tuple[int, ...]):
    stepper = ReluctanceStepper(poles=poles, teeth=teeth, poles_per_phase=per_phase)
    assert (stepper.step_angle_deg, stepper.full_steps, stepper.direction) == expected
    assert stepper.full_steps * stepper.step_angle_deg == 360
    assert stepper.phase_shift == pytest.approx(2 * math.pi / (poles / per_phase))


def test_reluctance_rotor_follows_the_nearest_tooth():
    """The direction, found by looking: excite the phases in turn and let the nearest tooth come under the pole."""
    stepper = ReluctanceStepper(poles=8, teeth=6)
    pitch, angle, moved = Fraction(360, 6), Fraction(0), []
    for phase in range(1, 5):
        pole = Fraction(360 * phase, 8)
        gap = (pole - angle + pitch / 2) % pitch - pitch / 2  # from the nearest tooth to the pole
        angle += gap
        moved.append(gap)
    assert moved == [stepper.direction * stepper.step_angle_deg] * 4


@pytest.mark.parametrize(
    ("poles", "teeth", "per_phase"), [(8, 7, 2), (8, 6, 3), (8, 6, 4), (0, 6, 2), (4, 6, 2), (4, 2, 2)]
)
def test_uneven_reluctance_geometry_is_refused(poles: int, teeth: int, per_phase: int):
    with pytest.raises(ConfigError):
        ReluctanceStepper(poles=poles, teeth=teeth, poles_per_phase=per_phase)
