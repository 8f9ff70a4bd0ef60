"""One step of constant acceleration: how long it takes, and how fast it ends.

In: the squared speed before the step.  Out: its time, and the squared speed after it.  Over a step the square w of the
speed is straight in the way x (w = v² + 2 a x), so whatever bounds it - speeding up, the greatest speed, braking for
the target - is a straight line too, and each piece from w₁ to w₂ takes 2 Δx/(√w₁ + √w₂).  From rest to rest that is
the trapezoid itself, exact at every step: no recursion, no error that grows.
"""

from __future__ import annotations

import math

_REST = 1e-9  # of what braking takes away in a step: less is a rounding error, and means rest


def next_step(square: float, *, gain: float, loss: float, top: float, end: float) -> tuple[float, float]:
    """Return a step's time [s] and the squared speed after it [steps²/s²].

    Parameters
    ----------
    square
        Squared speed before it.
    gain, loss
        What a step adds at most, and takes away at most: 2 a and 2 d [steps²/s²].
    top
        Greatest squared speed.
    end
        Greatest squared speed at which the step may end: 2 d times the steps still to come.
    """
    if square - loss >= min(top, end):  # braking is all there is to do
        after = square - loss if square - loss > _REST * loss else 0.0
        return 2.0 / (math.sqrt(square) + math.sqrt(after)), after

    def bound(x: float) -> float:
        braking = end + loss * (1.0 - x)
        if square > top:
            return max(square - loss * x, min(top, braking))
        return min(square + gain * x, top, braking)

    crossings = ((top - square) / gain, (end + loss - top) / loss, (end + loss - square) / (gain + loss),
                 (square - top) / loss)  # fmt: skip
    places = [0.0, *sorted(x for x in crossings if 0.0 < x < 1.0), 1.0]
    roots = [math.sqrt(max(bound(x), 0.0)) for x in places]
    pieces = zip(places, places[1:], roots, roots[1:], strict=False)
    return sum(2.0 * (b - a) / (before + after) for a, b, before, after in pieces), bound(1.0)
