"""Reads the motor shield from the chip's pins: the shift register's bytes, and the duties of the bridges."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.backends.simulated_chip import PIN, PWM

if TYPE_CHECKING:
    import numpy as np

#: timer and channel -> motor and phase
BRIDGES = {(b"2", 0): (1, "A"), (b"2", 1): (1, "B"), (b"0", 0): (2, "A"), (b"0", 1): (2, "B")}


class Register:
    """A 74HCT595 on D8 (data), D4 (clock), D12 (latch); ``latched`` has (cycle, byte), ``duties`` those of the bridges.

    A bridge's duty is in force from its entry (cycle, motor, phase, duty) on.
    """

    def __init__(self) -> None:
        self.data = self.held = 0
        self.latched: list[tuple[int, int]] = []
        self.duties: list[tuple[int, int, str, int]] = []

    def feed(self, events: np.ndarray) -> Register:
        for event in events:
            kind, unit, line, value = event["kind"], bytes(event["unit"]), int(event["line"]), int(event["value"])
            if kind == PWM and (unit, line) in BRIDGES:
                self.duties.append((int(event["cycle"]), *BRIDGES[unit, line], value & 0xFFFF))
            if kind != PIN:
                continue
            if (unit, line) == (b"B", 0):
                self.data = value
            elif (unit, line, value) == (b"D", 4, 1):
                self.held = (self.held << 1 | self.data) & 0xFF
            elif (unit, line, value) == (b"B", 4, 1):
                self.latched.append((int(event["cycle"]), self.held))
        return self

    @property
    def bytes(self) -> list[int]:
        return [byte for _, byte in self.latched]

    def duty(self, motor: int, phase: str, cycle: int) -> int:
        """Return the duty of a bridge at a cycle; 0 before it had one."""
        mine = [entry[3] for entry in self.duties if entry[1:3] == (motor, phase) and entry[0] <= cycle]
        return mine[-1] if mine else 0
