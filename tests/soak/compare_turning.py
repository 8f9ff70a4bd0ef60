"""Generated lathe programs against LinuxCNC's ``rs274``: the moves of G70 to G72.2, or the line of the refusal.

    python tests/soak/compare_turning.py --count 2000 --seed 1 --jobs 2

Case N is made from seed N alone: a profile of slopes, steps, arcs, slight bends, arcs that meet in corners, fillets and
chamfers, U and W; a cycle along it with its words, D and E among them.  Profiles rise or fall, to all four sides, in G7
and G8.  Each difference is told with its reason (``turning_laws.py``); ``--show SEED`` prints a case with both answers.
Exit code 1: there were differences whose reason is not known.
"""

from __future__ import annotations

import collections
import itertools
import random
import subprocess
import sys
from typing import Any

from compare_gcode import ORACLE, asked_for, campaign, kind_of
from turning_laws import REASONS, reason

from trochia.program import WorkState

CYCLES = ("G70", "G70", "G71", "G71", "G71", "G71.1", "G71.2", "G72", "G72", "G72.1", "G72.2")


def program(seed: int) -> bytes:
    """Return the program of a seed."""
    chance = random.Random(seed)  # noqa: S311 - cases, not secrets
    cycle = chance.choice(CYCLES)
    lines = _profile(chance, facing=cycle.startswith("G72"))
    start = f"X{_off(chance, -5, 40)} Z{_off(chance, -40, 8)}"
    head = ["G21 G18 G90 F100", chance.choice(["G8", "G8", "G7"]), "O100 SUB", *lines, "O100 ENDSUB", "G0 X23 Z7"]
    return "\n".join([*head, f"{cycle} Q100 {start} {_words(chance, cycle)}", "G1 X3", "M2", ""]).encode("ascii")


def _off(chance: random.Random, low: int, high: int) -> str:
    """Return a coordinate that no profile has."""
    return f"{chance.randint(4 * low, 4 * high) / 4 + 0.1:g}"


def _words(chance: random.Random, cycle: str) -> str:
    words: list[str] = []
    if chance.random() < 0.5:
        words.append(f"D{chance.choice([0.05, 0.2, 0.3, 0.7, -0.4])}")
    if cycle == "G70":
        words += [f"E{chance.choice([0.1, 0.2, -0.3])}"] * (chance.random() < 0.3)
        words += [f"P{chance.randint(1, 3)}"] * (chance.random() < 0.5)
    else:
        words += [f"I{chance.choice([0.51, 0.87, 1.37, 2.83])}"] * (chance.random() < 0.8)
        words += [f"R{chance.choice([0, 0.2, 1.3])}"] * (chance.random() < 0.6)
    return " ".join(words)


def _profile(chance: random.Random, *, facing: bool) -> list[str]:
    """Return the lines of a profile that leads along one axis, to either side of the other."""
    along, across = float(chance.randint(-8, 8)), float(chance.randint(16, 80)) / 4
    way = chance.choice([-1, 1]) if facing else chance.choice([-1, -1, -1, 1])
    letters = "XZ" if facing else "ZX"
    lines = [f"G0 {letters[0]}{along:g} {letters[1]}{across:g}"]
    slope = 0.0
    for _ in range(chance.randint(2, 7)):
        kind = chance.choice(["slope", "slope", "along", "across", "arc", "arc", "bend"])
        on, up = way * chance.randint(2, 24) / 4, chance.randint(-20, 28) / 4
        if kind == "bend":  # by a few degrees
            up = round(on * (slope + chance.uniform(-0.12, 0.12)), 3)
        on, up = (0.0 if kind == "across" else on), (0.0 if kind == "along" else up)
        if on == up == 0.0:
            continue
        slope = up / on if on else slope
        lines.append(_line(chance, kind, letters, (along, across), (on, up)))
        along, across = along + on, across + up
    return lines


def _line(chance: random.Random, kind: str, letters: str, here: tuple[float, float], step: tuple[float, float]) -> str:
    """Return a line of a profile from here by a step."""
    words: list[str] = []
    for letter, at, by in zip(letters, here, step, strict=True):
        if chance.random() < 0.1:
            words.append(f"{'U' if letter == 'X' else 'W'}{by:g}")
        elif by:
            words.append(f"{letter}{at + by:g}")
    if kind != "arc":
        corner = f"{chance.choice('AC')}{chance.choice([0.1, 0.3, 0.5])}" if chance.random() < 0.1 else ""
        return " ".join([chance.choice(["G1", "G1", "G0"]), *words, corner])
    chord = (step[0] ** 2 + step[1] ** 2) ** 0.5
    radius = round(chord * chance.randint(52, 200) / 100 + 0.05, 2)
    return " ".join([chance.choice(["G2", "G3"]), *words, f"R{radius:g}"])


def asked(text: bytes) -> tuple[Any, Any]:
    """Return what the reference (None: it hangs) and we say of a program."""
    try:
        judge = ORACLE["reference"](text, seconds=1.0)
    except (subprocess.TimeoutExpired, IndexError):  # it hangs, or dies without a word
        judge = None
    return judge, ORACLE["ours"](text, fast=True, work=WorkState())


def differs(seed: int) -> tuple[str, str] | None:
    """Return how the two differ over the program of a seed, and why; None where they agree."""
    text = program(seed)
    judge, run = asked(text)
    kind = "the reference hangs" if judge is None else kind_of(judge, run)
    return None if kind is None else (kind, reason(text.decode("ascii"), judge, run, asked) or "not known")


def show(seed: int) -> None:
    """Print the program of a seed, and the lines of both, those that differ marked."""
    text = program(seed)
    sys.stdout.write(text.decode("ascii"))
    judge, run = asked(text)
    print("reference:", "hangs" if judge is None else judge.why, "\nours:", run.why)
    for theirs, ours in itertools.zip_longest([] if judge is None else judge.lines, run.lines, fillvalue=""):
        print(" " if ORACLE["alike"](theirs, ours) else "!", theirs.ljust(66), ours)


def main() -> int:
    """Run a campaign as the command line has it, and return the exit code."""
    given = asked_for("generated lathe programs against rs274", show)
    if given is None:
        return 0
    reasons: collections.Counter[str] = collections.Counter()
    for seed, (kind, why) in campaign(differs, given):
        reasons[why] += 1
        print(f"seed {seed}: {why}: {kind}", flush=True)
    print(f"{given.count} cases, {sum(reasons.values())} differ, {reasons['not known']} of them not known why")
    for why, times in reasons.most_common():
        print(f"{times:5} {REASONS.get(why, why)}")
    return 1 if reasons["not known"] else 0


if __name__ == "__main__":
    sys.exit(main())
