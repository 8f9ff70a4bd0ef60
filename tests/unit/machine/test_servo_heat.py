"""Heat of the electronic leadscrew's supplies and bridge: what was printed, and what is right."""

from __future__ import annotations

import pytest

from trochia.errors import ConfigError
from trochia.machine.servos.heat import Device, conduction, heatsink, heatsink_as_printed, loss

BOTH = Device(power=4.48, junction_case=5, case_sink=0.65)


def test_regulators():
    """7 V at 0.16 A, 12 V at 0.28 A, and both."""
    assert loss(7, 0.16) == pytest.approx(1.12)
    assert loss(12, 0.16 + 0.12) == pytest.approx(3.36)
    assert loss(7, 0.16) + loss(12, 0.28) == pytest.approx(4.48)


@pytest.mark.parametrize(("resistance", "rise"), [(5, 22.5), (65, 292.5), (0.5, 2.25), (0.8, 3.6)])
def test_rise_over_one_resistance(resistance, rise):
    assert 4.5 * resistance == rise
    device = Device(power=4.5, junction_case=resistance, case_sink=0)
    assert device.rise(0.0) == pytest.approx(rise)


def test_the_heatsink_as_printed_and_as_it_must_be():
    """Printed 18 K/W comes of the wrong sign (17.97); the right one gives 16.5 to 16.8 for 0.8 to 0.5 K/W of paste."""
    assert heatsink_as_printed(100, BOTH) == pytest.approx(17.97, abs=0.005)
    for paste, most in ((0.8, 16.5), (0.5, 16.8)):
        right = heatsink(100, Device(power=4.48, junction_case=5, case_sink=paste))
        assert right == pytest.approx(most, abs=0.03)


@pytest.mark.parametrize("paste", [0.5, 0.8])
def test_two_devices_on_one_plate(paste):
    """Each by itself: the worst has 3.36 W, and 18.0 to 18.2 K/W would do."""
    small, large = (Device(power=p, junction_case=5, case_sink=paste) for p in (1.12, 3.36))
    most = heatsink(100, small, large)
    assert 17.95 < most < 18.25
    assert large.rise(most, others=1.12) == pytest.approx(100)
    assert small.rise(most, others=3.36) < 100


@pytest.mark.parametrize(("k", "resistance"), [(150, 0.14), (237, 0.088), (120, 0.174)])
def test_conduction_through_the_plate(k, resistance):
    assert conduction(2.5e-3, k, 1.2e-4) == pytest.approx(resistance, abs=0.0012)


def test_the_bridge_is_no_less_than_the_regulators():
    """2 V at 0.8 A and full duty are 1.6 W, more than one regulator; 8 W at 4 A."""
    assert loss(2, 0.8) == pytest.approx(1.6)
    assert loss(2, 0.8, duty=0.5) == pytest.approx(0.8)
    assert loss(2, 4) == pytest.approx(8)
    # the plate's surface: both faces and the edges of 100 by 25 by 2.5 mm are 56.25 cm²
    assert 2 * (10 * 2.5 + 10 * 0.25 + 2.5 * 0.25) == 56.25


def test_what_no_heatsink_can_cool_is_refused():
    with pytest.raises(ConfigError, match="no heatsink"):
        heatsink(20, BOTH)
    with pytest.raises(ConfigError, match="power"):
        Device(power=0, junction_case=1, case_sink=1)
