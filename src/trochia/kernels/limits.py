"""Rows of limits as the C struct ``trochia_limits`` (``core/host/plan.h``), checked before C sees them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.kernels.layout import ffi

if TYPE_CHECKING:
    from numpy.typing import NDArray

_ROWS = 18
_AXES = 9


def limits_struct(
    matrix: NDArray[np.float64], linear: int, caps: tuple[float, ...], **rows: NDArray[np.float64]
) -> Any:  # noqa: ANN401 - cffi's
    """Return a ``trochia_limits``.

    Parameters
    ----------
    matrix
        Rows of limited quantities over the axes (rows, axes), the unit matrix first.
    linear
        Number of leading columns that are X, Y or Z.
    caps
        On the vector, for as many of velocity, acceleration and jerk as there are rows of; infinity: none.
    rows
        ``velocity``, ``acceleration`` and, where wanted, ``jerk``: the limit of each row (rows,).

    Raises
    ------
    ValueError
        When a row has no limit above zero, or there are too many rows.
    """
    count, axes = matrix.shape
    if count > _ROWS or not np.array_equal(matrix[:axes], np.eye(axes)):
        raise ValueError(f"limits need the unit matrix first and at most {_ROWS} rows")
    limits = ffi.new("trochia_limits *")
    limits.axes, limits.rows, limits.linear = axes, count, linear
    limits.matrix = list(matrix.ravel()) + [0.0] * (_ROWS * _AXES - matrix.size)
    for (name, values), cap in zip(rows.items(), caps, strict=True):
        if values.shape != (count,) or not (values > 0).all():
            raise ValueError(f"every row needs a {name} above zero")
        setattr(limits, name, list(values) + [1.0] * (_ROWS - count))
        setattr(limits, f"path_{name}", cap)
    return limits


def rising_rests(
    rests: tuple[NDArray[np.uint64], NDArray[np.float64]],
) -> tuple[NDArray[np.uint64], NDArray[np.float64]]:
    """Return rests as C reads them: segments (rests,), rising, and seconds (rests,); ValueError where they are not."""
    where, seconds = rests
    if where.shape != seconds.shape or (np.diff(where.astype(np.int64)) < 0).any():
        raise ValueError("rests need a rising segment and a time each")
    return np.ascontiguousarray(where, dtype=np.uint64), np.ascontiguousarray(seconds, dtype=np.float64)
