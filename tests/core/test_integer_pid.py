"""The integer PID against its arithmetic in whole numbers, and against the figures of the electronic leadscrew."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from trochia.errors import LimitError
from trochia.kernels.integer_pid import IntegerPid
from trochia.servo.scaling import PmacGains, in_32nds

HALF = 1073741823
KP, KI, KD = 72.0371, 82.6077, 0.6721


def wrapped(value: int) -> int:
    return (value + 32768) % 65536 - 32768


def between(value: int, most: int) -> int:
    return max(-most, min(most, value))


def stated(p: int, i: int, d: int, errors: list[int], *, mended: bool) -> list[tuple[int, ...]]:
    """Return the rows in Python's whole numbers."""
    rows, total, last = [], 0, 0
    most_e, most_s = 32767 // (p + 1), HALF // (i + 1)
    for e in errors:
        pt = 32767 if e > most_e else -32767 if e < -most_e else p * e
        total += e
        it = i * total if abs(total) <= most_s else HALF if total > 0 else -HALF
        total = between(total, most_s)
        change = e - last
        most_d = 32767 // (d + 1)
        dt = (
            (32767 if change > most_d else -32767 if change < -most_d else d * change)
            if mended
            else wrapped(d * change)
        )
        last = e
        raw = (pt + it + dt) >> 5
        rows.append((pt, it, dt, raw, between(raw, 1023) if mended else max(0, min(1023, raw))))
    return rows


GAIN = st.integers(0, 65535)
SWINGS = [32767, 32767, -32768, -32768, -32768, 0, 32767, 1, -1, 0]  #: every term to both of its bounds, and back


@example(p=40, i=65535, d=9, errors=SWINGS, mended=True)
@example(p=40, i=65535, d=9, errors=SWINGS, mended=False)
@given(p=GAIN, i=GAIN, d=GAIN, errors=st.lists(st.integers(-32768, 32767), max_size=40), mended=st.booleans())
def test_the_chip_s_arithmetic_is_that_of_whole_numbers(
    p: int, i: int, d: int, errors: list[int], *, mended: bool
) -> None:
    got = IntegerPid(p, i, d, mended=mended).run(np.array(errors, np.int32))
    assert [tuple(row) for row in got.tolist()] == stated(p, i, d, errors, mended=mended)


@pytest.mark.parametrize(
    ("gains", "errors", "columns"),
    [
        ((32, 0, 0), [0, 1, 100, -5, 1023, 2000, -2000],
         {"p": [0, 32, 3200, -160, 32767, 32767, -32767], "raw": [0, 1, 100, -5, 1023, 1023, -1024],
          "output": [0, 1, 100, 0, 1023, 1023, 0]}),
        ((32, 32, 0), [1, 1, 1, -5, 0], {"raw": [2, 3, 4, -7, -2], "output": [2, 3, 4, 0, 0]}),
        ((64, 0, 320), [0, 10, 10, 5, -20], {"raw": [0, 120, 20, -40, -290], "output": [0, 120, 20, 0, 0]}),
        ((2305, 3, 21003), [0, 1, 2, 1, 14, 15, -1, 0],
         {"p": [0, 2305, 4610, 2305, 32270, 32767, -2305, 0], "i": [0, 3, 9, 12, 54, 99, 96, 96],
          "d": [0, 21003, 21003, -21003, 10895, 21003, -8368, 21003],
          "raw": [0, 728, 800, -584, 1350, 1683, -331, 659], "output": [0, 728, 800, 0, 1023, 1023, 0, 659]}),
    ],
)  # fmt: skip
def test_the_printed_rows_of_the_electronic_leadscrew(
    gains: tuple[int, int, int], errors: list[int], columns: dict[str, list[int]]
) -> None:
    rows = IntegerPid(*gains).run(errors)
    for name, values in columns.items():
        assert rows[:, ("p", "i", "d", "raw", "output").index(name)].tolist() == values, name


def test_the_sum_ends_where_the_errors_leave_it() -> None:
    pid = IntegerPid(32, 32, 0)
    pid.run([1, 1, 1, -5, 0])
    assert pid.sum == -2


def test_gains_scale_to_32nds_by_the_period() -> None:
    assert in_32nds(KP, KI, KD, 1.024e-3) == (2305, 3, 21003)
    assert in_32nds(KP, KI, KD, 2.048e-3)[2] == 10502
    assert in_32nds(KP, KI, KD, 32.768e-3)[1:] == (87, 656)
    with pytest.raises(LimitError, match="D = 168025"):
        in_32nds(KP, KI, KD, 0.128e-3)


TABLE = PmacGains(i30=22521, i31=11280, i29=-186)


def test_a_pmac_s_proportional_gain_is_its_table_s() -> None:
    assert TABLE.bits_a_count == pytest.approx(4.1237, abs=1e-4)
    assert TABLE.bits_a_count * 10 / 32768 == pytest.approx(1.2585e-3, abs=1e-7)
    assert TABLE.output(2000, 0, 0, 0, 0) * 10 / 32768 == pytest.approx(2.517 - 0.0568, abs=1e-3)
    assert TABLE.output(100_000, 0, 0, 0, 0) == 20480


@given(
    error=st.integers(-2000, 2000), commanded=st.integers(-50, 50), acceleration=st.integers(-5, 5),
    actual=st.integers(-50, 50), integral=st.integers(-10_000, 10_000),
)  # fmt: skip
def test_the_pmac_law_in_volts_is_the_law_in_bits(
    error: int, commanded: int, acceleration: int, actual: int, integral: int
) -> None:
    gains = PmacGains(i30=22521, i31=11280, i32=2000, i33=5000, i35=900, i69=32767)
    counts, period = 4096.0, 0.442708e-3
    loop = gains.loop(counts, period)
    assert loop.position is not None
    volts = (
        loop.position.kp * error / counts
        + loop.position.ki * period * integral / counts
        - loop.position.kd * actual / counts / period
        + loop.viscous_forward * commanded / counts / period
        + loop.acceleration_forward * acceleration / counts / period**2
    )
    bits = gains.output(error, commanded, acceleration, actual, integral)
    assert abs(volts * 3276.8) > 32767 or bits == pytest.approx(volts * 3276.8, abs=1.0)
