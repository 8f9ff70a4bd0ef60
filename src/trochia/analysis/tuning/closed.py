"""What gains do to a plant that is written as a fraction in s: poles, margins, step of the closed loop.

In: a plant's numerator and denominator, gains.  Out: :class:`ClosedLoop`, by python-control.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.analysis.tuning.margins import Margins, margins_of
from trochia.analysis.tuning.metrics import StepMetrics, step_metrics

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from trochia.analysis.tuning.models import Gains

    Array = NDArray[np.float64]

_SAMPLES = 20000
_LASTS = 14.0  # time constants of the slowest pole that matters
_TINY = 0.02  # residue below which a pole does not set the length of a step


@dataclass(frozen=True, slots=True, kw_only=True)
class ClosedLoop:
    """Of unit feedback.

    Attributes
    ----------
    poles
        [1/s], fastest first.
    margins, step
        Of the open loop, and of the closed one's step.
    """

    poles: NDArray[np.complex128]
    margins: Margins
    step: StepMetrics

    @property
    def stable(self) -> bool:
        """Whether all poles are on the left."""
        return bool((self.poles.real < 0.0).all())


def closed_loop(
    gains: Gains, numerator: Sequence[float], denominator: Sequence[float], *, duration: float | None = None
) -> ClosedLoop:
    """Return the closed loop of gains around numerator / denominator (highest power first).

    Parameters
    ----------
    duration
        Of the step [s]; None: from the second-slowest pole, as a slow pole beside a zero hardly shows.
    """
    import control  # noqa: PLC0415 - slow to import

    plant: Any = control.tf(list(numerator), list(denominator))
    whole = fraction(gains) * plant
    closed: Any = control.feedback(whole, 1)
    poles = np.asarray(closed.poles(), np.complex128)
    poles = poles[np.argsort(poles.real)]
    stable = bool((poles.real < 0.0).all())
    size = np.abs(poles)
    margins = margins_of(lambda w: np.asarray(whole(1j * w), np.complex128), size.min() * 1e-2, size.max() * 1e3,
                         stable=stable)  # fmt: skip
    if duration is None:
        slow = np.sort(-poles.real)
        duration = _LASTS / float(abs(slow[min(1, len(slow) - 1)]) or 1.0)
    t = np.linspace(0.0, duration, _SAMPLES)
    _, y = control.step_response(closed, t)
    return ClosedLoop(poles=poles, margins=margins, step=step_metrics(t, np.asarray(y, np.float64), 1.0))


def fraction(gains: Gains) -> Any:  # noqa: ANN401 - python-control's
    """Return the controller as python-control's transfer function."""
    import control  # noqa: PLC0415 - slow to import

    s: Any = control.tf("s")
    derivative = gains.kd * s if gains.filter is None else gains.kd * s / (s / gains.filter + 1.0)
    whole: Any = gains.kp + derivative
    return whole + gains.ki / s if gains.ki else whole
