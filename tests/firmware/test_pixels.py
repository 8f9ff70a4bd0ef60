"""The beam of a board's image: powers within spans at their ticks while motors step."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from trochia.backends.avr.powers import Powers
from trochia.kernels.link import CAUSES, PIXELS, SPAN, executed

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

CLOCK = 16e6
US = 16  # cycles
STEPS = ("D2", "D3", "D4")


def raster(rates: list[float], hertz: float, pixels: int, spans: int) -> tuple[list[bytes], list[tuple[int, int]]]:
    """Return spans of so many pixels each, and when which power is due [ticks]; powers are above 0, none twice."""
    pixel = round(CLOCK / hertz)
    powers = (np.arange(pixels * spans) * 37 % 251 + 2).tolist()
    whole, due = [], []
    for i, each in enumerate(
        sys.modules["steady_spans"].steady(rates, spans, ticks=pixel * pixels, stride=100, slew=3000)
    ):
        start = i * pixels * pixel
        mine = powers[i * pixels : (i + 1) * pixels]
        light = Powers(start, mine[0], pixels)
        ticks = [start + pixel * k for k in range(pixels)]
        assert all(light.add(tick, power) for tick, power in zip(ticks, mine, strict=True))
        put = light.until(start + pixel * pixels)
        head = np.frombuffer(each[: SPAN.itemsize], SPAN).copy()
        head["power"] = light.first
        head["flags"] |= PIXELS * len(put)
        whole.append(head.tobytes() + each[SPAN.itemsize :] + put.tobytes())
        due += list(zip(ticks, mine, strict=True))
    return whole, due


@pytest.mark.parametrize(
    ("rates", "hertz", "pixels"),
    [([8_000], 5_000, 30), ([100_000], 5_000, 30), ([40_000], 8_000, 30), ([10_000, 11_000], 5_000, 20)],
)
def test_pixels_come_at_their_ticks_while_motors_step(
    talk: Callable[[str], Any], rates: list[float], hertz: float, pixels: int
):
    """No missed tick, each power in its turn and within 25 µs of its time; 1,000,000 baud, a status now and then."""
    motion = sys.modules["chip_motion"]
    spans, due = raster(rates, hertz, pixels, round(0.2 * hertz / pixels))
    told = talk("uno-stepdir")
    told.session.order("switch", bytes([255, 1, 0, 0]))
    status, wanted, events = told.stream(spans), executed(b"".join(spans)), told.events()
    assert CAUSES[int(status["cause"])] == "no_cause"
    assert status["position"].tolist() == wanted.position.tolist()
    late: list[NDArray[np.int64]] = []
    for motor, pin in enumerate(STEPS[: len(rates)]):
        up = motion.edges(events, pin, 1)
        planned = wanted.pulses["tick"][wanted.pulses["pins"] >> motor & 1 == 1]
        assert len(up) == len(planned)
        late.append(up - planned)
    origin = np.median(np.concatenate(late))
    assert np.concatenate(late).max() - origin <= 10 * US
    seen = motion.duties(events)
    assert [power for _, power in seen] == [power for _, power in due]
    astray = np.array([cycle for cycle, _ in seen]) - origin - np.array([tick for tick, _ in due])
    assert astray.min() >= -5 * US
    assert astray.max() <= 15 * US


def test_a_hold_is_dark_from_its_first_slice_on_and_pixels_do_not_light_it(talk: Callable[[str], Any]):
    motion = sys.modules["chip_motion"]
    spans, _ = raster([10_000], 2_000, 30, 30)
    told = talk("uno-stepdir")
    told.session.order("switch", bytes([255, 1, 0, 0]))
    told.switch(enable=1)
    told.begin()
    for span in spans[:5]:
        told.session.order("span", span)
    told.pass_on(0.02)
    told.session.order("go")
    told.pass_on(0.02)
    told.session.order("brake")
    told.pass_on(0.004)
    told.events()
    told.pass_on(0.05)
    events = told.events()
    assert motion.edges(events, "D2", 1).size  # it braked, and
    assert not motion.duties(events)  # in the dark
    assert CAUSES[int(told.ask()["cause"])] == "ordered"
