"""What a method costs on a chip, counted: the readable statement is run on integers that count their operations.

Loop counters are left out; a product with a constant power of two is a shift, and a shift is as simple as an addition.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

from trochia.pulses.interpolators.frame import Arc, Figure, Line, pieces

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.pulses.interpolators import Interpolator

SIMPLE, PRODUCT, QUOTIENT = "simple", "products", "quotients"
_BINARY = {
    "add": SIMPLE, "sub": SIMPLE, "lshift": SIMPLE, "rshift": SIMPLE, "mul": PRODUCT, "floordiv": QUOTIENT,
}  # fmt: skip
_MOST_STEPS = 2000  #: a longer figure is counted on a model of it: the cost of a step does not depend on the length


def _binary(name: str, kind: str, tally: Counter[str]) -> Callable[[Any, Any], Any]:
    """Return an operation of ints that counts itself."""
    plain = getattr(int, name)

    def operation(self: int, other: int) -> Any:  # noqa: ANN401 - NotImplemented is one of its answers
        result = plain(self, other)
        shift = kind == PRODUCT and type(other) is int and other > 0 and other & (other - 1) == 0
        tally[SIMPLE if shift else kind] += 1
        return type(self)(result) if type(result) is int else result

    return operation


def counting_int(tally: Counter[str]) -> type[int]:
    """Return a kind of int whose operations add to ``tally``."""
    names = {f"__{side}{name}__": kind for name, kind in _BINARY.items() for side in ("", "r")}
    names |= {f"__{name}__": SIMPLE for name in ("lt", "le", "gt", "ge")}
    body: dict[str, Any] = {name: _binary(name, kind, tally) for name, kind in names.items()}

    def negative(self: int) -> int:
        tally[SIMPLE] += 1
        return type(self)(int.__neg__(self))

    return type("CountingInt", (int,), body | {"__neg__": negative})


def _model(figure: Figure) -> Figure:
    """Return a figure of the same shape with at most some thousand steps."""
    if isinstance(figure, Line):
        scale = max(1, max(abs(figure.x), abs(figure.y)) // _MOST_STEPS)
        return Line(x=figure.x // scale, y=figure.y // scale)
    radius = min(round(figure.radius), _MOST_STEPS // 8)
    if radius == round(figure.radius):
        return figure
    return Arc(start=(radius, 0), end=(radius, 0), radius_squared=radius * radius)


def operations_per_step(method: Interpolator, figure: Figure) -> dict[str, float]:
    """Return how many operations of each kind a step of one axis takes: simple, products, quotients."""
    tally: Counter[str] = Counter()
    number = counting_int(tally)
    model, steps = _model(figure), 0
    if isinstance(model, Line):
        runs = [method.line(number(abs(model.x)), number(abs(model.y)))]
    else:
        runs = [
            method.arc(*map(number, (piece.x, piece.y, piece.x_end, piece.y_end, model.radius_squared)))
            for piece in pieces(model)
        ]
    for run in runs:
        steps += sum(int(x) + int(y) for x, y in run)
    return {kind: tally[kind] / max(steps, 1) for kind in (SIMPLE, PRODUCT, QUOTIENT)}
