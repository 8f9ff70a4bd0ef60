"""Boards: what is wired to which of their inputs and outputs.

In: the machine's channels.  Out: bits.  A channel's ``pin`` is the board's own number of the input or output; those
without one take the next that is free.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.backends.avr.windings import MASK, windings
from trochia.errors import ConfigError
from trochia.kernels.link import LOOK, PUT

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from trochia.backends.live import Orders, Watch
    from trochia.machine.machine import Machine
    from trochia.machine.panel import Panel


@dataclass(frozen=True, slots=True, kw_only=True)
class Board:
    """One kind of board: the chip, its pins by number, and how many motors it has.

    Attributes
    ----------
    closest
        Two steps of a motor [ticks].
    coils
        Whether the chip drives the windings itself; else it makes step pulses.
    """

    name: str
    mcu: str
    programmer: str
    motors: int
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    closest: int = 64
    coils: bool = False


BOARDS = {
    board.name: board
    for board in (
        Board(
            name="uno-stepdir", mcu="atmega328p", programmer="arduino", motors=4,
            inputs=("B1", "B2", "C0", "C1", "C2", "C5"), outputs=("C3", "C4"),
        ),
        Board(
            name="mega-stepdir", mcu="atmega2560", programmer="wiring", motors=6,
            inputs=("B4", "B5", "B6", "K0", "K1", "K2", "K3", "K7"), outputs=("H5", "H6", "H3", "E3"),
        ),
        Board(
            name="uno-l293d", mcu="atmega328p", programmer="arduino", motors=2,
            inputs=("C0", "C1", "C2", "C3", "C4", "C5"), outputs=("B1", "D2"), closest=1600, coils=True,
        ),
    )
}  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class Wiring:
    """Bits of a machine's channels: inputs with the level at which each is active, and outputs.

    ``windings`` is what a board that drives windings has in its other outputs, those of ``mask``.
    """

    inputs: dict[str, tuple[int, int]]
    outputs: dict[str, int]
    windings: int = 0
    mask: int = 0

    def levels(self, values: Mapping[str, float]) -> int:
        """Return the levels of all outputs, a bit each."""
        return self.windings | sum(1 << bit for name, bit in self.outputs.items() if values[name])

    def put(self, orders: Orders, values: Mapping[str, float]) -> bytes:
        """Return the order that puts drives, light and outputs as these orders say, outputs being ``values`` then."""
        put = np.zeros((), PUT)
        put["enable"] = 255 if orders.enable is None else orders.enable
        put["lit"] = 255 if orders.lit is None else orders.lit
        put["mask"] = self.mask | sum(1 << self.outputs[name] for name in orders.outputs if name in self.outputs)
        put["outputs"] = self.levels(values)
        return put.tobytes()

    def stops(self, panel: Panel | None) -> int:
        """Return the inputs at which the board stops by itself, a bit each: an emergency stop that pulls one low."""
        bit, active = self.inputs.get((panel.estop if panel is not None else None) or "", (0, 1))
        return 0 if active else 1 << bit

    def look(self, watch: tuple[Watch, ...]) -> bytes:
        """Return the order that watches inputs."""
        look = np.zeros((), LOOK)
        for watched in watch:
            bit, active = self.inputs[watched.name]
            look["mask"] |= 1 << bit
            look["levels"] |= (active if watched.level else 1 - active) << bit
        return look.tobytes()


def _placed(names: list[tuple[str, int | None]], room: int, what: str) -> dict[str, int]:
    taken = {pin for _, pin in names if pin is not None}
    free = iter(i for i in range(room) if i not in taken)
    bits: dict[str, int] = {}
    for name, pin in names:
        bit = next(free, room) if pin is None else pin
        if bit >= room:
            raise ConfigError(f"the board has no {what} {bit}: it has {room}", key=f"io.{name}.pin")
        bits[name] = bit
    return bits


def wire(machine: Machine, board: Board) -> Wiring:
    """Return which bit is which channel; an input is active when low, unless it is inverted.

    Raises
    ------
    ConfigError
        For more channels than the board has, or an excitation that it has not.
    """
    inputs = [channel for channel in machine.io if channel.kind == "input"]
    outputs = [channel for channel in machine.io if not channel.kind.endswith("input")]
    bits = _placed([(channel.name, channel.pin) for channel in inputs], len(board.inputs), "input")
    return Wiring(
        inputs={channel.name: (bits[channel.name], int(channel.inverted)) for channel in inputs},
        outputs=_placed([(channel.name, channel.pin) for channel in outputs], len(board.outputs), "output"),
        windings=windings(machine) if board.coils else 0,
        mask=MASK if board.coils else 0,
    )


def steps_per_unit(machine: Machine, motors: int) -> NDArray[np.float64]:
    """Return steps a unit of every joint (joints,) [1/mm or 1/degree].

    Raises
    ------
    ConfigError
        For more joints than motors, or one that is no stepper.
    """
    if len(machine.joints) > motors:
        raise ConfigError(f"the board has {motors} motors, the machine {len(machine.joints)} joints", key="joints")
    scale: list[float] = []
    for joint in machine.joints:
        if joint.steps_per_unit is None:
            raise ConfigError("must be a stepper: the board makes steps", key=f"joints.{joint.name}.motor")
        scale.append(float(joint.steps_per_unit))
    return np.array(scale)
