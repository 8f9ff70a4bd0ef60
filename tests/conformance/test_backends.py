"""What every segment backend promises, over the registry and every shipped machine."""

from __future__ import annotations

import math
from dataclasses import dataclass
from importlib import resources

import numpy as np
import pytest

from trochia.backends import BACKENDS
from trochia.machine.load import load
from trochia.recorder import gather

MACHINES = sorted(
    file.name.removesuffix(".toml")
    for file in resources.files("trochia.data").joinpath("machines").iterdir()
    if file.name.endswith(".toml")
)


@dataclass
class Swing:
    """From the middle of the travel out and half way back, smoothly, each axis at its own reach."""

    middle: np.ndarray
    reach: np.ndarray
    duration: float

    def position(self, t):
        way = np.sin(0.75 * math.pi * np.sin(0.5 * math.pi * t / self.duration) ** 2)
        return self.middle + way[:, None] * self.reach

    def path_speed(self, t):
        h = 1e-6 * self.duration
        return np.linalg.norm(self.position(t + h) - self.position(t - h), axis=1) / (2 * h)

    def line_at(self, t):
        return np.where(t < self.duration / 2, 7, 11)

    def power_at(self, t):
        return np.where(t < self.duration / 2, 0.0, 80.0)


@pytest.fixture(params=MACHINES)
def machine(request):
    return load(request.param)


@pytest.fixture(params=sorted(BACKENDS))
def backend(request, machine):
    return BACKENDS[request.param](machine=machine)


@pytest.fixture
def motion(machine):
    """Return a motion whose length is no whole number of periods."""
    middle = np.array([(axis.minimum + axis.maximum) / 2 for axis in machine.axes])
    reach = np.array([min(7 + 3 * i, (axis.maximum - axis.minimum) / 2) for i, axis in enumerate(machine.axes)])
    return Swing(np.where(np.isfinite(middle), middle, 0.0), reach, 300.4 * machine.servo_period)


@pytest.fixture
def recording(backend, motion):
    return gather(backend.header(motion, program="swing.ngc"), backend.run(motion))


def of(recording, machine, quantity):
    return np.stack([recording[f"{axis.name}.{quantity}"] for axis in machine.axes], axis=1)


def test_header_names_machine_program_and_duration(recording, machine, motion):
    assert (recording.machine, recording.program) == (machine.name, "swing.ngc")
    assert recording.duration == motion.duration
    assert recording.axes == tuple(axis.name for axis in machine.axes)
    assert recording.joints == tuple(joint.name for joint in machine.joints)


def test_recording_covers_the_whole_duration(recording, motion):
    assert recording.time[0] == 0
    assert recording.time[-2] < motion.duration <= recording.time[-1]


def test_commanded_equals_the_motion_at_every_sample(recording, machine, motion):
    t = np.minimum(recording.time, motion.duration)
    np.testing.assert_array_equal(of(recording, machine, "commanded"), motion.position(t))
    np.testing.assert_array_equal(recording["path.line"], motion.line_at(t))
    np.testing.assert_allclose(recording["path.speed"], motion.path_speed(t))
    assert ("beam" in recording) == (machine.beam is not None)
    if machine.beam:
        np.testing.assert_array_equal(recording["beam"], motion.power_at(t))


def test_motion_ends_where_it_was_commanded_within_resolution_and_play(recording, machine, motion):
    end = motion.position(np.array([motion.duration]))[0]
    off = machine.kinematics.matrix @ (of(recording, machine, "actual")[-1] - end)
    for joint, error in zip(machine.joints, off, strict=True):
        per_unit = joint.steps_per_unit or joint.counts_per_unit
        resolution = abs(1 / float(per_unit)) if per_unit else 0.0
        if not joint.closed:  # a loop goes on to settle, and this motion may be more than its motor can do
            assert abs(error) <= joint.backlash / 2 + resolution + 1e-9


def test_same_motion_same_recording(backend, recording, motion):
    again = gather(backend.header(motion, program="swing.ngc"), backend.run(motion))
    assert again.header == recording.header
    for name, samples in recording.channels.items():
        np.testing.assert_array_equal(again[name], samples)


def test_no_motion_is_one_sample_at_rest(backend, motion, machine):
    still = Swing(motion.middle, motion.reach, 0.0)
    still.position = lambda t: np.broadcast_to(motion.middle, (len(t), len(machine.axes)))
    still.path_speed = np.zeros_like
    recording = gather(backend.header(still), backend.run(still))
    assert len(recording) == 1
    np.testing.assert_array_equal(of(recording, machine, "commanded")[0], motion.middle)
