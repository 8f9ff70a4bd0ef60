"""A machine file as GRBL's settings.  In: a machine.  Out: ``$0`` and on, to be looked at: the file is what counts."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from trochia.machine.axes import Axis
    from trochia.machine.machine import Machine

LETTERS = "XYZ"


def settings_of(machine: Machine, report: int) -> dict[str, str]:
    """Return the settings by name; ``report`` is the mask of status reports ($10)."""
    axes = {axis.name: axis for axis in machine.axes}
    homes = {name: axis.home for name, axis in axes.items() if axis.home is not None}
    towards = sum(1 << LETTERS.index(name) for name, home in homes.items()
                  if name in LETTERS and home.towards == "-")  # fmt: skip
    greatest, least = _tool(machine)
    found = {
        "$0": "10", "$1": "255", "$2": "0", "$3": "0", "$4": "0", "$5": "0", "$6": "0", "$10": str(report),
        "$11": "0.010", "$12": "0.002", "$13": "0", "$20": "1", "$21": "1" if homes else "0",
        "$22": "1" if homes else "0", "$23": str(towards), "$24": "25.000", "$25": "500.000", "$26": "250",
        "$27": "1.000", "$30": f"{greatest:g}", "$31": f"{least:g}", "$32": "0" if machine.beam is None else "1",
    }  # fmt: skip
    for base, value in ((100, _steps), (110, _rate), (120, _acceleration), (130, _travel)):
        for at, letter in enumerate(LETTERS):
            axis = axes.get(letter)
            found[f"${base + at}"] = f"{value(machine, axis) if axis is not None else 0.0:.3f}"
    return found


def _tool(machine: Machine) -> tuple[float, float]:
    """Return the greatest and the least S."""
    if machine.beam is not None:
        return machine.beam.full_power or 1000.0, 0.0
    return (machine.spindle.maximum, machine.spindle.minimum) if machine.spindle is not None else (1000.0, 0.0)


def _steps(machine: Machine, axis: Axis) -> float:
    joint = next((joint for joint in machine.joints if joint.name == axis.name), None)
    return float((joint.steps_per_unit or joint.counts_per_unit or 0) if joint is not None else 0)


def _rate(_machine: Machine, axis: Axis) -> float:
    return 60.0 * axis.velocity


def _acceleration(_machine: Machine, axis: Axis) -> float:
    return axis.acceleration


def _travel(_machine: Machine, axis: Axis) -> float:
    return axis.maximum - axis.minimum
