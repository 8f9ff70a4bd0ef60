"""Random programs planned: no limit exceeded anywhere, no jump, inside P both ways, never slower than stopping.

    python tests/soak/plans.py --count 100000 --seed 1

Case N is made from seed N alone: machines of 2 to 6 axes, CoreXY and capped ones among them; lines, arcs, helices,
spirals, splines, chains of chords, and all of them mixed; every path mode.  Each phase is looked at in 11 places, by
the phases' own arithmetic, with limited jerk and as a trapezoid.  Exit code 1: a case failed; each is told with its
seed.  Now and then the seed to go on with is told, and the greatest parts of limits and of P that were used.
"""

from __future__ import annotations

import argparse
import dataclasses
import math
from typing import TYPE_CHECKING, Any

import deviation
import numpy as np
from phase_states import POINTS, derivative, inside

from trochia.languages import gcode
from trochia.machine.axes import PathLimits
from trochia.machine.kinematics import Cartesian
from trochia.machine.load import load
from trochia.planner import PROFILES, path_of, plan
from trochia.program import MOVE, MoveKind, PathMode, Plane, Program, TimeLaw
from trochia.toolpath import build

if TYPE_CHECKING:
    from collections.abc import Iterator

    from trochia.machine.machine import Machine
    from trochia.planner import Trajectory

OVER = 1e-9
TOLD = 1000  #: cases between two reports
MEASURED = 50  #: one in so many has its deviation measured, which takes eight times the rest
SLOWER = 1e-9  #: part by which a plan may be slower than one that stops at every corner: what sums round off
PLANES = {Plane.XY: (0, 1), Plane.YZ: (1, 2), Plane.ZX: (2, 0)}


def _wide(machine: Machine, jerk: float = 20.0) -> Machine:
    """Return a machine without ends of travel, with a jerk limit on every axis."""
    axes = tuple(
        dataclasses.replace(axis, minimum=-1e9, maximum=1e9, jerk=axis.jerk or jerk * axis.acceleration)
        for axis in machine.axes
    )
    return dataclasses.replace(machine, axes=axes)


def _cut(machine: Machine, count: int) -> Machine:
    """Return a Cartesian machine of the first axes X Y Z A B C, those it lacks made like the last it has."""
    axes = [*machine.axes, *(dataclasses.replace(machine.axes[-1], name=name) for name in "BC")][:count]
    joints = [*machine.joints, machine.joints[-1], machine.joints[-1]][:count]
    named = tuple(dataclasses.replace(joint, name=axis.name) for joint, axis in zip(joints, axes, strict=True))
    kinematics = Cartesian(axes=tuple(range(count)), count=count)
    return dataclasses.replace(machine, axes=tuple(axes), joints=named, kinematics=kinematics)


def machines() -> list[Machine]:
    """Return what is planned for: 2 to 6 axes, joints with limits of their own, caps on the vector."""
    mill, belts, rotary = _wide(load("reference-mill")), _wide(load("corexy")), _wide(load("rotary-mill"))
    joints = tuple(
        dataclasses.replace(joint, velocity=250.0, acceleration=2500.0, jerk=50_000.0) if i < 2 else joint
        for i, joint in enumerate(belts.joints)
    )
    caps = PathLimits(velocity=150.0, acceleration=600.0, jerk=15_000.0)
    stiff = _wide(dataclasses.replace(mill, axes=tuple(dataclasses.replace(a, jerk=None) for a in mill.axes)), 2000.0)
    return [
        mill,
        dataclasses.replace(mill, path=caps),
        dataclasses.replace(belts, joints=joints),
        rotary,
        _cut(mill, 2),
        _cut(rotary, 5),
        _cut(rotary, 6),
        stiff,
    ]


def _line(chance: np.random.Generator, place: np.ndarray, heading: float, size: float, *, wild: bool) -> float:
    turns = [0.0, 1e-7, 1e-3, 0.02, math.pi / 2, math.pi, chance.normal()]
    heading += chance.choice(turns) if wild else 0.05 * chance.normal()
    length = size * 10 ** (chance.uniform(-1.5, 0.7) if wild else chance.uniform(-0.1, 0.1))
    place[:2] += length * np.array([math.cos(heading), math.sin(heading)])
    place[2] += length * chance.choice([0.0, 0.0, 0.0, 1.0, chance.normal()])
    return heading


def _arc(
    chance: np.random.Generator, place: np.ndarray, heading: float, size: float, *, move: Any, flat: bool
) -> float:
    plane = Plane.XY if flat else Plane(chance.choice([0, 0, 1, 2]))
    first, second = PLANES[plane]
    side, radius = int(chance.choice([-1, 1])), size * 10 ** chance.uniform(-1, 0.7)
    sweep = chance.choice([math.pi / 2, math.pi, 2 * math.pi, chance.uniform(0.01, 8), chance.uniform(0.01, 2)])
    start = heading - side * math.pi / 2 if chance.uniform() < 0.6 else chance.uniform(0, 7)
    start += chance.choice([0.0, 1e-6, 1e-3]) * chance.normal()
    centre = place[[first, second]] - radius * np.array([math.cos(start), math.sin(start)])
    end, grown = start + side * sweep, radius * (1 + chance.choice([0.0, 0.0, 1e-9, 1e-4, 1e-2]))
    if sweep != 2 * math.pi or grown != radius:
        place[[first, second]] = centre + grown * np.array([math.cos(end), math.sin(end)])
    place[3 - first - second] += size * chance.choice([0.0, 0.0, chance.normal()])
    move["kind"], move["plane"], move["centre"] = MoveKind.ARC, plane, centre
    move["turns"] = side * math.ceil(sweep / (2 * math.pi) - 1e-9)
    return end + side * math.pi / 2


def program_of(seed: int, machine: Machine) -> Program:
    """Return the program of a seed."""
    chance = np.random.default_rng(seed)
    if chance.uniform() < 0.1:
        return _splines(chance)
    count, size, arcs = int(chance.integers(1, 40)), 10 ** chance.uniform(-2, 1.5), chance.choice([0.0, 0.1, 0.5, 1.0])
    moves, place, heading = np.zeros(count, dtype=MOVE), np.zeros(9), 0.0
    wild, mode, tolerance = chance.uniform() < 0.7, chance.integers(0, 4), 10 ** chance.uniform(-4, 0.3)
    feed, columns = 10 ** chance.uniform(0, 2.5), machine.columns
    for row, move in enumerate(moves):
        if chance.uniform() < 0.05:
            mode, tolerance = chance.integers(0, 4), 10 ** chance.uniform(-4, 0.3)
        if chance.uniform() < 0.2:
            feed = 10 ** chance.uniform(0, 2.5)
        move["kind"] = MoveKind.RAPID if chance.uniform() < 0.05 else MoveKind.FEED
        move["path_mode"], move["tolerance"][0], move["rate"] = PathMode(mode), tolerance, feed
        if chance.uniform() < 0.03:
            move["law"], move["rate"] = TimeLaw.INVERSE, 10 ** chance.uniform(-1, 1.5)
        if chance.uniform() < arcs:
            heading = _arc(chance, place, heading, size, move=move, flat=2 not in columns)
        elif chance.uniform() < 0.95:
            heading = _line(chance, place, heading, size, wild=wild)
        for rotary in (3, 4, 5):
            if chance.uniform() < 0.1:
                place[rotary] += 30 * chance.normal()
        place[[axis for axis in range(9) if axis not in columns]] = 0.0
        move["target"], move["line"] = place, row + 1
    return Program(name=f"seed {seed}", lines=count, start=np.zeros(9), moves=moves, actions=())


def _splines(chance: np.random.Generator) -> Program:
    """Return a program of cubic splines G5, lines between them."""
    lines = ["G21 G90 G17", f"G64 P{10 ** chance.uniform(-3, -0.5):.4f}", "G1 X0 Y0 F3000"]
    for _ in range(int(chance.integers(1, 12))):
        x, y, i, j, p, q = np.round(10 * chance.normal(size=6), 3)
        lines += [f"G91\nG5 X{x} Y{y} I{i} J{j} P{p} Q{q} F{chance.uniform(60, 9000):.0f}"]
        if chance.uniform() < 0.4:
            lines += [f"G1 X{chance.normal():.3f} Y{chance.normal():.3f}"]
    return gcode.read("\n".join([*lines, "M2", ""]))


def faults(trajectory: Trajectory, worst: list[float]) -> Iterator[str]:
    """Yield what is wrong with a trajectory; raises the greatest parts of limits that are used, by derivative."""
    path, limits, linear = trajectory.path, trajectory.limits, slice(0, trajectory.limits.linear)
    phases = np.concatenate(list(trajectory.blocks()))
    if not (phases["duration"] > 0).all():
        yield "a phase of no duration"
    states = inside(phases)
    rows = (limits.velocity, limits.acceleration, limits.jerk)
    caps = (limits.path_velocity, limits.path_acceleration, limits.path_jerk)
    orders = 4 if trajectory.profile == "s-curve" else 3
    for order, close in enumerate([1e-9, 2e-6, 1e-5, 0.0][:orders]):
        asked = derivative(trajectory, states, order)
        if order:
            over = max((np.abs(asked @ limits.matrix.T) / rows[order - 1]).max(),
                       (np.linalg.norm(asked[:, linear], axis=1) / caps[order - 1]).max())  # fmt: skip
            worst[order] = max(worst[order], over)
            if not over <= 1 + OVER:
                yield f"derivative {order} is {over!r} of its limit"
        if order < orders - 1:
            jump = np.abs(asked[POINTS - 1 : -1 : POINTS] - asked[POINTS::POINTS]).max(initial=0)
            if not jump <= close * (np.abs(asked).max(initial=1.0) if order else 1.0):
                yield f"derivative {order} jumps by {jump!r}"
        if order == 1:
            speed = np.linalg.norm(asked[:, linear], axis=1)
            if not (speed <= path.segments["speed_limit"][states["segment"]] * (1 + OVER)).all():
                yield "a feed is exceeded"


def case(seed: int, among: list[Machine], worst: list[float]) -> list[str]:
    """Return what is wrong with the plans of a seed, and with their time against stopping at every corner."""
    machine = among[seed % len(among)]
    program = program_of(seed, machine)
    path, programmed = path_of(program, machine, PROFILES["s-curve"]), build(program, machine, blend=False)
    if not len(path):
        return []
    trajectory = plan(path, machine, program=program, profile="s-curve")
    exact = plan(programmed, machine, program=program, profile="s-curve")
    blended = plan(path_of(program, machine, PROFILES["trapezoid"]), machine, program=program, profile="trapezoid")
    stopping = plan(programmed, machine, program=program, profile="trapezoid")
    pairs = ((trajectory, exact), (blended, stopping))
    looked = seed // len(among) % MEASURED == 0
    away = deviation.used(program, machine, path if seed % 2 else blended.path, programmed) if looked else 0.0
    worst[0] = max(worst[0], away)
    return [
        *faults(trajectory, worst),
        *(f"trapezoid: {fault}" for fault in faults(blended, worst)),
        *(
            f"{one.duration!r} s, {two.duration!r} s with stops, {one.profile}"
            for one, two in pairs
            if one.duration > two.duration * (1.0 + SLOWER)
        ),
        *([f"{away!r} of P is used"] if not away <= 1 + OVER else []),
    ]


def main() -> None:
    """Run a campaign; exits with 1 after a failure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    among, failed, worst, end = machines(), 0, [0.0] * 4, asked.seed + asked.count
    for seed in range(asked.seed, end):
        found = case(seed, among, worst)
        failed += bool(found)
        if found:
            print(f"seed {seed}: {'; '.join(found)}", flush=True)
        if (seed + 1 - asked.seed) % TOLD == 0 or seed + 1 == end:
            parts = ", ".join(f"{part - 1:+.2e}" for part in worst)
            print(f"go on with seed {seed + 1}; {failed} failed; worst of P, v, a, j over 1: {parts}", flush=True)
    print(f"{asked.count} programs from seed {asked.seed} on, {failed} failed")
    raise SystemExit(failed > 0)


if __name__ == "__main__":
    main()
