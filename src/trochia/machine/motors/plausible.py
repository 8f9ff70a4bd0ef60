"""Whether a catalogue's numbers can be a stepper at all: a unit slipped by a thousand is told, with what would do.

In: the numbers of a row.  Out: nothing, or a ConfigError.  The ranges are wide: they are
there to find slips, not to judge motors.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.errors import ConfigError

if TYPE_CHECKING:
    from trochia.machine.motors.catalogue import CatalogueStepper

TIME_CONSTANT = (20e-6, 0.2)  #: L/R [s]
RATED_VOLTAGE = (0.05, 250.0)  #: R I [V]
ACCELERATION = (300.0, 3e6)  #: holding torque over rotor inertia [rad/s²]
FLUX = (0.03, 30.0)  #: the magnet's flux over that of the rated current, K/(p L I)
VOLTAGE = (0.4, 2.5)  #: rated voltage over R I


def check_plausible(row: CatalogueStepper) -> None:
    """Refuse numbers that do not belong together.

    Raises
    ------
    ConfigError
        Naming the key to look at first, the number that fails, and one that would do.
    """
    drop = row.resistance * row.current
    said = f"{row.current:g} A through {row.resistance:g} ohm take {drop:.4g} V"
    _within("current", drop, RATED_VOLTAGE, said, (row.current, "A"))
    constant = row.inductance / row.resistance
    said = f"{row.inductance * 1e3:g} mH over {row.resistance:g} ohm is a time constant of {constant:.4g} s"
    _within("inductance", constant, TIME_CONSTANT, said, (row.inductance * 1e3, "mH"))
    slowness = row.inertia / row.holding_torque
    said = f"{row.holding_torque:g} N·m would turn the rotor at {1 / slowness:.4g} rad/s²"
    _within("inertia", slowness, (1 / ACCELERATION[1], 1 / ACCELERATION[0]), said, (row.inertia * 1e7, "g·cm²"))
    flux = row.torque_constant / (row.full_steps / 4 * row.inductance * row.current)
    said = f"{row.holding_torque:g} N·m at {row.current:g} A make the magnet's flux {flux:.4g} times the current's"
    _within("holding_torque", flux, FLUX, said, (row.holding_torque, "N·m"))
    if row.voltage is not None:
        said = f"{row.voltage:g} V are {row.voltage / drop:.4g} times what {row.current:g} A take"
        _within("voltage", row.voltage / drop, VOLTAGE, said, (row.voltage, "V"))


def _within(name: str, value: float, bounds: tuple[float, float], said: str, number: tuple[float, str]) -> None:
    """Refuse a value outside its bounds; ``number``, with its unit, is proportional to it, so what would do follows."""
    low, high = bounds
    if low <= value <= high:
        return
    nearest, side = (low, "above") if value < low else (high, "below")
    raise ConfigError(
        f"cannot be right: {said}",
        key=name,
        hint=f"Look at the units: {side} {number[0] * nearest / value:.3g} {number[1]} would do with the others.",
    )
