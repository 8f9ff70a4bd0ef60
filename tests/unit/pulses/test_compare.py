"""Deviation, jitter and cost: measures against figures that can be worked out by hand."""

from __future__ import annotations

import io
import math

import numpy as np
import pytest

from trochia.errors import ConfigError
from trochia.pulses.interpolators import INTERPOLATORS, Arc, Line, positions
from trochia.pulses.interpolators.compare import deviations, interval_errors, merit, way_along
from trochia.pulses.interpolators.counting import operations_per_step
from trochia.pulses.interpolators.picture import picture

CIRCLE = Arc(start=(50, 0), end=(50, 0), radius_squared=2500)


def test_dda_on_5_and_3_by_hand() -> None:
    """After k ticks it stands on (⌊5k/8⌋, ⌊3k/8⌋); the distance from the line is |5y - 3x| / √34."""
    points = [(5 * k // 8, 3 * k // 8) for k in range(9)]
    away = [abs(5 * y - 3 * x) / math.sqrt(34) for x, y in dict.fromkeys(points)]
    found = merit(INTERPOLATORS["dda"], Line(x=5, y=3), timed=False)
    assert found.deviation_max == pytest.approx(max(away))
    assert found.deviation_rms == pytest.approx(math.sqrt(sum(d * d for d in away) / len(away)))
    assert (found.ticks, found.steps_x, found.steps_y, found.end) == (8, 5, 3, (5, 3))
    assert found.ns_per_step is None


@pytest.mark.parametrize("name", ["bresenham", "point", "difference", "octant"])
def test_along_an_axis_nothing_deviates_and_nothing_jitters(name: str) -> None:
    found = merit(INTERPOLATORS[name], Line(x=0, y=-40), timed=False)
    assert (found.deviation_max, found.jitter_max, found.ticks) == (0.0, pytest.approx(0.0), 40)


def test_dda_on_a_power_of_two_less_one_jitters_at_one_place() -> None:
    """7 steps in 8 ticks: the first tick is empty, then one a tick; the pulses themselves come evenly."""
    assert merit(INTERPOLATORS["dda"], Line(x=7, y=0), timed=False).jitter_max == pytest.approx(0.0)


def test_dda_on_5_of_8_ticks_jitters_by_its_gaps() -> None:
    """Pulses at 2 4 5 7 8: intervals 2 1 2 1 against 1.5 each, a third of it."""
    found = merit(INTERPOLATORS["dda"], Line(x=5, y=0), timed=False)
    assert found.jitter_max == pytest.approx(1 / 3)
    assert found.jitter_rms == pytest.approx(1 / 3)


def test_a_diagonal_step_every_other_tick_jitters() -> None:
    """Bresenham on (2, 1): one step straight and one aslant, 2/√5 and 3/√5 of the way, at one speed."""
    line = Line(x=200, y=100)
    pulses = INTERPOLATORS["bresenham"].pulses(line)
    errors = interval_errors(line, pulses, positions(pulses))
    assert np.abs(errors).max() == pytest.approx(0.2, abs=2e-3)


def test_measures_of_points() -> None:
    points = np.array([[50, 0], [0, 51], [-49, 0], [0, -50], [50, 0]])
    assert deviations(CIRCLE, points) == pytest.approx([0, 1, -1, 0, 0])
    assert way_along(CIRCLE, points) == pytest.approx([25 * math.pi * k for k in range(5)])
    back = Arc(start=(50, 0), end=(50, 0), radius_squared=2500, clockwise=True)
    assert way_along(back, points[::-1])[-1] == pytest.approx(100 * math.pi)
    assert deviations(Line(x=3, y=4), np.array([[0, 5], [4, -3]])) == pytest.approx([3.0, -5.0])


def test_discriminants_are_the_nearest_and_dda_is_not() -> None:
    """What the comparison is for: on a circle Bresenham stays within half a step, the DDA and point by point do not."""
    worst = {name: merit(method, CIRCLE, timed=False).deviation_max for name, method in INTERPOLATORS.items()}
    assert worst["bresenham"] <= 0.5
    assert worst["octant"] <= 0.5
    assert worst["dda"] > 0.7
    assert worst["point"] > 0.7


def test_operations_are_counted_by_hand() -> None:
    """Point by point on a line: at each tick a comparison of F, one addition to it, one count; a little at the end."""
    cost = operations_per_step(INTERPOLATORS["point"], Line(x=500, y=400))
    assert cost["simple"] == pytest.approx(3.0, abs=0.05)
    assert cost["products"] == cost["quotients"] == 0.0


def test_only_the_function_multiplies_at_every_step() -> None:
    costs = {name: operations_per_step(method, CIRCLE) for name, method in INTERPOLATORS.items()}
    assert costs["octant"]["products"] > 0.5
    assert all(costs[name]["products"] < 0.1 for name in ("dda", "bresenham", "point", "difference"))
    assert operations_per_step(INTERPOLATORS["octant"], Line(x=90, y=40))["quotients"] > 0.5


def test_a_long_figure_is_counted_on_its_model() -> None:
    long, short = (Arc(start=(r, 0), end=(r, 0), radius_squared=r * r) for r in (40_000, 250))
    method = INTERPOLATORS["bresenham"]
    assert operations_per_step(method, long) == operations_per_step(method, short)


def test_time_is_measured_when_asked_for() -> None:
    found = merit(INTERPOLATORS["dda"], CIRCLE)
    assert found.ns_per_step is not None
    assert found.ns_per_step > 0


@pytest.mark.parametrize("figure", [Line(x=5, y=3), Arc(start=(0, 900), end=(-900, 0), radius_squared=810_000)])
def test_the_picture_is_a_picture(figure: Line | Arc) -> None:
    from matplotlib.image import imread  # noqa: PLC0415 - half a second, only here

    image = imread(io.BytesIO(picture(figure, list(INTERPOLATORS.values()), "title")))
    shades = (255 * image[..., :3]).round().astype(int) @ [0x10000, 0x100, 1]
    assert image.shape[1] > 1000
    assert all((shades == colour).any() for colour in (0x0072B2, 0xD55E00, 0x009E73))


@pytest.mark.parametrize(
    ("start", "end", "squared"), [((10, 0), (0, 9), 100), ((0, 0), (1, 0), 1), ((1, 0), (1, 0), 0)]
)
def test_ends_off_the_circle_are_refused(start: tuple[int, int], end: tuple[int, int], squared: int) -> None:
    with pytest.raises(ConfigError, match="steps from its centre"):
        Arc(start=start, end=end, radius_squared=squared)


def test_ends_within_the_grids_rounding_are_taken() -> None:
    assert Arc(start=(10, 2), end=(0, 10), radius_squared=100).radius == 10


def test_ends_no_circle_joins_are_refused() -> None:
    """Half a step inside and half a step outside: towards the end both coordinates would grow."""
    with pytest.raises(ConfigError, match="no arc"):
        Arc(start=(9, 3), end=(10, 4), radius_squared=104)


def test_an_end_beyond_the_axes_is_refused() -> None:
    """√108 rounds to 10: a circle of the grid that never comes to x = 11, however long it turns."""
    with pytest.raises(ConfigError, match="steps from its centre"):
        Arc(start=(0, 10), end=(11, 0), radius_squared=108)
