"""The excitation modes, where those look for them who make pulses; ``machine/motors/excitation.py`` states them."""

from trochia.machine.motors.excitation import (
    EXCITATIONS,
    FINEST,
    Excitation,
    excitation,
    half_step,
    microstep,
    one_phase,
    table_microstep,
    two_phase,
)

__all__ = [
    "EXCITATIONS",
    "FINEST",
    "Excitation",
    "excitation",
    "half_step",
    "microstep",
    "one_phase",
    "table_microstep",
    "two_phase",
]
