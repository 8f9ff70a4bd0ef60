"""Friction of a body that turns or slides: Coulomb, Stribeck, viscous.

    T(w) = (Fc + (Fs - Fc) exp(-(w / ws)²)) tanh(w / eps) + B w + offset

(Armstrong-Hélouvry, *Control of Machines with Friction*); eps makes it smooth through zero, so that a body at rest
under a force creeps instead of sticking.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, kw_only=True)
class Friction:
    """Friction in SI units of a rotation [N·m, rad/s] or of a slide [N, m/s].

    Attributes
    ----------
    coulomb, stick
        Level when moving, and at the onset; ``stick`` 0 means the same as ``coulomb``.
    stribeck
        Speed over which the one becomes the other.
    viscous
        Per unit of speed.
    offset
        A constant force against positive motion, as of a weight or an unbalanced amplifier.
    smooth
        Speed over which the sign turns.
    """

    coulomb: float = 0.0
    stick: float = 0.0
    stribeck: float = 0.0
    viscous: float = 0.0
    offset: float = 0.0
    smooth: float = 1e-3

    def __post_init__(self) -> None:
        for name in ("coulomb", "stick", "stribeck", "viscous"):
            if not getattr(self, name) >= 0.0:
                raise ValueError(f"friction: {name} must not be below zero, not {getattr(self, name)!r}")
        if not self.smooth > 0.0:
            raise ValueError(f"friction: smooth must be above zero, not {self.smooth!r}")

    @property
    def onset(self) -> float:
        """Level at the onset of motion."""
        return self.stick or self.coulomb

    def force(self, speed: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the force against the motion at speeds (any shape)."""
        level = np.full(np.shape(speed), self.coulomb)
        if self.stribeck > 0.0:
            level = level + (self.onset - self.coulomb) * np.exp(-((speed / self.stribeck) ** 2))
        return level * np.tanh(speed / self.smooth) + self.viscous * speed + self.offset


FRICTIONLESS = Friction()
