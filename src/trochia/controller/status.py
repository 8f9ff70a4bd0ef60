"""The status of now.  In: the backend's report and what the controller knows beside it.  Out: one Status."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from trochia.backends.live import BUILT_IN
from trochia.messages import AxisStatus
from trochia.program import AXES

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from trochia.backends.live import Report
    from trochia.machine.kinematics import Kinematics
    from trochia.machine.machine import Machine
    from trochia.program import WorkState


@lru_cache(maxsize=16)
def _inverse(kinematics: Kinematics) -> NDArray[np.float64]:
    return np.asarray(np.linalg.pinv(kinematics.matrix), np.float64)


def axes_of(machine: Machine, joints: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return axis positions (axes,) of joint positions (joints,), by least squares where joints share an axis."""
    return _inverse(machine.kinematics) @ joints


def position_of(machine: Machine, report: Report) -> dict[str, float]:
    """Return the commanded position of each axis [mm or degree]."""
    found = axes_of(machine, report.commanded)
    return {axis.name: float(value) for axis, value in zip(machine.axes, found, strict=True)}


def unit_of(machine: Machine, joint: str) -> str:
    """Return the unit of a joint or axis by its name: that of the first axis it moves; empty where there is none."""
    for axis in machine.axes:
        if axis.name == joint:
            return axis.unit
    rows = {j.name: row for j, row in zip(machine.joints, machine.kinematics.matrix, strict=True)}
    return machine.axes[int(np.argmax(np.abs(rows[joint])))].unit if joint in rows else ""


def axis_statuses(
    machine: Machine, report: Report, work: WorkState, trusted: Mapping[str, bool]
) -> tuple[AxisStatus, ...]:
    """Return the status of every axis."""
    commanded, velocity = axes_of(machine, report.commanded), axes_of(machine, report.velocity)
    encoder = None if report.encoder is None else axes_of(machine, report.encoder)
    actual = None if report.actual is None else axes_of(machine, report.actual)
    origin = np.array(work.systems[work.active - 1]) + np.array(work.tool_offset)
    if work.g92_on:
        origin += np.array(work.g92)
    return tuple(
        AxisStatus(
            name=axis.name, unit=axis.unit, commanded=float(commanded[i]),
            work=float(commanded[i] - origin[AXES.index(axis.name)]), velocity=float(velocity[i]),
            encoder=None if encoder is None or not np.isfinite(encoder[i]) else float(encoder[i]),
            actual=None if actual is None else float(actual[i]), trusted=trusted[axis.name], enabled=report.enabled,
        )
        for i, axis in enumerate(machine.axes)
    )  # fmt: skip


def io_of(report: Report) -> dict[str, float]:
    """Return inputs and outputs by name, those every backend has left out."""
    outputs = {name: value for name, value in report.outputs.items() if name not in BUILT_IN}
    return {name: float(level) for name, level in report.inputs.items()} | outputs
