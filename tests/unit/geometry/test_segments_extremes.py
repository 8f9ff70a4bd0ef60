"""Circles too large to be squared: nothing is said to meet that cannot be computed, and nothing is raised."""

from __future__ import annotations

from trochia.geometry.segments import Segment, meetings


def test_circles_whose_squares_are_beyond_all_numbers():
    far = 1e200
    one = Segment(start=(far, 0.0), end=(0.0, far), centre=(0.0, 0.0), sense=1)
    other = Segment(start=(2 * far, 0.0), end=(far, far), centre=(far, 0.0), sense=1)
    assert all(len(point) == 2 for point in meetings(one, other))
