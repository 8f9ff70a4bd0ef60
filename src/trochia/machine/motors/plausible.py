"""Whether a catalogue's numbers can be a stepper at all: a slipped unit is told, with what would do.

In: the numbers of a row.  Out: nothing, or a ConfigError.  The ranges hold every motor of the library several times
over: they are there to find slips, not to judge motors.

The flux ratio finds most.  Holding torque, current, inductance and teeth of one motor belong together: the magnet's
flux in a phase, K/p, and that of the rated current, L I, are of one size whatever the frame, 0.2 to 1.2 in the library.
"""

from __future__ import annotations

import math
from itertools import permutations
from typing import TYPE_CHECKING

from trochia import units
from trochia.errors import ConfigError

if TYPE_CHECKING:
    from trochia.machine.motors.catalogue import CatalogueStepper

TIME_CONSTANT = (50e-6, 0.1)  #: L/R [s]
RATED_VOLTAGE = (0.1, 150.0)  #: R I [V]
ACCELERATION = (2e3, 2e6)  #: holding torque over rotor inertia [rad/s²]
FLUX = {"hybrid": (0.08, 4.0), "permanent-magnet": (0.05, 8.0)}  #: K/(p L I)
VOLTAGE = (0.4, 2.5)  #: rated voltage over R I
#: what catalogues print each in; one typed for the other is what slips
_PRINTED = {
    "resistance": ("resistance", "ohm", ("ohm", "mohm")),
    "current": ("current", "A", ("A", "mA")),
    "inductance": ("inductance", "mH", ("H", "mH", "uH")),
    "holding_torque": ("torque", "N·m", ("N·m", "kgf·cm", "oz·in", "N·cm", "mN·m", "gf·cm")),
    "inertia": ("inertia", "g·cm²", ("kg·m²", "kg·cm²", "oz·in²", "g·cm²")),
    "voltage": ("voltage", "V", ("V", "mV")),
}


def check_plausible(row: CatalogueStepper) -> None:
    """Refuse numbers that do not belong together.

    Raises
    ------
    ConfigError
        Naming the key to look at first, the number that fails, and one that would do.
    """
    drop = row.resistance * row.current
    said = f"{row.current:g} A through {row.resistance:g} ohm take {drop:.4g} V"
    _within("current", drop, RATED_VOLTAGE, said, row.current)
    constant = row.inductance / row.resistance
    said = f"{row.inductance * 1e3:g} mH over {row.resistance:g} ohm is a time constant of {constant:.4g} s"
    _within("inductance", constant, TIME_CONSTANT, said, row.inductance)
    flux = row.torque_constant / (row.full_steps / 4 * row.inductance * row.current)
    said = (f"{row.holding_torque:g} N·m at {row.current:g} A make the magnet's flux {flux:.4g} times the current's, "
            f"with {row.full_steps} full steps and {row.inductance * 1e3:g} mH")  # fmt: skip
    _within("holding_torque", flux, FLUX[row.kind], said, row.holding_torque)
    slowness = row.inertia / row.holding_torque
    said = f"{row.holding_torque:g} N·m would turn the rotor at {1 / slowness:.4g} rad/s²"
    _within("inertia", slowness, (1 / ACCELERATION[1], 1 / ACCELERATION[0]), said, row.inertia)
    if row.voltage is not None:
        said = (f"{row.voltage:g} V are {row.voltage / drop:.4g} times what {row.current:g} A take; it is the motor's, "
                "not the driver's supply")  # fmt: skip
        _within("voltage", row.voltage / drop, VOLTAGE, said, row.voltage)


def _within(name: str, value: float, bounds: tuple[float, float], said: str, number: float) -> None:
    """Refuse a value outside its bounds; ``number`` [base unit] is proportional to it, so what would do follows."""
    low, high = bounds
    if low <= value <= high:
        return
    dimension, unit, _ = _PRINTED[name]
    factor = units.UNITS[dimension][unit]
    least, most = (f"{float(f'{number * bound / value / factor:.2g}'):g}" for bound in bounds)
    raise ConfigError(
        f"cannot be right: {said}",
        key=name,
        hint=f"With the others, {least} to {most} {unit} would do.{_slip(name, value, bounds, number)}",
    )


def _slip(name: str, value: float, bounds: tuple[float, float], number: float) -> str:
    """Return which unit was likely typed for another: one the figure looks typed in, for the two nearest the middle."""
    dimension, unit, printed = _PRINTED[name]
    factors = units.UNITS[dimension]
    middle = (bounds[0] * bounds[1]) ** 0.5
    found: dict[tuple[bool, int], list[tuple[float, str]]] = {}
    for typed, meant in permutations(printed, 2):
        figure, would_be = number / factors[typed], value * factors[meant] / factors[typed]
        as_typed = figure >= 0.01 and math.isclose(figure, float(f"{figure:.3g}"), rel_tol=1e-9)  # nobody types 611.829
        if as_typed and bounds[0] <= would_be <= bounds[1]:
            same = "" if meant == unit else f" ({figure * factors[meant] / factors[unit]:.3g} {unit})"
            off = max(would_be / middle, middle / would_be)
            found.setdefault((figure < 1.0, printed.index(typed)), []).append((off, f"{figure:g} {meant}{same}"))
    if not found:
        return ""
    best = min(found)
    meanings = " or ".join(words for _, words in sorted(found[best])[:2])
    return f"  Is it {meanings}, not {number / factors[printed[best[1]]]:g} {printed[best[1]]}?"
