"""The motor shield's latch: phase levels to the byte of its 74HCT595 shift register.

Both motors share one register.  A step clears the four bits of its own motor and sets those of the terminals that are
high; the other motor's stay.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Sequence

STEP_WORK = 0.186e-3
"""What a step costs the shield's library beside its wait [s]: 2971 cycles of 16 MHz.

The register is loaded by 27 writes to pins by their numbers, some 80 cycles each; the wait is divided into milliseconds
and a rest, twice by 32 bits.  Counted on a simulated ATmega328P, for code that does the same.
"""

BITS = {1: (2, 1, 3, 4), 2: (5, 0, 7, 6)}  #: motor -> bits of A+, B+, A-, B-


def latch_byte(levels: Sequence[float], motor: int, image: int = 0) -> int:
    """Return the register's byte for the levels of a motor's two phases; what ``image`` says of the other motor stays.

    Raises
    ------
    ConfigError
        When the motor is not 1 or 2, or the image is no byte.
    """
    if motor not in BITS:
        raise ConfigError(f"the shield has the motors 1 and 2, not {motor!r}")
    if not 0 <= image <= 0xFF:
        raise ConfigError(f"the register's image must be a byte, 0 to 255, not {image!r}")
    a, b = levels
    high = (a > 0, b > 0, a < 0, b < 0)
    own = sum(1 << bit for bit in BITS[motor])
    return image & ~own | sum(1 << bit for bit, on in zip(BITS[motor], high, strict=True) if on)


def serial_bits(byte: int) -> tuple[int, ...]:
    """Return the byte's bits in the order they are shifted out: bit 7 first."""
    return tuple(byte >> bit & 1 for bit in range(7, -1, -1))
