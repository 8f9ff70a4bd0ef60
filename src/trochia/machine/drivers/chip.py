"""What a driver chip allows, whatever is set at it.  In: a supply, microsteps.  Out: nothing, or why not."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from trochia.errors import ConfigError
from trochia.machine.motors.excitation import Excitation, excitation

_BY_MICROSTEPS = {1: "two-phase", 2: "half-step"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Chip:
    """One chip.

    Attributes
    ----------
    supply
        Lowest and highest [V].
    microsteps
        Those it can be set to.
    source, checked, note
        Where its figures come from, whether someone has read that again for the row, what a reader should know.
    circular
        Whether its tables keep the field's length, so that full steps give both phases 71 % of the current.
    """

    supply: tuple[float, float]
    microsteps: tuple[int, ...]
    source: str
    checked: bool = False
    note: str = ""
    circular: bool = True


def check_supply(chip: Chip | None, name: str, supply: float) -> None:
    """Refuse a supply the chip does not take.

    Raises
    ------
    ConfigError
        Naming the range.
    """
    if chip is None:
        return
    least, most = chip.supply
    if not least <= supply <= most:
        raise ConfigError(f"{name} takes {least:g} to {most:g} V, not {supply:g} V", key="supply")


def excited(chip: Chip | None, name: str, asked: str | None, microsteps: int | None) -> Excitation:
    """Return how the phases are switched: as asked, or by microsteps.

    Raises
    ------
    ConfigError
        For an excitation that is none or of other microsteps, and microsteps that the chip has not.
    """
    circular = chip is not None and chip.circular
    mode = _mode(asked or (f"microstep-{microsteps}" if circular and (microsteps or 1) > 1 else
                           _BY_MICROSTEPS.get(microsteps or 1, f"microstep-{microsteps}")))  # fmt: skip
    if microsteps is not None and mode.steps_per_full_step != microsteps:
        raise ConfigError(
            f"{mode.name} takes {mode.steps_per_full_step} pulses a full step, the motor is set to {microsteps}",
            key="driver.excitation",
            hint=f"microsteps = {mode.steps_per_full_step} would do.",
        )
    if chip is not None and mode.steps_per_full_step not in chip.microsteps:
        raise ConfigError(
            f"{name} has {', '.join(map(str, chip.microsteps))} microsteps a full step, not {mode.steps_per_full_step}",
            key="motor.microsteps",
        )
    return replace(mode, levels=mode.levels * math.sqrt(0.5)) if circular and mode.name == "two-phase" else mode


def _mode(name: str) -> Excitation:
    try:
        return excitation(name)
    except ConfigError as error:
        raise ConfigError(error.plain, key="driver.excitation", hint=error.hint) from None
