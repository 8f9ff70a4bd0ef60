"""What a motor on the shield makes of its steps: its twin behind the L293D, whatever the way of excitation.

In: steps and releases as the shield's motors make them.  Out: where the rotor stands, how fast it turns, what it lost.
Legend: positions are sixty-fourths of an electrical turn, as the shield counts them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trochia.backends.stepper_twin import STEP, StepperTwin
from trochia.machine.drivers import HBridge, fed
from trochia.machine.motors import ShaftLoad, motor
from trochia.machine.motors.excitation import Excitation, half_step, table_microstep
from trochia.stepper.outputs import TwinOutput
from trochia.stepper.shield import MICROSTEP, Style

if TYPE_CHECKING:
    from trochia.machine.motors import HybridStepper

SUPPLY = 12.0  #: of the shield's motors [V]
RIG = ShaftLoad(inertia=1.5e-6, friction=0.005)  #: a coupling and a disc; assumed, the source tells nothing of its rig
_SECTORS = np.repeat(half_step().levels, 8, axis=0)  # a level for each of 64 positions
_MICRO = np.array(table_microstep().levels)


@dataclass(frozen=True, slots=True, kw_only=True)
class Rotor:
    """Where a rotor is.

    Attributes
    ----------
    angle, asked
        Where it stands, and where the steps so far would have it [degrees from power-up].
    rpm
        Mean speed since it was last looked at.
    lost
        Full steps that it lost, a multiple of four.
    """

    angle: float
    asked: float
    rpm: float
    lost: int

    def __str__(self) -> str:
        """Return it for a person."""
        return f"rotor at {self.angle:.1f} of {self.asked:.1f} degrees, {self.lost or 'no'} steps lost"

    @property
    def turning(self) -> str:
        """The same while it turns."""
        return f"{self.rpm:6.1f} rpm, {self}"


class ShieldTwin(TwinOutput):
    """A motor on the shield, released at first, its rotor where one phase on has it.

    Parameters
    ----------
    shaft
        None: the source's, SM-42BYG011-25.
    keep
        Keep what it does, for a picture.
    """

    def __init__(self, shaft: HybridStepper | None = None, load: ShaftLoad = RIG, *, keep: bool = False) -> None:
        made = fed(shaft or motor("SM-42BYG011-25").parameters(), HBridge(supply=SUPPLY, excitation="half-step"))
        made = replace(made, excitation=Excitation(name="shield", levels=_SECTORS.copy()))
        super().__init__(StepperTwin(made, load, enabled=False), keep=keep)
        self._position = 0
        self._on = False
        self._micro = False
        self._seen = (0.0, 0.0)  # when it was looked at, and its angle [s, degrees]

    def excite(self, moment: float, position: int, direction: int, style: Style) -> None:
        """Go on to a position (0 … 63) in a direction, in a way of excitation."""
        if not self._on:
            self._on = True
            self.energise(moment, on=True)
        if self._micro != (style is MICROSTEP):
            self._micro = not self._micro
            self.settle(moment)
            self.twin.set_levels(_MICRO if self._micro else _SECTORS)
        for _ in range((position - self._position) * direction % 64):
            self.step(moment, direction)
        self._position = position

    def release(self, moment: float) -> None:
        """Short its windings."""
        self._on = False
        self.energise(moment, on=False)

    def look(self, moment: float) -> Rotor:
        """Return where it is at a moment [s]."""
        self.settle(moment - STEP)
        last = self.twin.run_ticks(1)
        angle, asked = float(np.degrees(last.theta[-1])), int(last.position[-1]) * 360 / (64 * 50)
        at, before = self._seen
        turned = (angle - before) / 6 / (self.twin.now - at) if self.twin.now > at else 0.0
        self._seen = self.twin.now, angle
        return Rotor(angle=angle, asked=asked, rpm=turned, lost=int(last.lost_steps[-1]))
