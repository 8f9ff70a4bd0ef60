"""Whether the parts of a machine fit together.  In: a Machine under construction.  Out: nothing, or a ConfigError."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import ConfigError
from trochia.machine.axes import LETTERS, AxisKind
from trochia.machine.corrections import check_corrections
from trochia.machine.rates import joint_velocity, step_rate
from trochia.units import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Iterable

    from trochia.machine.axes import Axis
    from trochia.machine.joints import Joint
    from trochia.machine.machine import Machine


def check(machine: Machine) -> None:
    """Hold a machine to what no single part can see.

    Raises
    ------
    ConfigError
        Naming the key to change: a name used twice, axes out of order, an axis no joint drives, a joint in other
        units than its axes, more steps a second than the driver takes, a profile whose limits are missing, a pin used
        twice.
    """
    _check_names(machine)
    _check_kinematics(machine)
    for index in range(len(machine.joints)):
        _check_joint(machine, index)
    if machine.profile == "s-curve":
        for axis in machine.axes:
            if axis.jerk is None:
                raise ConfigError("missing: the profile s-curve needs it", key=f"axes.{axis.name}.jerk")
    _check_pins(machine)
    _check_switches(machine)
    check_corrections(machine)
    _check_panel(machine)


def _check_names(machine: Machine) -> None:
    """Refuse an empty machine, names used twice, axes out of order."""
    if not machine.name.strip():
        raise ConfigError("must not be empty", key="name")
    for section, names in (
        ("axes", [axis.name for axis in machine.axes]),
        ("joints", [joint.name for joint in machine.joints]),
        ("io", [channel.name for channel in machine.io]),
    ):
        if not names and section != "io":
            raise ConfigError(f"a machine needs {section}, at least one", key=section)
        if twice := _twice(names):
            raise ConfigError(f"{twice} stands twice", key=section)
    letters = [axis.name for axis in machine.axes]
    if letters != sorted(letters, key=LETTERS.index):
        raise ConfigError(f"must stand in the order {' '.join(LETTERS)}, not {' '.join(letters)}", key="axes")


def _twice(names: Iterable[object]) -> object | None:
    """Return a name that stands more than once."""
    return next((name for name, count in Counter(names).items() if count > 1), None)


def _check_kinematics(machine: Machine) -> None:
    """Refuse joints that do not fit the kinematics, and axes that no joint (or no joint alone) drives."""
    matrix = machine.kinematics.matrix
    shape = (len(machine.joints), len(machine.axes))
    if matrix.shape != shape:
        raise ConfigError(f"{machine.kinematics.kind} kinematics is for {matrix.shape[0]} joints and {matrix.shape[1]} "
                          f"axes, the machine has {shape[0]} and {shape[1]}", key="joints")  # fmt: skip
    for axis, column in zip(machine.axes, matrix.T, strict=True):
        if not column.any():
            raise ConfigError("no joint drives it", key=f"axes.{axis.name}",
                              hint=f'Add [joints.{axis.name}], or a joint with axis = "{axis.name}".')  # fmt: skip
    if np.linalg.matrix_rank(matrix) < len(machine.axes):
        raise ConfigError("the joints cannot move the axes independently", key="joints")


def _check_joint(machine: Machine, index: int) -> None:
    """Refuse a transmission in other units than its axes, and more steps a second than the driver takes."""
    joint = machine.joints[index]
    moved = [axis for axis, c in zip(machine.axes, machine.kinematics.matrix[index], strict=True) if c]
    kinds = {axis.kind for axis in moved}
    if len(kinds) != 1:
        raise ConfigError("moves linear and rotary axes at once", key=f"joints.{joint.name}")
    moves = joint.transmission.moves
    if moves is not None and moves not in kinds:
        unit = {AxisKind.LINEAR: "mm", AxisKind.ROTARY: "degrees"}
        raise ConfigError(
            f"a {joint.transmission.kind} moves in {unit[moves]}, axis {moved[0].name} in {unit[moved[0].kind]}",
            key=f"joints.{joint.name}.transmission.kind")  # fmt: skip
    widest = max(axis.maximum - axis.minimum for axis in moved)
    if joint.backlash >= widest:
        raise ConfigError(f"must be less than the travel ({widest:g}), not {joint.backlash:g}",
                          key=f"joints.{joint.name}.backlash")  # fmt: skip
    _check_rate(joint, step_rate(machine, index), joint_velocity(machine, index), moved[0].unit)


def _check_rate(joint: Joint, rate: float | None, velocity: float, unit: str) -> None:
    """Hold the step rate to the driver's own limit and to its pulse timing."""
    if rate is None:
        if joint.pulse_rate is not None:
            raise ConfigError("only a stepper takes pulses", key=f"joints.{joint.name}.pulse_rate")
        return
    timing = 1 / (joint.pulses.length + joint.pulses.space)
    if joint.pulse_rate is not None and joint.pulse_rate > timing * (1 + 1e-9):
        raise ConfigError(f"pulses.length and pulses.space allow {timing:.6g} steps/s, not {joint.pulse_rate:.6g}",
                          key=f"joints.{joint.name}.pulse_rate")  # fmt: skip
    greatest, why = (timing, "pulses.length and pulses.space allow")
    if joint.pulse_rate is not None:
        greatest, why = joint.pulse_rate, "pulse_rate allows"
    if rate > greatest * (1 + 1e-9):
        fits = velocity * greatest / rate
        raise ConfigError(
            f"at {velocity:g} {unit}/s the joint needs {rate:.6g} steps/s, its {why} {greatest:.6g}",
            key=f"joints.{joint.name}.velocity",
            hint=f"Give the joint (or its axis) at most {fits:.6g} {unit}/s, or fewer microsteps, or a faster driver.",
        )


def _check_pins(machine: Machine) -> None:
    """Refuse two channels on one pin."""
    owners: dict[int, str] = {}
    for channel in machine.io:
        if channel.pin is None:
            continue
        if channel.pin in owners:
            raise ConfigError(f"pin {channel.pin} is already that of io.{owners[channel.pin]}",
                              key=f"io.{channel.name}.pin")  # fmt: skip
        owners[channel.pin] = channel.name


def _check_switches(machine: Machine) -> None:
    """Refuse switches that are no inputs of the machine, and ways home that lack what they need."""
    inputs = [channel.name for channel in machine.io if channel.kind == "input"]
    for axis in machine.axes:
        ends = {"limit_minus": axis.limit_minus, "limit_plus": axis.limit_plus}
        named = {f"{end}.input": switch.input for end, switch in ends.items() if switch is not None}
        home = axis.home
        if home is not None:
            if home.input is not None:
                named["home.input"] = home.input
            elif home.method.startswith("switch"):
                raise ConfigError(f"missing: the method {home.method} needs it", key=f"axes.{axis.name}.home.input")
            end = "limit_minus" if home.towards == "-" else "limit_plus"
            if home.method == "limit" and ends[end] is None:
                raise ConfigError("missing: the axis is homed to it", key=f"axes.{axis.name}.{end}")
            if home.second is not None:
                named["home.second"] = home.second
                _check_gantry(machine, axis)
            if home.method.endswith("index") and not _has_index(machine, axis.name):
                raise ConfigError("needs a joint whose encoder gives an index", key=f"axes.{axis.name}.home.method")
        for key, name in named.items():
            if name not in inputs:
                raise ConfigError(f"there is no input {name!r} under [io]", key=f"axes.{axis.name}.{key}",
                                  hint=did_you_mean(name, inputs))  # fmt: skip


def _check_panel(machine: Machine) -> None:
    """Refuse a probe and guards that are no inputs of the machine, and a beam's key where there is no beam."""
    inputs = [channel.name for channel in machine.io if channel.kind == "input"]
    named = {f"panel.{key}": name for key, name in (machine.panel.inputs if machine.panel else {}).items()}
    if machine.probe is not None:
        named["probe.input"] = machine.probe.input
    for key, name in named.items():
        if name not in inputs:
            raise ConfigError(f"there is no input {name!r} under [io]", key=key, hint=did_you_mean(name, inputs))
    named = {f"io.{c.name}.follows": c.follows for c in machine.io if c.follows is not None}
    for key, name in named.items():
        if name not in inputs:
            raise ConfigError(f"there is no input {name!r} under [io]", key=key, hint=did_you_mean(name, inputs))
    if machine.beam is None and machine.panel is not None and machine.panel.arm is not None:
        raise ConfigError("only a machine with a beam has one", key="panel.arm", hint="Add [beam], or leave it out.")


def _check_gantry(machine: Machine, axis: Axis) -> None:
    """Refuse a second home switch of an axis that is no pair of joints of its own."""
    assert axis.home is not None, "it has a second switch"
    matrix = machine.kinematics.matrix
    column = [a.name for a in machine.axes].index(axis.name)
    rows = matrix[np.abs(matrix[:, column]) > 0.0]
    if len(rows) != 2 or np.count_nonzero(rows) != 2:
        raise ConfigError("only an axis that two joints drive, and nothing else, has one",
                          key=f"axes.{axis.name}.home.second")  # fmt: skip
    if axis.home.method != "switch":
        raise ConfigError("a gantry is homed by its switches: the method must be switch",
                          key=f"axes.{axis.name}.home.method")  # fmt: skip


def _has_index(machine: Machine, axis: str) -> bool:
    """Return whether a joint that moves with the axis gives an index pulse."""
    column = machine.kinematics.matrix[:, [a.name for a in machine.axes].index(axis)]
    return any(joint.encoder is not None and joint.encoder.index
               for joint, part in zip(machine.joints, column, strict=True) if part)  # fmt: skip
