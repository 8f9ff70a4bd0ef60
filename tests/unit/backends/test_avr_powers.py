"""Pixels of a span: how far apart they may be, and what no longer fits."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.backends.avr.powers import FARTHEST, MOST, Powers
from trochia.kernels.link import SLOT


def changes(powers: Powers, end: int) -> list[tuple[int, int]]:
    """Ticks after the span's start, and powers, without those that were there before."""
    pixels = powers.until(end)
    at = np.cumsum(pixels["after"].astype(int)) * SLOT
    seen = [(0, powers.first), *zip(at.tolist(), pixels["power"].tolist(), strict=True)]
    return [now for before, now in pairwise(seen) if now[1] != before[1]]


@given(st.lists(st.tuples(st.integers(64, 200_000), st.integers(0, 255)), max_size=8), st.integers(0, 1 << 30))
def test_each_change_is_within_half_a_slot_of_its_tick(steps: list[tuple[int, int]], start: int):
    powers, wanted, at, now = Powers(start, 7, MOST), [], start, 7
    for after, power in steps:
        at += after
        if not powers.add(at, power):
            break
        if power != now:
            wanted.append((at - start, power))
        now = power
    seen = changes(powers, at + 2 * SLOT)
    assert [power for _, power in seen] == [power for _, power in wanted]
    assert all(abs(tick - due) <= SLOT // 2 for (tick, _), (due, _) in zip(seen, wanted, strict=True))


def test_a_long_stretch_of_one_power_takes_a_pixel_for_every_two_milliseconds():
    powers = Powers(0, 0, MOST)
    assert powers.add(3 * FARTHEST * SLOT + SLOT, 9)
    assert powers.until(1 << 20)["after"].tolist() == [FARTHEST, FARTHEST, FARTHEST, 1]
    assert powers.until(1 << 20)["power"].tolist() == [0, 0, 0, 9]


@pytest.mark.parametrize("room", [0, 1, 5, MOST, 1000])
def test_what_does_not_fit_is_said(room: int):
    powers = Powers(0, 0, room)
    taken = 0
    while powers.add(1000 * (taken + 1), taken % 2 + 1):
        taken += 1
    assert taken == min(room, MOST)
    assert len(powers.until(1 << 30)) == taken


def test_what_begins_where_the_span_ends_is_the_next_ones():
    powers = Powers(100, 0, MOST)
    assert powers.add(100 + 4 * SLOT, 5)
    assert powers.add(100 + 6 * SLOT, 6)
    assert len(powers.until(100 + 4 * SLOT)) == 0
    assert len(powers.until(101 + 4 * SLOT)) == 1
