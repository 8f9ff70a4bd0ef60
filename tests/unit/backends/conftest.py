"""Machines of one to three joints and motions in closed form."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import pytest

from trochia.machine.axes import Axis, AxisKind, PathLimits
from trochia.machine.joints import Encoder, Joint, Servo, Stepper
from trochia.machine.kinematics import Cartesian
from trochia.machine.machine import Machine
from trochia.machine.transmissions import Leadscrew


@dataclass
class Closed:
    """A motion given by a function of time with values (samples, axes)."""

    duration: float
    place: object

    def position(self, t):
        return self.place(t)

    def path_speed(self, t):
        h = 1e-6
        return np.linalg.norm(self.place(t + h) - self.place(t - h), axis=1) / (2 * h)

    def line_at(self, t):
        return 1 + (t // 0.5).astype(np.int64)


@pytest.fixture
def motion():
    return Closed


@pytest.fixture
def triangle():
    """Return a motion of one axis: up to the top and back to 0, at 10 mm/s."""

    def make(top):
        return Closed(top / 5, lambda t: (top - np.abs(10 * t - top))[:, None])

    return make


@pytest.fixture
def circle():
    """Return a motion of two axes: turns of a circle about 0, 0, counter-clockwise from 3 o'clock, 1 turn/s."""

    def make(radius, turns):
        angle = 2 * np.pi
        return Closed(turns, lambda t: radius * np.stack([np.cos(angle * t), np.sin(angle * t)], axis=1))

    return make


@pytest.fixture
def joint():
    def make(name, *, steps=None, counts=None, backlash=0.0, on_load=False, lead=1):
        encoder = None if counts is None else Encoder(counts=Fraction(counts), on_load=on_load)
        motor = Servo() if steps is None else Stepper(full_steps=steps)
        screw = Leadscrew(lead=Fraction(lead))
        return Joint(name=name, motor=motor, transmission=screw, encoder=encoder, backlash=backlash)

    return make


@pytest.fixture
def machine():
    def make(*joints, kinematics=None, axes="XYZ", period=0.001):
        kinematics = kinematics or Cartesian(tuple(range(len(joints))), len(joints))
        count = kinematics.matrix.shape[1]
        described = tuple(
            Axis(name=name, kind=AxisKind.LINEAR, minimum=-100, maximum=100, velocity=100, acceleration=1000)
            for name in axes[:count]
        )
        return Machine(
            name="bench",
            description="made for tests",
            axes=described,
            joints=joints,
            kinematics=kinematics,
            path=PathLimits(),
            servo_period=period,
        )

    return make
