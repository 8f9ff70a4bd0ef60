"""What `check` says of lost steps by closed forms, against the twin's physics.

    python tests/soak/lost_steps.py --count 2000 --seed 1 --jobs 2
    python tests/soak/lost_steps.py --edges 200 --seed 1

Case N is made from seed N alone: a machine of two steppers (motors of the library or a catalogue's row with detent and
friction; L293D, L/R or chopper; full steps to 32 microsteps; screw or belt; mass, friction, at times a weight; reduced
current at rest), limits drawn around what the motors can do, a profile, a program of lines, arcs, reversals, chords,
rapids and rests.  For each joint: what `check` says (nothing, a warning, lost) and what the twin does.  What must hold:

- a joint of which nothing is said loses no step.

Counted are warnings and errors of joints that lose nothing, and first lines named that come after the line in which the
twin slips (but for the lines in motion within 50 ms).  ``--edges`` grows the load of each joint until something
is said, until it is called lost, and until the twin loses steps, and tells the part of the pull-out torque used there.
Exit code 1: a case failed; each is told with its seed.
"""

from __future__ import annotations

import argparse
import math
import re
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trochia import api, recorder
from trochia.analysis.errors import lost_steps
from trochia.backends.twin import Twin
from trochia.errors import ConfigError
from trochia.machine.load import loads
from trochia.machine.torque import drive

if TYPE_CHECKING:
    from collections.abc import Iterator

    from trochia.analysis.check import Verdict
    from trochia.machine.machine import Machine

LIBRARY = ("SM-42BYG011-25", "QSH5718-41", "QSH5718-55", "QSH5718-79")
SUPPLIES = {"SM-42BYG011-25": (9.0, 24.0)}  #: of voltage drives [V]; the others' coils take a few volts only
WARNINGS = ("rotor-swings", "motor-unsteady", "hold-too-weak", "current-floor")
CODES = {"steps-lost": "lost"} | dict.fromkeys(WARNINGS, "warned")
ROOM = 150.0  #: travel either way [mm]
NEAR = 0.05  #: lines in motion so near in time are one [s]
MOST_SPEED = 210.0  #: of a shaft, 2000 rpm [rad/s]
LONGEST = 12.0  #: of a program; longer ones are left out [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Joint:
    """One joint as drawn; ``load`` grows mass, friction and weight."""

    motor: str
    driver: str
    transmission: str
    microsteps: int
    mass: float
    friction: float
    force: float
    velocity: float = 10.0
    acceleration: float = 100.0

    def text(self, letter: str, grown: float = 1.0) -> str:
        """Return its tables."""
        v, a = self.velocity, self.acceleration
        return (
            f'[axes.{letter}]\nminimum = "-{ROOM + 50} mm"\nmaximum = "{ROOM + 50} mm"\n'
            f'velocity = "{v:.6g} mm/s"\nacceleration = "{a:.6g} mm/s²"\njerk = "{20 * a:.6g} mm/s³"\n'
            f'[joints.{letter}]\nmotor = {{ kind = "stepper", microsteps = {self.microsteps}, {self.motor} }}\n'
            f"driver = {{ {self.driver} }}\n"
            f'load = {{ mass = "{grown * self.mass:.6g} kg", friction = "{grown * self.friction:.6g} N", '
            f'force = "{grown * self.force:.6g} N" }}\n'
            f"transmission = {{ {self.transmission} }}\n"
        )


def machine_of(joints: tuple[Joint, ...], grown: float = 1.0) -> Machine:
    """Return the machine of joints X and Y."""
    head = 'format = 1\nname = "drawn"\nkinematics = "cartesian"\n'
    return loads(head + "".join(joint.text(letter, grown) for joint, letter in zip(joints, "XY", strict=False)))


def _joint(chance: np.random.Generator) -> Joint:
    """Return a joint whose limits lie around what its motor can do."""
    name = str(chance.choice(LIBRARY))
    voltage = name in SUPPLIES or chance.uniform() < 0.15
    low, high = SUPPLIES.get(name, (4.0, 8.0))
    motor = f'library = "{name}"'
    if chance.uniform() < 0.4:
        motor = _row(chance)
        low, high, voltage = 4.0, 12.0, chance.uniform() < 0.2
    if voltage and chance.uniform() < 0.25:
        series = chance.uniform(0.5, 3.0) * high / 2
        driver = f'kind = "l/r", supply = "{2 * high:.3g} V", series = "{series:.3g} ohm"'
    elif voltage:
        driver = f'kind = "h-bridge", supply = "{chance.uniform(low, high):.3g} V"'
    else:
        hold = chance.choice([1.0, 0.7, 0.5, 0.3])
        driver = (
            f'kind = "chopper", supply = "{chance.choice([12, 24, 36, 48])} V", '
            f'current = "{chance.uniform(0.6, 2.8):.3g} A", hold_current = {hold}, '
            f'decay = "{chance.choice(["slow", "mixed", "fast"])}"'
        )
    microsteps = int(chance.choice([1, 2, 4, 8, 16, 32]))
    if microsteps == 1 and chance.uniform() < 0.3:
        driver += ', excitation = "one-phase"'
    belt = chance.uniform() < 0.5
    transmission = (
        'kind = "belt", pitch = "2 mm", teeth = 20'
        if belt
        else f'kind = "leadscrew", lead = "{chance.choice([2, 5, 10])} mm"'
    )
    arm = (40.0 if belt else float(transmission.split('"')[3].removesuffix(" mm"))) * 1e-3 / math.tau
    inertia = 1e-5 * 10 ** chance.uniform(-1, 1)
    friction, force = 10 ** chance.uniform(-3, -1.2) / arm, 0.0
    if chance.uniform() < 0.3:
        force = float(chance.choice([-1, 1])) * 10 ** chance.uniform(-3, -0.8) / arm
    return Joint(
        motor=motor, driver=driver, transmission=transmission, microsteps=microsteps, mass=inertia / arm**2,
        friction=friction, force=force,
    )  # fmt: skip


def _row(chance: np.random.Generator) -> str:
    """Return a catalogue's row made up: torque, resistance and inductance as of motors of 42 to 60 mm."""
    current, holding = chance.uniform(1, 3), 10 ** chance.uniform(-0.7, 0.3)
    resistance = chance.uniform(2.5, 5) / current
    return (
        f'catalogue = {{ full_steps = {chance.choice([200, 400])}, resistance = "{resistance:.3g} ohm", '
        f'inductance = "{resistance * chance.uniform(1, 3):.3g} mH", current = "{current:.3g} A", '
        f'holding_torque = "{holding:.3g} N·m", inertia = "{250 * holding * chance.uniform(0.5, 1.5):.3g} g·cm²", '
        f'detent_torque = "{holding * chance.uniform(0, 0.08):.3g} N·m", '
        f'friction = "{holding * chance.uniform(0, 0.02):.3g} N·m", source = "drawn", checked = false }}'
    )


def joints_of(chance: np.random.Generator) -> tuple[Joint, ...]:
    """Return joints with limits; those that move nothing at all are drawn again."""
    found: list[Joint] = []
    while len(found) < 2:
        joint = _joint(chance)
        try:
            motor = drive(machine_of((joint,)), 0)
        except ConfigError:  # a supply that does not drive the current
            continue
        assert motor is not None
        fastest = min(motor.made.top(), MOST_SPEED * 10 ** chance.uniform(-0.7, 0.0))
        most = min(motor.greatest_velocity, fastest * abs(motor.per_radian))
        if not most > 0:
            continue
        velocity = most * chance.uniform(0.1, 1.0)
        there = float(motor.acceleration(np.array(velocity)))
        if not there > 0:
            continue
        part = 10 ** chance.uniform(-1.0, 0.5)
        found.append(replace(joint, velocity=velocity, acceleration=part * there / 0.7))
    return tuple(found)


def program_of(chance: np.random.Generator, joints: tuple[Joint, ...]) -> bytes:
    """Return G-code that these joints do in some seconds."""
    speed = min(joint.velocity for joint in joints)
    reach = min(max(0.4 * speed, 0.2), 60.0)
    mode = str(chance.choice(["G61", "G64", f"G64 P{chance.uniform(0.005, 0.2):.3f}"]))
    lines, at, heading = [f"G21 G90 G94 G17 {mode} F{60 * speed:.2f}"], np.zeros(2), chance.uniform(0, 7)
    for _ in range(int(chance.integers(4, 25))):
        what = chance.choice(["line", "rapid", "back", "arc", "chords", "rest", "feed"])
        heading += math.pi if what == "back" else chance.choice([0.05, 1.0, 2.0]) * chance.normal()
        length = reach * 10 ** chance.uniform(-1.2, 0.3)
        if what == "rest":
            lines.append(f"G4 P{chance.uniform(0.05, 0.4):.3f}")
        elif what == "feed":
            lines.append(f"F{60 * speed * chance.uniform(0.1, 1.6):.2f}")
        elif what == "chords":
            for _ in range(int(chance.integers(4, 20))):
                heading += 0.1 * chance.normal()
                at = np.clip(at + 0.1 * length * np.array([math.cos(heading), math.sin(heading)]), -ROOM, ROOM)
                lines.append(f"G1 X{at[0]:.4f} Y{at[1]:.4f}")
        else:
            step = length * np.array([math.cos(heading), math.sin(heading)])
            if chance.uniform() < 0.4:
                step[int(chance.integers(0, 2))] = 0.0
            to = np.round(np.clip(at + step, -ROOM, ROOM), 4)
            word = "G0" if what == "rapid" else "G1"
            if what == "arc" and np.linalg.norm(to - at) > 0.05:
                word = f"{chance.choice(['G2', 'G3'])} R{0.5 * float(np.linalg.norm(to - at)) * 1.2:.4f}"
            lines.append(f"{word} X{to[0]:.4f} Y{to[1]:.4f}")
            at = to
    return "\n".join([*lines, "M2", ""]).encode()


@dataclass(frozen=True, slots=True)
class Seen:
    """Of one joint: what was said, where first; what part of the torque was used; how it slipped, where first, when."""

    said: str
    said_line: int
    used: float
    swing: float
    lost: bool
    lost_line: int
    lost_time: float
    kind: str


def seen(verdict: Verdict, machine: Machine) -> list[Seen]:
    """Return what check said of each joint, and what the twin did with it."""
    assert verdict.plan is not None
    motion = verdict.plan.trajectory
    twin = Twin(machine=machine)
    recording = recorder.gather(twin.header(motion), twin.run(motion))
    ends = lost_steps(recording, machine)
    found: list[Seen] = []
    for joint in machine.joints:
        told = [p for p in verdict.problems if p.code in CODES and re.search(rf"joint {joint.name}\b", p.message)]
        lost = np.abs(recording[f"joint.{joint.name}.lost_steps"]) >= 4
        first = int(np.argmax(lost)) if lost.any() else -1
        use = verdict.torque[joint.name]
        said = min((CODES[p.code] for p in told), default="nothing")
        assert joint.fed is not None
        found.append(Seen(
            said, min((p.line for p in told), default=0), use.used, use.swing, bool(lost.any() or ends[joint.name]),
            int(recording["path.line"][first]), float(recording.time[first]), joint.fed.driver.kind,
        ))  # fmt: skip
    return found


def drawn(seed: int) -> tuple[tuple[Joint, ...], bytes, str]:
    """Return joints, program and profile of a seed."""
    chance = np.random.default_rng(seed)
    joints = joints_of(chance)
    return joints, program_of(chance, joints), str(chance.choice(["trapezoid", "s-curve", "torque"]))


def case(seed: int) -> tuple[int, list[str], Counter[str]]:
    """Return what is wrong with a seed's verdict, and what was counted."""
    joints, text, profile = drawn(seed)
    machine = machine_of(joints)
    verdict = api.check(text, machine, name=f"seed {seed}", profile=profile)
    if verdict.plan is None or verdict.time_s is None or verdict.time_s > LONGEST:
        return seed, [], Counter(["left out"])
    faults: list[str] = []
    counted: Counter[str] = Counter()
    for name, one in zip("XY", seen(verdict, machine), strict=True):
        counted[f"{one.said}, {'lost' if one.lost else 'kept'}"] += 1
        if one.lost and one.said == "nothing":
            faults.append(
                f"{name} ({one.kind}, {profile}): nothing said, slips on line {one.lost_line} at {one.lost_time:.3f} s "
                f"(torque {one.used:.2f}, swing {one.swing:.2f})"
            )
        elif one.lost and not _named_in_time(verdict, one):
            counted["named late"] += 1
    return seed, faults, counted


def _named_in_time(verdict: Verdict, one: Seen) -> bool:
    """Whether the line named comes no later than the slip, within some lines that are in motion at the same time."""
    assert verdict.plan is not None
    later = verdict.plan.trajectory.line_at(np.array([one.lost_time + NEAR]))
    return one.said_line <= max(int(later[0]), one.lost_line + 1)


def edges(seed: int) -> tuple[int, dict[str, float], str]:
    """Return the parts of pull-out torque used where something is said, where it is called lost, and where it slips."""
    joints, text, profile = drawn(seed)
    profile = "trapezoid" if profile == "torque" else profile  # which keeps clear by itself
    joints = (joints[0], replace(joints[1], mass=0.0, friction=0.0, force=0.0))
    found: dict[str, float] = {}

    def at(grown: float) -> Seen | None:
        machine = machine_of(joints, grown)
        verdict = api.check(text, machine, name=f"seed {seed}", profile=profile)
        if verdict.plan is None or verdict.time_s is None or verdict.time_s > LONGEST:
            return None
        return seen(verdict, machine)[0]

    kind = "left out"
    for name, is_over in (
        ("said", lambda one: one.said != "nothing"),
        ("lost", lambda one: one.said == "lost"),
        ("slips", lambda one: one.lost),
    ):
        low, high = 0.01, 100.0
        for _ in range(12):
            middle = math.sqrt(low * high)
            one = at(middle)
            if one is None:
                return seed, {}, kind
            low, high = (low, middle) if is_over(one) else (middle, high)
            found[name], kind = one.used, one.kind
        if low < 0.02 or high > 50:
            return seed, {}, f"{kind}: no edge of {name}"
    return seed, found, kind


def _results(function: object, seeds: range, jobs: int) -> Iterator[object]:
    if jobs == 1:
        yield from map(function, seeds)
        return
    with ProcessPoolExecutor(jobs) as pool:
        yield from pool.map(function, seeds, chunksize=4)


def _tell_edges(asked: argparse.Namespace) -> None:
    ratios: dict[str, list[float]] = {}
    for seed, found, kind in _results(edges, range(asked.seed, asked.seed + asked.edges), asked.jobs):
        if found:
            print(f"seed {seed} ({kind}): " + ", ".join(f"{name} {used:.3f}" for name, used in found.items()))
            for name in ("said", "lost"):
                ratios.setdefault(f"{kind}, {name}", []).append(found[name] / found["slips"])
    for name, values in sorted(ratios.items()):
        parts = np.quantile(values, [0.0, 0.1, 0.5, 0.9, 1.0])
        print(f"{name}: {len(values)} edges, torque there over torque where it slips: "
              + " ".join(f"{part:.2f}" for part in parts) + " (least, 10 %, half, 90 %, most)")  # fmt: skip


def main() -> None:
    """Run a campaign; exits with 1 after a failure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--edges", type=int, default=0)
    asked = parser.parse_args()
    if asked.edges:
        _tell_edges(asked)
        return
    failed, counted = 0, Counter[str]()
    for seed, faults, some in _results(case, range(asked.seed, asked.seed + asked.count), asked.jobs):
        failed += bool(faults)
        counted += some
        for fault in faults:
            print(f"seed {seed}: {fault}", flush=True)
    print(f"{asked.count} cases from seed {asked.seed} on, {failed} failed; said and done: "
          + "; ".join(f"{name}: {n}" for name, n in sorted(counted.items())))  # fmt: skip
    raise SystemExit(failed > 0)


if __name__ == "__main__":
    main()
