"""Inputs of a board by the names its machine has for them.

In: the last status.  Out: whether each is active.  On the simulated chip they can be set, and switches of axes are
where its steps have taken the machine, which stands at 0 at power-up.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import numpy as np
    from numpy.typing import NDArray

    from trochia.backends.avr.live_avr import LiveAvr

    Switch = Callable[[NDArray[np.float64]], bool]


class Inputs:
    """Inputs of the board by name, as the last status has them; on the simulated chip they can be set."""

    def __init__(self, backend: LiveAvr) -> None:
        self._backend = backend
        self._switches: dict[str, Switch] = {}

    def follow(self, switches: Mapping[str, Switch]) -> None:
        """Have inputs told by where the joints really are (joints,) [mm or degree], from the next status on."""
        self._switches = {name: switch for name, switch in switches.items() if name in self._backend.wiring.inputs}

    def look(self, joints: NDArray[np.float64]) -> None:
        """Put the inputs that are told by where the joints are."""
        for name, switch in self._switches.items():
            self[name] = switch(joints)

    def set(self, levels: Mapping[str, float]) -> None:
        """Make inputs active or not, by name."""
        for name, level in levels.items():
            self[name] = bool(level)

    def levels(self) -> dict[str, bool]:
        """Return whether each is active."""
        backend = self._backend
        return {name: self[name] for name in backend.wiring.inputs}

    def __getitem__(self, name: str) -> bool:
        """Whether an input is active."""
        bit, active = self._backend.wiring.inputs[name]
        return (int(self._backend.status["inputs"]) >> bit & 1) == active

    def __setitem__(self, name: str, value: bool) -> None:
        """Make an input active or not."""
        active = self._backend.wiring.inputs[name][1]
        self.put(name, level=active if value else 1 - active)

    def put(self, name: str, *, level: int) -> None:
        """Put an input's pin to a level."""
        backend = self._backend
        if backend.transport.stride:
            bit = backend.wiring.inputs[name][0]
            backend.transport.set_input(backend.board.inputs[bit], level)
