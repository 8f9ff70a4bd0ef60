"""The sample programs' known facts: lengths, moves and extents that their sources state."""

from pathlib import Path

import numpy as np
import pytest

from trochia.languages.gcode import problems, read
from trochia.program import MoveKind, Program

PROGRAMS = Path(__file__).parents[3] / "programs"


def load(name: str) -> Program:
    return read((PROGRAMS / name).read_bytes(), name=name)


def lengths(program: Program) -> np.ndarray:
    """Length of every move in XY, arcs by angle times radius [mm]."""
    starts, moves = program.starts()[:, :2], program.moves
    ends, centres = moves["target"][:, :2], moves["centre"]
    a, b = starts - centres, ends - centres
    angle = np.arctan2(b[:, 1], b[:, 0]) - np.arctan2(a[:, 1], a[:, 0])
    swept = np.mod(angle * np.sign(moves["turns"]), 2 * np.pi)
    swept[swept == 0] = 2 * np.pi
    arc = moves["kind"] == MoveKind.ARC
    return np.where(arc, swept * np.hypot(*a.T), np.hypot(*(ends - starts).T))


def extents(program: Program) -> list[list[float]]:
    """Least and greatest X and Y of the feed moves' ends and starts, arcs by their ends."""
    feed = program.moves["kind"] != MoveKind.RAPID
    points = np.concatenate([program.starts()[feed], program.moves["target"][feed]])[:, :2]
    return [points.min(axis=0).tolist(), points.max(axis=0).tolist()]


def test_contour_specimen():
    program = load("contour.ngc")
    length, kinds = lengths(program), program.moves["kind"]
    assert length[kinds == MoveKind.FEED].sum() == pytest.approx(438.195, abs=5e-4)
    assert length[kinds == MoveKind.ARC].sum() == pytest.approx(881.518, abs=5e-4)
    assert length[kinds != MoveKind.RAPID].sum() == pytest.approx(1319.713, abs=5e-4)
    assert np.count_nonzero(length[kinds != MoveKind.RAPID]) == 194
    assert np.count_nonzero(kinds == MoveKind.ARC) == 40
    assert extents(program) == [[8.006, 8.008], [91.992, 91.994]]  # no arc reaches beyond the outer polygon


def test_contour_specimen_takes_as_long_as_its_feed_says():
    program = load("contour.ngc")
    feed = program.moves["kind"] != MoveKind.RAPID
    assert (lengths(program)[feed] / program.moves["rate"][feed]).sum() == pytest.approx(13.197, abs=5e-4)


def test_hatch_specimen():
    program = load("hatch.ngc")
    length, feed = lengths(program), program.moves["kind"] != MoveKind.RAPID
    assert length[feed].sum() == pytest.approx(2107.600, abs=5e-4)
    assert np.count_nonzero(length[feed]) == 160
    assert extents(program) == [[5.0, 5.0], [95.0, 95.0]]
    assert (length[feed] / program.moves["rate"][feed]).sum() == pytest.approx(140.507, abs=5e-4)


def test_the_beam_is_on_exactly_while_the_specimens_are_cut():
    for name in ("contour.ngc", "hatch.ngc"):
        moves = load(name).moves
        assert np.array_equal(moves["power"] > 0, moves["kind"] != MoveKind.RAPID)


@pytest.mark.parametrize("path", sorted(PROGRAMS.glob("*.ngc")), ids=lambda path: path.name)
def test_every_sample_says_what_it_is_and_can_be_read(path):
    text = path.read_text(encoding="latin-1")
    assert text.removeprefix("%\n").startswith("(")
    assert problems(text, name=path.name) == []
