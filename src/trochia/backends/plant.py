"""What is really there, joint by joint: the ideal plant of the live twin.

In: joint positions as commanded.  Out: where motors and loads really are.  Positions are real ones: what a controller
calls them may be off by anything until it has homed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.kernels.twin import TwinJoint

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.machine import Machine


class IdealPlant:
    """Ideal motors, transmissions with backlash, encoders.

    Parameters
    ----------
    position
        Where the joints are (joints,) [mm or degree].

    Attributes
    ----------
    motor, load
        Where they are (joints,).
    jammed
        Names of joints whose load and motor stay where they are, whatever is commanded.
    """

    def __init__(self, machine: Machine, position: NDArray[np.float64]) -> None:
        self._machine = machine
        self._joints = [
            TwinJoint(
                float(at), name=joint.name, steps_per_unit=joint.steps_per_unit, counts_per_unit=joint.counts_per_unit,
                on_load=joint.encoder is not None and joint.encoder.on_load, backlash=joint.backlash,
            )
            for at, joint in zip(position, machine.joints, strict=True)
        ]  # fmt: skip
        self.motor, self.load = position.copy(), position.copy()
        self.jammed: set[str] = set()

    def follow(self, commanded: NDArray[np.float64]) -> NDArray[np.float64]:
        """Follow a block of commands (ticks, joints); return where the loads were (ticks, joints)."""
        loads = np.tile(self.load, (len(commanded), 1))
        for i, joint in enumerate(self._joints):
            if self._machine.joints[i].name not in self.jammed:
                block = joint.run(commanded[:, i])
                loads[:, i] = block.load
                self.motor[i], self.load[i] = block.motor[-1], block.load[-1]
        return loads

    def encoder(self) -> NDArray[np.float64]:
        """Return what the encoders say (joints,); NaN where there is none."""
        read = np.full(len(self._joints), np.nan)
        for i, joint in enumerate(self._machine.joints):
            if joint.encoder is not None:
                read[i] = self.load[i] if joint.encoder.on_load else self.motor[i]
        return read
