"""Programs of every kind for the laws of motion, as hypothesis strategies, and machines to try them on."""

from __future__ import annotations

import dataclasses
import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import strategies as st

from trochia.machine.axes import PathLimits
from trochia.machine.load import load
from trochia.program import MOVE, MoveKind, PathMode, Plane, Program, TimeLaw

PLANES = {Plane.XY: (0, 1), Plane.YZ: (1, 2), Plane.ZX: (2, 0)}


TURNS = st.sampled_from([0.0, 1e-7, 1e-5, 0.01, math.pi / 2, math.pi, -math.pi / 2]) | st.floats(-3, 3)
KINDS = st.sampled_from([MoveKind.FEED, MoveKind.FEED, MoveKind.ARC, MoveKind.ARC, MoveKind.RAPID])


@st.composite
def steps(draw, modes):
    """One move, relative to where the last one ended and the direction it ended in.

    What shrinks well is drawn one by one, the rest at once from a seed: drawing takes longer than planning.
    """
    chance = np.random.default_rng(draw(st.integers(0, 2**16)))
    sweeps = [math.pi / 2, math.pi, 2 * math.pi, chance.uniform(0.01, 9), chance.uniform(0.01, 3)]
    return SimpleNamespace(
        kind=draw(KINDS),
        turn=draw(TURNS),
        mode=draw(modes),
        size=10 ** chance.uniform(-2, 2),
        climb=chance.choice([0.0, 0.0, 1.0, chance.uniform(-1, 1)]),
        rotary=chance.choice([0.0, 0.0, 0.0, 30.0]),
        still=chance.uniform() < 0.1,
        sweep=chance.choice(sweeps),
        side=int(chance.choice([-1, 1])),
        tangent=chance.uniform() < 0.5,
        plane=Plane(chance.choice([0, 0, 1, 2])),
        spiral=chance.choice([0.0, 0.0, 1e-9, 1e-4, 1e-2]),
        feed=10 ** chance.uniform(-1, 2.5),
        law=TimeLaw.INVERSE if chance.uniform() < 0.1 else TimeLaw.PER_SECOND,
    )


def _arc(step, position, heading, move):
    """Fill an arc in; returns the direction it ends in."""
    first, second = PLANES[step.plane]
    start = heading - step.side * math.pi / 2 + (0.0 if step.tangent else step.turn)
    centre = position[[first, second]] - step.size * np.array([math.cos(start), math.sin(start)])
    end = start + step.side * step.sweep
    radius = step.size * (1 + step.spiral)
    if step.sweep != 2 * math.pi or step.spiral:
        position[first] = centre[0] + radius * math.cos(end)
        position[second] = centre[1] + radius * math.sin(end)
    position[3 - first - second] += step.climb * step.size
    move["plane"], move["centre"] = step.plane, centre
    move["turns"] = step.side * math.ceil(step.sweep / (2 * math.pi) - 1e-9)
    return end + step.side * math.pi / 2


def program_of(parts, columns):
    """The program that these steps make, with X Y Z, and A where the machine has it."""
    moves, position, heading = np.zeros(len(parts), dtype=MOVE), np.zeros(9), 0.0
    for row, step in enumerate(parts):
        move = moves[row]
        move["kind"], move["line"], move["law"], move["rate"] = step.kind, row + 1, step.law, step.feed
        move["path_mode"], move["tolerance"][0] = step.mode[0], step.mode[1]
        if step.kind == MoveKind.ARC:
            heading = _arc(step, position, heading, move)
        elif not step.still:
            heading += step.turn
            position[:2] += step.size * np.array([math.cos(heading), math.sin(heading)])
            position[2] += step.climb * step.size
        if 3 in columns:
            position[3] += step.rotary
        move["target"] = position
    return Program(name="drawn", lines=len(parts), start=np.zeros(9), moves=moves, actions=())


def _wide(machine):
    axes = tuple(dataclasses.replace(axis, minimum=-1e6, maximum=1e6) for axis in machine.axes)
    return dataclasses.replace(machine, axes=axes)


def _machines():
    mill, belts = _wide(load("reference-mill")), _wide(load("corexy"))
    joints = tuple(
        dataclasses.replace(joint, velocity=250.0, acceleration=2500.0) if i < 2 else joint
        for i, joint in enumerate(belts.joints)
    )
    return {
        "mill": mill,
        "capped": dataclasses.replace(mill, path=PathLimits(velocity=150.0, acceleration=600.0)),
        "belts": dataclasses.replace(belts, joints=joints),
        "rotary": _wide(load("rotary-mill")),
    }


def programs(machine, modes=None, most=12):
    """Programs for a machine; ``modes`` draws (path mode, tolerance)."""
    tolerances = st.sampled_from([1e-4, 1e-3, 0.01, 0.05, 0.3, 1.0])
    any_mode = st.tuples(st.sampled_from(PathMode), tolerances)
    drawn = st.lists(steps(any_mode if modes is None else modes), min_size=1, max_size=most)
    return drawn.map(lambda parts: program_of(parts, machine.columns))


@pytest.fixture(scope="session")
def motion():
    """What the laws of motion need: machines by name, and programs for them."""
    return SimpleNamespace(machines=_machines(), programs=programs)
