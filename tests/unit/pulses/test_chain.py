"""Distributors against the excitation tables; the filter against what the motor can follow."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.errors import ConfigError
from trochia.pulses.chain import (
    DISTRIBUTORS,
    CommandChain,
    DigitalFilter,
    RingCounter,
    ShiftRegister,
    SoftwareDistributor,
    distributed,
    phase_table,
)
from trochia.pulses.excitation import excitation


def levels(phases: np.ndarray) -> np.ndarray:
    """Return the levels of two bipolar phases whose terminals A+ B+ A- B- are the four phases."""
    return phases[:, :2].astype(float) - phases[:, 2:]


@pytest.mark.parametrize(
    ("made", "name", "first"),
    [
        (RingCounter(4), "one-phase", 0),
        (RingCounter(4, on=2), "two-phase", 0),
        (ShiftRegister.half_steps(4), "half-step", 0),
    ],
)
@pytest.mark.parametrize("sense", [1, -1])
def test_a_distributor_of_four_phases_is_the_table_of_that_excitation(made, name: str, first: int, sense: int) -> None:
    made.state = first
    got = levels(distributed(made, [sense] * 20))
    np.testing.assert_array_equal(got, excitation(name).sequence(20 * sense, first))


@pytest.mark.parametrize("mode", DISTRIBUTORS)
@pytest.mark.parametrize("phases", [3, 4, 5, 8])
def test_a_table_of_phases_turns_the_field_by_even_steps(mode: str, phases: int) -> None:
    """One phase, two, or both in turn: the sum of the phases' directions goes round evenly, m or 2m steps a turn."""
    table = phase_table(mode, phases)
    assert len(table) == (2 * phases if mode == "half-step" else phases)
    assert set(table.sum(axis=1)) == {"one-phase": {1}, "two-phase": {2}, "half-step": {1, 2}}[mode]
    assert table[0, 0]
    field = np.unwrap(np.angle(table @ np.exp(2j * np.pi / phases * np.arange(phases))))
    np.testing.assert_allclose(np.diff(field), 2 * np.pi / len(table), atol=1e-12)


@pytest.mark.parametrize("mode", DISTRIBUTORS)
@pytest.mark.parametrize("filtered", [True, False])
def test_hardware_and_software_distribute_alike_whoever_shapes_the_ramp(mode: str, *, filtered: bool) -> None:
    """The four splits of the work: only the filter changes instants, and no distributor changes the phases."""
    shaper = DigitalFilter(top=1000.0, start=200.0, acceleration=lambda _: 4000.0) if filtered else None
    times, signs = np.repeat([0.0, 0.3], [50, 30]), np.repeat([1, -1], [50, 30])
    wired, programmed = (
        CommandChain(distributor=made, filter=shaper)
        for made in (DISTRIBUTORS[mode](4), SoftwareDistributor(phase_table(mode, 4)))
    )
    (left, hardware), (same, software) = wired.commanded(times, signs), programmed.commanded(times, signs)
    np.testing.assert_array_equal(hardware, software)
    np.testing.assert_array_equal(left, same)
    assert np.array_equal(left, times) != filtered


@given(phases=st.integers(2, 8), moves=st.lists(st.sampled_from([1, -1]), max_size=60))
def test_a_ring_is_where_the_pulses_sum_up_to(phases: int, moves: list[int]) -> None:
    ring = RingCounter(phases)
    distributed(ring, moves)
    assert ring.present.index(True) == sum(moves) % phases


@given(
    gaps=st.lists(st.floats(0.0, 0.01), min_size=1, max_size=200),
    turn=st.integers(0, 200),
    top=st.floats(200.0, 2000.0),
)
def test_no_pulse_is_lost_or_early_and_none_comes_too_soon(gaps: list[float], turn: int, top: float) -> None:
    came = np.cumsum(gaps)
    signs = np.where(np.arange(len(came)) < turn, 1, -1)
    made = DigitalFilter(top=top, start=150.0, acceleration=lambda f: 20_000.0 * (1.0 - f / (2.0 * top)))
    left = made.spaced(came, signs)
    assert len(left) == len(came)
    assert np.all(left >= came)
    apart = np.diff(left)
    assert np.all(apart >= (1.0 / top) * (1 - 1e-9))
    rates = 1.0 / np.maximum(apart, 1e-12)
    same = signs[1:] == signs[:-1]
    for before, after, steady in zip(rates[:-1], rates[1:], same[1:], strict=True):
        if steady and before >= 150.0:
            assert after**2 <= (before**2 + 2.0 * 20_000.0 * (1.0 - before / (2.0 * top))) * (1 + 1e-9)
        else:
            assert after <= 150.0 * (1 + 1e-9)


def test_a_train_at_once_comes_out_as_a_ramp_of_equal_acceleration() -> None:
    """A train of pulses that all come at once leaves as v² = v0² + 2 a n (equal acceleration step by step)."""
    left = DigitalFilter(top=1e4, start=100.0, acceleration=lambda _: 5000.0).spaced(np.zeros(300), np.ones(300))
    rates = 1.0 / np.diff(left)
    np.testing.assert_allclose(rates**2, 100.0**2 + 2 * 5000.0 * np.arange(299), rtol=1e-9)
    whole = left[-1] - left[0]
    assert whole == pytest.approx((math.sqrt(100.0**2 + 2 * 5000.0 * 299) - 100.0) / 5000.0, rel=0.02)


def test_without_a_characteristic_only_the_distance_is_kept() -> None:
    left = DigitalFilter(top=1000.0, start=1000.0).spaced([0.0, 0.0, 0.0, 0.5], [1, 1, 1, 1])
    np.testing.assert_allclose(left, [0.0, 0.001, 0.002, 0.5])


@pytest.mark.parametrize(
    ("make", "why"),
    [
        (lambda: RingCounter(1), "at least 2"),
        (lambda: RingCounter(4, on=4), "fewer on"),
        (lambda: ShiftRegister(4, (0, 1)), "bits set"),
        (lambda: ShiftRegister(1, (1,)), "at least 2"),
        (lambda: SoftwareDistributor(np.ones((0, 4), bool)), "at least 2 phases"),
        (lambda: phase_table("half-steps", 4), "did you mean half-step"),
        (lambda: DigitalFilter(top=100.0, start=200.0), "not above the top"),
        (lambda: DigitalFilter(top=100.0, start=50.0).spaced([1.0, 0.0], [1, 1]), "in order"),
    ],
)
def test_what_cannot_be_is_refused(make, why: str) -> None:
    with pytest.raises(ConfigError, match=why):
        make()
