"""A board's image at its pins: rates without a missed tick, hold, emergency stop, a host that falls silent."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from trochia.backends.simulated_chip import LOST
from trochia.kernels.link import CAUSES, LOOSE, STATES, TYPES, executed

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

edges = sys.modules["chip_motion"].edges
CLOCK = 16e6
US = 16  # cycles
STEPS = ("D2", "D3", "D4", "B4")
MODE = 0xB0  # TCCR2A: 0 where the beam's pin is low


def steady(*arguments: Any, **named: Any) -> list[bytes]:
    return sys.modules["steady_spans"].steady(*arguments, **named)


@pytest.mark.parametrize(
    ("rates", "ticks", "latest"),
    [
        ([160_000], 1 << 18, 10),
        ([200_000], 1 << 18, 15),
        ([33_000, 33_400, 34_000], 1 << 18, 10),
        ([33_000, 33_400, 34_000], 1 << 17, 10),
        ([20_000, 20_100, 20_200, 20_300], 1 << 17, 10),
        ([40_000, 39_000, 41_000], 1 << 19, 10),
    ],
)
def test_rates_without_a_missed_tick(talk: Callable[[str], Any], rates: list[float], ticks: int, latest: int):
    """Status a hundred times a second, orders at 1,000,000 baud; `latest` in microseconds."""
    spans = steady(rates, round(0.25 * CLOCK / ticks), ticks=ticks, stride=100)
    told = talk("uno-stepdir")
    status, wanted, events = told.stream(spans), executed(b"".join(spans)), told.events()
    assert CAUSES[int(status["cause"])] == "no_cause"
    assert status["position"].tolist() == wanted.position.tolist()
    late: list[NDArray[np.int64]] = []
    for motor, pin in enumerate(STEPS[: len(rates)]):
        up, down = edges(events, pin, 1), edges(events, pin, 0)
        planned = wanted.pulses["tick"][wanted.pulses["pins"] >> motor & 1 == 1]
        assert len(up) == len(planned)  # none lost, none doubled
        late.append(up - planned)
        assert np.diff(up).min() >= 4 * US
        assert (down[: len(up)] - up).min() >= 1.5 * US
    whole = np.concatenate(late)
    assert whole.max() - np.median(whole) <= latest * US
    assert np.median(whole) - whole.min() <= 2 * US
    assert np.count_nonzero((events["kind"] == LOST) & (events["value"] == 0)) <= 2  # sent again
    assert free(told) >= 300


def free(told: Any) -> int:
    """Bytes of memory that nothing has used since reset."""
    told.answer = None
    told.session.greet(told.now)
    told.pass_on(0.02)
    return int(told.answer["free"])


@pytest.mark.parametrize("how", ["brake", "halt", "low"])
def test_four_motors_leave_as_much_memory_however_they_stop(talk: Callable[[str], Any], how: str):
    spans = steady([12_000, 12_400, 12_900, 13_000], 8, ticks=1 << 18, stride=40, slew=3000, rest=False, power=9)
    told = talk("uno-stepdir")
    told.switch(enable=1)
    told.begin()
    for span in spans[:6]:
        told.session.order("span", span)
    told.pass_on(0.02)
    told.session.order("go")
    told.pass_on(0.03)
    if how == "brake":
        told.session.order("brake")
    elif how == "halt":
        told.session.halt(drives_off=True)
    told.pass_on(0.1)
    status = told.ask()
    assert CAUSES[int(status["cause"])] == ("low" if how == "low" else "ordered")
    assert free(told) >= 300


def running(
    told: Any, *, rate: float = 10_000, power: int = 200, slew: int = 2_000, silence: int = 250
) -> NDArray[np.void]:
    """Set one motor under way, the beam lit, a second of motion held; return what has happened."""
    told.line.set_input("B1", 1)
    told.session.greet(told.now, silence=silence, estop=1)
    told.pass_on(0.01)
    told.switch(enable=1)
    told.session.order("switch", bytes([255, 1, 0, 0]))
    told.begin()
    for span in steady([rate], 16, ticks=1 << 20, slew=slew, power=power, stride=100):
        told.session.order("span", span)
    told.pass_on(0.02)
    told.session.order("go")
    told.pass_on(0.05)
    assert told.line.chip.read_memory(MODE, 1)[0]
    return told.events()


def first_slow(up: NDArray[np.int64], rate: float) -> int:
    """The cycle at which the step rate begins to fall."""
    gaps = np.diff(up)
    return int(up[int(np.argmax(gaps > CLOCK / rate + 8 * US))])


def test_a_hold_begins_to_brake_within_ten_milliseconds(talk: Callable[[str], Any]):
    told = talk("uno-stepdir")
    running(told)
    given = told.now
    told.session.order("brake")
    told.pass_on(0.1)
    up = edges(told.events(), "D2", 1)
    begun = first_slow(up, 10_000) / CLOCK - told.line.chip.run_until(0).cycle / CLOCK + told.now
    assert given < begun < given + 0.010
    status = told.ask()
    assert (STATES[int(status["state"])], CAUSES[int(status["cause"])]) == ("stopped", "ordered")


def test_the_emergency_stop_ends_steps_within_a_fifth_of_a_millisecond(talk: Callable[[str], Any]):
    told = talk("uno-stepdir")
    before = running(told, rate=100_000)
    pressed = told.line.chip.run_until(0).cycle
    told.line.set_input("B1", 0)
    told.pass_on(0.01)
    events = told.events()
    assert not np.any(edges(events, "D2", 1) > pressed + 200 * US)
    assert edges(events, "B0", 1)[-1] - pressed <= 200 * US  # drives off
    assert not told.line.chip.read_memory(MODE, 1)[0]
    status = told.ask()
    assert CAUSES[int(status["cause"])] == "estop"
    made = len(edges(np.concatenate([before, events, told.events()]), "D2", 1))
    assert status["position"][0] == made > 1000


def test_a_host_that_falls_silent_is_followed_by_a_controlled_stop_in_the_dark(talk: Callable[[str], Any]):
    told = talk("uno-stepdir")
    silence = 100  # slices
    running(told, silence=silence)
    told.ask()
    told.events()
    chip, dark = told.line.chip, None
    since = chip.run_until(0).cycle
    pieces: list[NDArray[np.void]] = []
    for _ in range(2000):  # 200 ms without a byte
        pieces.append(chip.run_until(chip.run_until(0).cycle + 1600).events)
        if dark is None and not chip.read_memory(MODE, 1)[0]:
            dark = chip.run_until(0).cycle
    up = edges(np.concatenate(pieces), "D2", 1)
    assert dark is not None
    decided = since + (silence + 2) * 16384  # at the latest
    assert since + (silence - 4) * 16384 < dark <= decided + 1000 * US
    assert dark < first_slow(up, 10_000)
    gaps = np.diff(up)
    falling = gaps[int(np.argmax(gaps > CLOCK / 10_000 + 8 * US)) :]
    assert np.diff(falling[2:]).min() > -130  # slower from step to step, up to the slices' seams
    assert up[-1] - dark < 30e-3 * CLOCK
    status = told.ask()
    assert (STATES[int(status["state"])], CAUSES[int(status["cause"])]) == ("stopped", "silence")


@pytest.mark.parametrize("rates", [[160_000], [20_000, 21_000, 22_000]])
def test_steps_of_the_slice_in_which_the_beam_goes_out_are_no_later_than_others(
    talk: Callable[[str], Any], rates: list[float]
):
    """The queue runs low: the slice's end, the rate that falls and the light that goes out come at one tick."""
    spans = steady(rates, 8, ticks=1 << 17, stride=100, slew=3000, power=200, rest=False)
    told = talk("uno-stepdir")
    told.session.order("switch", bytes([255, 1, 0, 0]))
    status, wanted, events = told.stream(spans), executed(b"".join(spans), brake=0), told.events()
    assert CAUSES[int(status["cause"])] == "low"
    assert status["position"].tolist() == wanted.position.tolist()
    late: list[NDArray[np.int64]] = []
    for motor, pin in enumerate(STEPS[: len(rates)]):
        late.append(edges(events, pin, 1) - wanted.pulses["tick"][wanted.pulses["pins"] >> motor & 1 == 1])
    whole = np.concatenate(late)
    assert whole.max() - np.median(whole) <= 10 * US


@pytest.mark.parametrize("kind", [name for name, code in TYPES.items() if code < LOOSE])
def test_orders_from_nowhere_move_nothing(talk: Callable[[str], Any], kind: str):
    told = talk("uno-stepdir")
    told.session.order(kind, bytes(32))
    told.pass_on(0.05)
    events = told.events()
    assert not any(edges(events, pin, 1).size for pin in STEPS)
    assert told.ask()["position"].tolist() == [0] * 6
