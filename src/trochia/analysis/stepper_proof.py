"""A stepper's move on the physical twin: are steps lost, where does it begin.

In: a velocity profile step by step, a motor behind its driver with its load.  Out: :class:`Proof`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.sweep.procedures import SETTLE, twin_of
from trochia.backends.stepper_twin import STEP, Levels

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from trochia.machine.drivers import Fed
    from trochia.machine.motors import ShaftLoad
    from trochia.pulses.ramps import Profile

    Floats = NDArray[np.float64]

LONGEST = 600.0  #: of a move that is proved [s]
SAMPLES = 50_000  #: kept of a run, some
STRETCHES = 50  #: after which it tells how far it is
REST = 0.3  #: after the last step: a rotor that swings comes to rest [s]
_EVEN = 1e-6  # of a delay: they are the same


@dataclass(frozen=True, slots=True, kw_only=True)
class Proof:
    """What the twin did.

    Attributes
    ----------
    lost
        Full steps it is short of at the end; negative where it ran ahead.
    step
        The step of the profile at which it first was a turn of the field off, where steps are lost for good.
    speed
        Of the profile there [steps/s].
    time, rotor
        When the rotor was looked at [s] from the first pulse's delay on, and its speed (samples,) [rad/s].
    """

    lost: int
    step: int | None
    speed: float | None
    time: Floats
    rotor: Floats

    @property
    def ok(self) -> bool:
        """Whether no step was lost."""
        return self.lost == 0

    def steady(self, made: Profile) -> bool:
        """Whether steps were lost where the profile holds its speed: it is the speed that is too much, not the ramp."""
        if self.step is None:
            return False
        around = made.delays[max(self.step - 1, 0) : self.step + 2]
        return float(np.ptp(around)) <= _EVEN * float(around.min())


def prove_move(made: Profile, fed: Fed, load: ShaftLoad, progress: Callable[[str, float], None] | None = None) -> Proof:
    """Return what a motor does with a profile's pulses; each is one row of its excitation."""
    twin = twin_of(fed, load, Levels())
    zero, begin = int(twin.run(SETTLE).position[-1]), twin.now
    twin.queue(begin + made.times)
    whole = made.duration + REST
    every = max(1, round(whole / STEP / SAMPLES))
    parts: list[tuple[Floats, Floats, NDArray[np.int64], NDArray[np.int64]]] = []
    for stretch in range(STRETCHES):
        if progress is not None:
            progress("on the twin", stretch / STRETCHES)
        run = twin.run(whole / STRETCHES, every=every)
        parts.append((run.time - begin, run.omega, run.lost_steps, run.position))
    time, rotor, lost, position = (np.concatenate(column) for column in zip(*parts, strict=True))
    final = int(lost[-1])
    if not final:
        return Proof(lost=0, step=None, speed=None, time=time, rotor=rotor)
    # from the last sample on which it still was in step
    held = np.flatnonzero(lost == 0)
    row = min(int(held[-1]) + 1 if held.size else 0, lost.size - 1)
    step = min(max(int(position[row]) - zero, 0), made.delays.size - 1)
    return Proof(lost=final, step=step, speed=float(made.speeds[step]), time=time, rotor=rotor)
