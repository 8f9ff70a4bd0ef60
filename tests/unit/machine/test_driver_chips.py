"""Driver chips by name: in a machine file, with their own figures, held to what they can."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import click
import numpy as np
import pytest

from trochia import api
from trochia.cli import motor_options
from trochia.errors import MachineError
from trochia.machine.drivers import CHIPS, DRIVERS, Chopper, HBridge, fed
from trochia.machine.motors import motor

PAGE = Path(__file__).parents[3] / "docs" / "reference" / "machine-file.md"
SMALL = motor("QSH5718-41").parameters()
FILE = """format = 1
name = "stage"
kinematics = "cartesian"
[axes.X]
minimum = "0 mm"
maximum = "300 mm"
velocity = "100 mm/s"
acceleration = "1000 mm/s²"
[joints.X]
motor = {{ kind = "stepper", microsteps = {microsteps}, library = "QSH5718-41" }}
driver = {driver}
transmission = {{ kind = "belt", pitch = "2 mm", teeth = 20 }}
"""


def loaded(tmp_path: Path, driver: str, microsteps: int = 16):
    path = tmp_path / "machine.toml"
    path.write_text(FILE.format(driver=driver, microsteps=microsteps), encoding="utf-8")
    return api.load(path)


def test_a_chip_is_named_in_a_machine_file_and_any_figure_overridden(tmp_path: Path):
    machine = loaded(tmp_path, '{ kind = "A4988", supply = "24 V", current = "1 A", off_time = "25 us" }')
    driver = machine.joints[0].driver
    assert isinstance(driver, Chopper)
    assert (driver.kind, driver.off_time, driver.on_resistance, driver.current_limit) == ("A4988", 25e-6, 0.71, 2.0)


@pytest.mark.parametrize(
    ("driver", "microsteps", "words"),
    [
        ('{ kind = "TMC2209", supply = "36 V", current = "1 A" }', 16, ["supply", "4.75 to 29 V", "36 V"]),
        ('{ kind = "A4988", supply = "24 V", current = "2.5 A" }', 16, ["2.5 A", "carries 2 A", "would do"]),
        ('{ kind = "A4988", supply = "24 V", current = "1 A" }', 32, ["A4988 has 1, 2, 4, 8, 16", "not 32"]),
        ('{ kind = "A4898", supply = "24 V", current = "1 A" }', 16, ["kind", "A4988"]),
        ('"A4988"', 16, ["driver", 'kind = "A4988"']),
        ('{ kind = "L293D", supply = "12 V" }', 1, ["15.7 A", "carries 0.6 A", "15.7 ohm a phase or more"]),
    ],
)
def test_what_a_chip_cannot_do_is_refused_with_what_it_can(
    tmp_path: Path, driver: str, microsteps: int, words: list[str]
):
    with pytest.raises(MachineError) as caught:
        loaded(tmp_path, driver, microsteps)
    for word in words:
        assert word in str(caught.value)


@pytest.mark.parametrize("name", [name for name, cls in CHIPS.items() if issubclass(cls, Chopper)])
def test_a_chip_keeps_the_length_of_the_field_in_every_mode(name: str):
    driver = CHIPS[name](supply=24.0, current=1.0)  # type: ignore[call-arg]
    assert driver.chip is not None
    for microsteps in driver.chip.microsteps:
        levels = fed(SMALL, driver, microsteps).excitation.levels
        assert np.hypot(*levels.T) == pytest.approx(1.0)


def test_the_supply_that_a_bridge_is_told_of_keeps_to_its_limit():
    """12 V through 10 ohm are too much for an L293D; what the hint says is not, nor is a volt more right."""
    small = replace(SMALL, resistance=10.0)
    with pytest.raises(MachineError) as caught:
        fed(small, CHIPS["L293D"](supply=12.0))
    told = re.search(r"A supply of ([\d.]+) V would do", str(caught.value))
    assert told
    assert fed(small, CHIPS["L293D"](supply=float(told[1]))).current == pytest.approx(0.6, abs=1e-3)
    with pytest.raises(MachineError):
        fed(small, CHIPS["L293D"](supply=float(told[1]) + 0.1))


def test_a_bridge_chip_gives_both_phases_all():
    made = fed(motor("SM-42BYG011-25").parameters(), CHIPS["L293D"](supply=12.0))
    assert made.current == pytest.approx(9.4 / 34)
    assert made.excitation.peak == pytest.approx(2**0.5)


def test_the_reference_page_has_every_chip_as_it_is():
    text = PAGE.read_text(encoding="utf-8")
    for name, cls in CHIPS.items():
        given = {"current": 0.1} if issubclass(cls, Chopper) else {}
        driver, chip = cls(supply=24.0, **given), cls.chip
        assert chip is not None
        cells = [f"`{name}`", f"{chip.supply[0]:g} … {chip.supply[1]:g}", f"{driver.current_limit:g}",
                 ", ".join(map(str, chip.microsteps))]  # fmt: skip
        cells += [""] * 4 if isinstance(driver, HBridge) else [
            f"{driver.off_time * 1e6:g}", f"{driver.blanking * 1e6:g}", f"{driver.mixed:g}", f"{driver.on_resistance:g}"
        ]  # fmt: skip
        cells.append("yes" if chip.checked else "no")
        row = " ".join("|" if not cell else f"| {cell}" for cell in cells) + " |"
        assert row in text, row


def test_the_command_line_knows_every_kind():
    option = next(made for made in click_options() if made.name == "driver")
    assert isinstance(option.type, click.Choice)
    assert list(option.type.choices) == list(DRIVERS)


def click_options() -> list[click.Option]:
    made = click.command()(motor_options.motor_options(lambda **_: None))
    return [parameter for parameter in made.params if isinstance(parameter, click.Option)]
