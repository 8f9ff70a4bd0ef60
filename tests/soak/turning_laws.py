"""Why LinuxCNC's lathe cycles and ours differ over a program: what is the reference's fault, by laws and not by eye.

In: a program with a profile and a cycle along it, and what both say.  Out: a reason of :data:`REASONS`, or None.

The law of D and E is that the tool's way along the profile is its parallel: nowhere nearer, nowhere farther than the
mitre of a slight bend.  It is asked of one pass of G70 at that distance, by points on both ways against the profile.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]
Asks = Callable[[bytes], tuple[Any, Any]]  #: what the reference (None: it hangs) and we say of a program

REASONS = {
    "dies": "it hangs, dies, or prints Oops and goes on",
    "in line": "it refuses a distance from segments that lie in one line",
    "no parallel": "it refuses a profile whose parallel we give, and which is one",
    "cuts": "its way at a distance comes nearer to the profile than that",
    "leaves": "its way at a distance goes farther from the profile than that",
    "slight": "both ways are within 0.001 of the distance; slight bends are joined by mitres or by arcs",
    "small corner": "it calls a profile with a fillet or chamfer of less than about 0.01 not monotonic",
    "fillet": "it takes a fillet that does not fit into its corner",
    "same way": "the same way, with moves of no length or other points within a straight line",
    "bits": "last bits tell it that a level stretch falls, where Z rises and X falls; mirrored, it agrees",
    "valley": "it does not rough what falls again straight behind an arc that falls and rises",
}

STEP = 0.02  #: between points [mm]
SLACK = 1e-3  #: of a law: what is printed has four decimals [mm]
_NUMBER = re.compile(r"-?\d+\.?\d*")
_CYCLE = re.compile(r"^G7[0-2]\S* (Q\S+ X\S+ Z\S+)(.*)$", re.MULTILINE)


def reason(text: str, judge: Any, run: Any, asks: Asks) -> str | None:
    """Return the key of why the two differ over a program; None where it is not known."""
    if judge is None or any(line.startswith("Oops") for line in judge.lines) or not judge.lines[-1:]:
        return "dies"
    if "parallel lines" in judge.why:
        return "in line"
    profile = _alone(text, "", asks)[1]
    found = set() if profile.rejected is not None else {_by_law(text, off, profile, asks) for off in _distances(text)}
    if judge.rejected is None and run.rejected is None and profile.rejected is None and has_valley(profile.lines):
        found.add("valley")
    found |= _by_words(text, judge, run)
    return next((key for key in REASONS if key in found), None) or (
        "bits" if _alike(*asks(_mirrored(text).encode("ascii"))) else None
    )


def _by_words(text: str, judge: Any, run: Any) -> set[str]:
    """Return what the answers themselves tell."""
    found: set[str] = set()
    if judge.rejected is None and " fits into the corner" in run.why:
        found.add("fillet")
    if judge.rejected == run.rejected and _bare(judge.lines) == _bare(run.lines):
        found.add("same way")
    if "monotonic" in judge.why and re.search(r" [AC]0?\.", text):
        found.add("small corner")
    return found


def _bare(lines: list[str]) -> list[tuple[str, float, float]]:
    """Return kinds and ends of moves, without those of no length and ends within a straight line."""
    bare: list[tuple[str, float, float]] = []
    for line in lines:
        if line.startswith(("STRAIGHT_", "ARC_FEED")):
            end = _end(line)
            move = line.partition("(")[0], round(end[0], 3), round(end[1], 3)
            if bare and bare[-1][1:] == move[1:]:
                continue
            if len(bare) > 1 and bare[-1][0] == move[0] == "STRAIGHT_FEED" and _in_line(*bare[-2:], move):
                bare.pop()
            bare.append(move)
    return bare


def _in_line(*moves: tuple[str, float, float]) -> bool:
    one, other = (np.subtract(b[1:], a[1:]) for a, b in itertools.pairwise(moves))
    size = float(np.hypot(*one) * np.hypot(*other))
    return bool(abs(one[0] * other[1] - one[1] * other[0]) < SLACK * size and one @ other > 0.0)


def _mirrored(text: str) -> str:
    """Return the same program with Z the other way round."""
    text = re.sub(r"(?<=[ZW])-?[\d.]+", lambda found: f"{-float(found.group(0)):g}", text)
    return re.sub(r"^G[23]\b", lambda found: {"G2": "G3", "G3": "G2"}[found.group(0)], text, flags=re.MULTILINE)


def _alike(judge: Any, run: Any) -> bool:
    """Return whether both say the same."""
    if judge is None or judge.rejected != run.rejected or len(judge.lines) != len(run.lines):
        return False
    pairs = zip(_NUMBER.findall("".join(judge.lines)), _NUMBER.findall("".join(run.lines)), strict=False)
    return all(abs(float(one) - float(other)) < SLACK / 5 for one, other in pairs)


def _by_law(text: str, off: float, profile: Any, asks: Asks) -> str | None:
    """Return what the law says of the two ways at a distance."""
    judge, run = _alone(text, f"E{off:g}", asks)
    if judge is None or any(line.startswith("Oops") for line in judge.lines):
        return "dies"
    drawn = contour(profile.lines)
    ours = None if run.rejected is not None else strays(contour(run.lines), drawn, abs(off))
    if judge.rejected is not None:
        parallel = ours is not None and max(ours) <= 5 * SLACK
        return "in line" if "parallel lines" in judge.why else "no parallel" if parallel else None
    theirs = strays(contour(judge.lines), drawn, abs(off))
    for key, side in (("cuts", 0), ("leaves", 1)):
        if theirs[side] > SLACK + (0.0 if ours is None else ours[side]):
            return key
    return "slight" if ours is not None and max(theirs) <= 3 * SLACK and judge.lines != run.lines else None


def _alone(text: str, words: str, asks: Asks) -> tuple[Any, Any]:
    """Return what both say of the same profile with one pass of G70 and these words."""
    return asks(_CYCLE.sub(lambda found: f"G70 {found.group(1)} {words}", text).encode("ascii"))


def _distances(text: str) -> Iterable[float]:
    """Return the distances from the profile that the cycle's passes have."""
    found = _CYCLE.search(text)
    assert found is not None
    words = {word[0]: float(word[1:]) for word in found.group(2).split()}
    first, last, passes = words.get("D", 0.0), words.get("E", 0.0), int(words.get("P", 1))
    if not found.group(0).startswith("G70 "):
        return {first} - {0.0}
    return {round(last + (first - last) * left / passes, 6) for left in range(passes)} - {0.0}


# --- ways


def contour(lines: list[str]) -> Points:
    """Return points (rows, 2) in z and x along the one pass of a G70: from its last rapid to the last move but one."""
    moves = _pass_of(lines)
    here = _end(moves[0])
    found = [np.array([here])]
    for line in moves[1:]:
        found.append(_along(here, line))
        here = _end(line)
    return np.concatenate(found)


def strays(path: Points, profile: Points, distance: float) -> tuple[float, float]:
    """Return how much nearer than a distance a path comes to a profile, and how much farther it goes [mm]."""
    begin, way = profile[:-1], np.diff(profile, axis=0)
    size = np.maximum((way**2).sum(1), 1e-18)
    nearest, farthest = np.inf, 0.0
    for point in path:
        share = np.clip(((point - begin) * way).sum(1) / size, 0.0, 1.0)
        apart = float(np.sqrt((((begin + share[:, None] * way) - point) ** 2).sum(1)).min())
        nearest, farthest = min(nearest, apart), max(farthest, apart)
    return max(distance - nearest, 0.0), max(farthest - distance, 0.0)


def _pass_of(lines: list[str]) -> list[str]:
    moves = [line for line in lines if line.startswith(("STRAIGHT_", "ARC_FEED"))][:-1]
    first = max(index for index, line in enumerate(moves) if line.startswith("STRAIGHT_TRAVERSE"))
    return moves[first:]


def has_valley(lines: list[str]) -> bool:
    """Return whether an arc that falls and rises, to one side or the other, stands before another segment that does.

    ``lines`` are those of a G70 along the profile.
    """
    ways = [_along(_end(one), other) for one, other in itertools.pairwise(_pass_of(lines))]
    for one, other in itertools.pairwise(ways):
        for axis in (0, 1):
            steps = np.diff(one[:, axis])
            both = steps.min(initial=0.0) < -1e-6 and steps.max(initial=0.0) > 1e-6
            if both and abs(np.diff(other[:, axis])).max(initial=0.0) > 1e-6:
                return True
    return False


def _end(line: str) -> tuple[float, float]:
    numbers = [float(text) for text in _NUMBER.findall(line)]
    return (numbers[2], numbers[0]) if line.startswith("STRAIGHT") else (numbers[0], numbers[1])


def _along(start: tuple[float, float], line: str) -> Points:
    end = _end(line)
    if line.startswith("STRAIGHT"):
        count = max(int(np.hypot(end[0] - start[0], end[1] - start[1]) / STEP), 1)
        return np.linspace(start, end, count + 1)
    _, _, z, x, turns = [float(text) for text in _NUMBER.findall(line)][:5]
    begin, radius = np.arctan2(start[1] - x, start[0] - z), np.hypot(start[0] - z, start[1] - x)
    sweep = (np.arctan2(end[1] - x, end[0] - z) - begin) * np.sign(turns) % (2 * np.pi) * np.sign(turns)
    angles = begin + np.linspace(0.0, sweep, max(int(abs(sweep) * radius / STEP), 8) + 1)
    return np.column_stack([z + radius * np.cos(angles), x + radius * np.sin(angles)])
