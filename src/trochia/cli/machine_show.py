"""A machine for people and for scripts.  In: a Machine.  Out: text tables, or plain data with units in its keys."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.cli import machine_corrections
from trochia.machine.codecs import shortest
from trochia.machine.rates import braking_distance, joint_velocity, resolution, step_rate
from trochia.machine.schema import keys_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from trochia.machine.axes import Axis
    from trochia.machine.joints import Joint
    from trochia.machine.machine import Machine


def summary(machine: Machine) -> str:
    """Return one line: kinematics, axes, joints."""
    names = " ".join(axis.name for axis in machine.axes)
    joints = f"{len(machine.joints)} joint{'s' if len(machine.joints) > 1 else ''}"
    return f"{machine.kinematics.kind}, axes {names}, {joints}"


def listing(rows: Sequence[dict[str, str]]) -> str:
    """Return the shipped machines as text."""
    table = _table([[row["name"], row["description"]] for row in rows])
    return f"Machines that come with Trochia:\n{table}\n\nLook at one: trochia machine show {rows[0]['name']}"


def as_text(machine: Machine) -> str:
    """Return a machine as tables for people."""
    facts = [
        summary(machine),
        f"path tolerance {machine.path_tolerance:g} mm",
        f"servo period {shortest(machine.servo_period, 'time')}",
    ]
    facts += [f"tool change {machine.tool_change_time:g} s"] if machine.tool_change_time else []
    facts += [f"profile {machine.profile}"] if machine.profile else []
    head = machine.name + (f": {machine.description}" if machine.description else "")
    parts = [f"{head}\n{'; '.join(facts)}", _axes(machine), _joints(machine)]
    corrected = machine_corrections.rows(machine)
    parts += [_table(corrected)] if corrected else []
    parts += [text for text in (_path(machine), _tools(machine), _io(machine)) if text]
    return "\n\n".join(parts)


def _axes(machine: Machine) -> str:
    """Return the axes' table."""
    rows = [["axis", "travel", "velocity", "acceleration", "jerk", "braking"]]
    for axis in machine.axes:
        u = axis.unit
        jerk = f"{axis.jerk:.6g} {u}/s³" if axis.jerk else "-"
        rows.append([axis.name, f"{axis.minimum:.6g} .. {axis.maximum:.6g} {u}", f"{axis.velocity:.6g} {u}/s",
                     f"{axis.acceleration:.6g} {u}/s²", jerk, f"{braking_distance(axis):.5g} {u}"])  # fmt: skip
    return _table(rows)


def _joints(machine: Machine) -> str:
    """Return the joints' table."""
    rows = [["joint", "moves", "motor", "transmission", "steps", "encoder", "resolution", "at most", "backlash"]]
    for index, joint in enumerate(machine.joints):
        u, moves = _moves(machine, index)
        fine, rate = resolution(machine, index), step_rate(machine, index)
        rows.append([
            joint.name,
            moves,
            _motor(joint),
            f"{joint.transmission.kind}, {float(joint.transmission.travel_per_turn):.6g} {u}/turn",
            _per(joint.steps_per_unit, u),
            _per(joint.counts_per_unit, u),
            "-" if fine is None else f"{fine * 1000:.4g} µm" if u == "mm" else f"{fine:.4g} deg",
            f"{joint_velocity(machine, index):.6g} {u}/s" if rate is None else f"{rate:,.6g} steps/s",
            f"{joint.backlash:.6g} {u}" if joint.backlash else "-",
        ])  # fmt: skip
    return _table(rows)


def _moves(machine: Machine, index: int) -> tuple[str, str]:
    """Return a joint's unit and which axes it moves, as a formula."""
    row = machine.kinematics.matrix[index]
    terms = [(float(c), axis) for c, axis in zip(row, machine.axes, strict=True) if c]
    text = " ".join(f"{'-' if c < 0 else '+'} {'' if abs(c) == 1 else f'{abs(c):g} '}{axis.name}" for c, axis in terms)
    return terms[0][1].unit, text.removeprefix("+ ")


def _motor(joint: Joint) -> str:
    """Return the motor in a word or two."""
    pulses = getattr(joint.motor, "steps_per_turn", None)
    return joint.motor.kind if pulses is None else f"{joint.motor.kind}, {pulses} steps/turn"


def _per(value: Fraction | None, unit: str) -> str:
    """Return an exact scale; one without a finite decimal is rounded."""
    return "-" if value is None else f"{float(value):.8g} /{unit}"


def _path(machine: Machine) -> str:
    """Return the caps along the path."""
    caps = [(machine.path.velocity, "mm/s"), (machine.path.acceleration, "mm/s²"), (machine.path.jerk, "mm/s³")]
    given = [f"{value:.6g} {unit}" for value, unit in caps if value is not None]
    return f"path: at most {', '.join(given)}" if given else ""


def _tools(machine: Machine) -> str:
    """Return spindle and beam, a line each."""
    lines: list[str] = []
    if spindle := machine.spindle:
        encoder = f"; encoder {spindle.encoder.counts} counts/turn" if spindle.encoder else ""
        lines.append(
            f"spindle: {spindle.minimum:g} .. {spindle.maximum:g} rpm, {spindle.spin_up:g} s to full speed{encoder}"
        )
    if beam := machine.beam:
        rating = f", {beam.rating:g} W" if beam.rating else ""
        full = f", full at S{beam.full_power:g}" if beam.kind == "power" else ""
        delay = f", switches in {beam.delay * 1000:g} ms" if beam.delay else ""
        lines.append(f"beam: {beam.kind}{rating}{full}{delay}")
    return "\n".join(lines)


def _io(machine: Machine) -> str:
    """Return the channels' table."""
    if not machine.io:
        return ""
    rows = [["channel", "kind", "electrical", "pin", "carries", "load"]]
    for channel in machine.io:
        amperes = [channel.greatest_current, channel.load]
        rows.append([channel.name, channel.kind + (", inverted" if channel.inverted else ""), channel.electrical or "-",
                     "-" if channel.pin is None else str(channel.pin),
                     *("-" if a is None else shortest(a, "current") for a in amperes)])  # fmt: skip
    return _table(rows)


def _table(rows: Sequence[Sequence[str]]) -> str:
    """Return rows with their columns aligned, two blanks apart."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows
    )


def as_data(machine: Machine) -> dict[str, object]:
    """Return a machine as plain data for ``--json``."""
    return {
        "name": machine.name,
        "description": machine.description,
        "kinematics": machine.kinematics.kind,
        "matrix": machine.kinematics.matrix.tolist(),
        "path_tolerance_mm": machine.path_tolerance,
        "servo_period_s": machine.servo_period,
        "tool_change_time_s": machine.tool_change_time,
        "profile": machine.profile,
        "path": {
            "velocity_mm_s": machine.path.velocity,
            "acceleration_mm_s2": machine.path.acceleration,
            "jerk_mm_s3": machine.path.jerk,
        },
        "axes": [_axis_data(axis) for axis in machine.axes],
        "joints": [_joint_data(machine, index) for index in range(len(machine.joints))],
        "corrections": machine_corrections.corrections(machine),
        "spindle": machine.spindle and {
            "maximum_rpm": machine.spindle.maximum,
            "minimum_rpm": machine.spindle.minimum,
            "spin_up_s": machine.spindle.spin_up,
            "encoder_counts": None if machine.spindle.encoder is None else str(machine.spindle.encoder.counts),
        },
        "beam": machine.beam and {
            "kind": machine.beam.kind,
            "full_power": machine.beam.full_power,
            "delay_s": machine.beam.delay,
            "rating_W": machine.beam.rating,
        },
        "io": [{"name": channel.name, **_channel_data(channel)} for channel in machine.io],
    }  # fmt: skip


def _axis_data(axis: Axis) -> dict[str, object]:
    """Return one axis; its unit stands in the keys."""
    u = axis.unit
    return {
        "name": axis.name,
        "kind": axis.kind.value,
        f"minimum_{u}": axis.minimum,
        f"maximum_{u}": axis.maximum,
        f"velocity_{u}_s": axis.velocity,
        f"acceleration_{u}_s2": axis.acceleration,
        f"jerk_{u}_s3": axis.jerk,
        f"braking_{u}": braking_distance(axis),
    }


def _joint_data(machine: Machine, index: int) -> dict[str, object]:
    """Return one joint; exact scales are text."""
    joint = machine.joints[index]
    u, moves = _moves(machine, index)
    steps, counts = joint.steps_per_unit, joint.counts_per_unit
    return {
        "name": joint.name,
        "moves": moves,
        "motor": joint.motor.kind,
        "transmission": joint.transmission.kind,
        f"travel_per_turn_{u}": str(joint.transmission.travel_per_turn),
        f"steps_per_{u}": None if steps is None else str(steps),
        f"counts_per_{u}": None if counts is None else str(counts),
        f"resolution_{u}": resolution(machine, index),
        f"velocity_{u}_s": joint_velocity(machine, index),
        "step_rate_hz": step_rate(machine, index),
        f"backlash_{u}": joint.backlash,
    }


#: suffix of a channel's keys that carry a unit
_CHANNEL_UNITS = {"current": "_A", "load": "_A", "duration": "_s", "frequency": "_hz", "delay": "_s"}


def _channel_data(channel: object) -> dict[str, object]:
    """Return one channel's keys."""
    return {name + _CHANNEL_UNITS.get(name, ""): getattr(channel, name) for name in keys_of(type(channel))}
