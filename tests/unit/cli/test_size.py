"""``trochia size`` against the formulas of a textbook, worked by hand."""

from __future__ import annotations

import json
import math
import re
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner

from trochia.cli.size import command
from trochia.machine.motors import library

if TYPE_CHECKING:
    from click.testing import Result

BEHIND = ("--motor", "QSH5718-55", "--supply", "24 V", "--current", "2 A")
ROTOR = 209e-7  # kg·m²


def run(*args: str) -> Result:
    return CliRunner().invoke(command, args)


def told(*args: str) -> dict[str, float]:
    return json.loads(run(*args, "--json").stdout)


def test_a_vertical_screw_by_hand():
    """10 kg on 5 mm, 40 % efficient, up at 0.5 m/s² to 50 mm/s, with 20 N of friction.

    T = (m g + F) p/(2π η) + (J_rotor + m (p/2π)²/η) a 2π/p; 50 mm/s are 600 rpm.
    """
    arm = 5e-3 / math.tau
    inertia = ROTOR + 10 * arm**2 / 0.4
    torque = (10 * 9.80665 + 20) * arm / 0.4 + inertia * 0.5 / arm
    found = told(*BEHIND, "--travel-per-turn", "5 mm", "--mass", "10 kg", "--vertical", "--friction", "20 N",
                 "--efficiency", "40 %", "--speed", "50 mm/s", "--acceleration", "500 mm/s2")  # fmt: skip
    assert found["speed_rpm"] == pytest.approx(600.0)
    assert found["torque_Nm"] == pytest.approx(torque)
    assert found["inertia_ratio"] == pytest.approx(10 * arm**2 / 0.4 / ROTOR)
    assert found["margin"] == pytest.approx(1 - torque / found["available_Nm"])


def test_a_belt_by_hand():
    """1 kg on a pulley of 20 teeth of 2 mm (40 mm a turn): 200 mm in 0.4 s, a third each, then 0.6 s of rest.

    v = 3 d/2 t = 750 mm/s, a = 9 d/2 t² = 5.625 m/s²; effective torque: two thirds of the move at J a, all over 1 s.
    """
    arm = 40e-3 / math.tau
    torque = (ROTOR + 1.0 * arm**2) * 5.625 / arm
    found = told(*BEHIND, "--travel-per-turn", "40 mm", "--mass", "1 kg", "--move", "200 mm", "--time", "0.4 s",
                 "--rest", "0.6 s")  # fmt: skip
    assert found["speed_rpm"] == pytest.approx(750 / 40 * 60)
    assert found["torque_Nm"] == pytest.approx(torque)
    assert found["effective_torque_Nm"] == pytest.approx(torque * math.sqrt(0.4 * 2 / 3))


def test_a_bare_shaft_by_hand():
    """50 g·cm² and 30 mN·m of friction: 90 degrees in 50 ms, so 2700 deg/s at 162000 deg/s²."""
    found = told(*BEHIND, "--inertia", "50 g·cm²", "--friction", "30 mN·m", "--move", "90 deg", "--time", "0.05 s")
    assert found["speed_rpm"] == pytest.approx(450.0)
    assert found["torque_Nm"] == pytest.approx((ROTOR + 50e-7) * math.radians(162_000) + 0.03)
    same = told(*BEHIND, "--inertia", "50 g·cm²", "--friction", "30 mN·m", "--speed", "450 rpm", "--acceleration",
                f"{math.radians(162_000)} rad/s2")  # fmt: skip
    assert same["torque_Nm"] == pytest.approx(found["torque_Nm"])


def test_heat_is_that_of_the_current_not_of_the_load():
    """A stepper's phases carry their current whatever it turns: 16 microsteps share I² R, 4 · 0.8 W."""
    light = told(*BEHIND, "--speed", "60 rpm", "--acceleration", "10 rad/s2")
    heavy = told(*BEHIND, "--speed", "60 rpm", "--acceleration", "10 rad/s2", "--friction", "0.1 N·m")
    assert light["heat_W"] == heavy["heat_W"]
    assert light["heat_W"]["motor"] == pytest.approx(2.0**2 * 0.8)  # type: ignore[index]


def test_what_is_suggested_does_when_it_is_asked():
    duty = ("--travel-per-turn", "5 mm", "--mass", "10 kg", "--vertical", "--efficiency", "40 %", "--speed", "50 mm/s",
            "--acceleration", "500 mm/s2")  # fmt: skip
    done = run("--suggest", "--supply", "24 V", "--current", "2 A", *duty, "--json")
    listed = [row["motor"] for row in json.loads(done.stdout)["would_do"]]
    assert done.exit_code == 0
    for text in (listed[0], listed[-1]):
        name, current = text.split(" at ")
        assert run("--motor", name, "--supply", "24 V", "--current", current, *duty).exit_code == 0
    others = set(library()) - {text.split(" at ")[0] for text in listed}
    assert "SM-42BYG011-25" in others
    alone = run("--motor", "SM-42BYG011-25", "--supply", "24 V", "--current", "0.33 A", *duty)
    assert alone.exit_code == 1


def test_the_speed_that_would_do_does():
    load = ("--travel-per-turn", "5 mm", "--mass", "10 kg", "--vertical", "--efficiency", "40 %")
    done = run(*BEHIND, *load, "--speed", "900 mm/s", "--acceleration", "1 mm/s2")
    offered = re.search(r"at most (\d+) rpm would do", done.stdout)
    assert offered is not None
    speed = float(offered.group(1)) * 0.95
    assert run(*BEHIND, *load, "--speed", f"{speed} rpm", "--acceleration", "1 mm/s2").exit_code == 0


def test_none_that_would_do():
    done = run("--suggest", "--supply", "12 V", "--current", "1 A", "--load-torque", "50 N·m", "--speed", "60 rpm",
               "--acceleration", "10 rad/s2")  # fmt: skip
    assert done.exit_code == 1
    assert "No motor of the library" in done.stdout


@pytest.mark.parametrize(
    ("args", "words"),
    [
        ((), "--suggest"),
        (BEHIND, "--move and --time"),
        ((*BEHIND, "--move", "1 mm"), "--time"),
        ((*BEHIND, "--speed", "1 rpm"), "--acceleration"),
        (("-m", "belt-stage", "--suggest"), "by options"),
        (("-m", "belt-stage", "--mass", "1 kg", "--motor", "QSH5718-55"), "by options"),
        ((*BEHIND, "--move", "10 mm", "--time", "1 s"), "--travel-per-turn"),
        (("--suggest", "--speed", "1 rpm", "--acceleration", "1 rad/s2"), "--supply"),
    ],
)
def test_options_that_do_not_go_together(args: tuple[str, ...], words: str):
    done = run(*args)
    assert done.exit_code == 2
    assert words in done.output
