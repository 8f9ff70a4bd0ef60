"""What is written for a plain board is, read back, the same moves: any program, and every sample of the house."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.errors import LimitError, ProgramError
from trochia.languages import gcode
from trochia.languages.gcode.targets import TARGETS
from trochia.languages.gcode.write import lines, write

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.program import Program

SAMPLES = sorted((Path(__file__).parents[2] / "programs").glob("*.ngc"))
PLAIN = set("GMXYZIJKFSPTN0123456789.-")
NEAR = 1.0001e-4  # mm: the writer's last decimal


def back(program: Program) -> Program:
    text = write(program)
    return gcode.read(text, reading=gcode.Reading(dialect=gcode.DIALECTS["grbl"]), start=tuple(program.start))


def going(program: Program) -> NDArray[Any]:
    """Return the moves that lead somewhere further than the writer's last decimal."""
    ways = np.abs(program.moves["target"] - program.starts())[:, :3].max(axis=1, initial=0.0)
    return program.moves[(ways > NEAR) | (program.moves["kind"] == 2)]


def same(program: Program) -> None:
    before, after = going(program), going(back(program))
    assert len(before) == len(after)
    assert (before["kind"] == after["kind"]).all()
    np.testing.assert_allclose(after["target"], before["target"], atol=NEAR, rtol=0)
    arcs = before["kind"] == 2
    np.testing.assert_allclose(after["centre"][arcs], before["centre"][arcs], atol=NEAR, rtol=0)
    assert (np.sign(after["turns"][arcs]) == np.sign(before["turns"][arcs])).all()
    assert (after["plane"][arcs] == before["plane"][arcs]).all()
    fed = (before["kind"] != 0) & (before["law"] == 0)
    np.testing.assert_allclose(after["rate"][fed], before["rate"][fed], atol=1e-5, rtol=0)
    lit = before["power"] > 0
    np.testing.assert_allclose(after["power"][fed & lit], before["power"][fed & lit], atol=1e-3, rtol=0)


coordinates = st.floats(-900, 900).map(lambda value: round(value, 4))


@st.composite
def programs(draw: st.DrawFn) -> Program:
    """Draw lines, rapids and arcs in all planes, absolute and incremental, with F and S as they come."""
    text = "G21 G90 G94 F1000 M3 S500\n"
    for _ in range(draw(st.integers(1, 25))):
        kind = draw(st.sampled_from(["G0", "G1", "arc", "G90", "G91", "S", "F"]))
        if kind == "arc":
            plane, offsets = draw(st.sampled_from([("G17", "IJ"), ("G18", "IK"), ("G19", "JK")]))
            word = draw(st.sampled_from(["G2", "G3"]))
            radii = draw(st.tuples(st.floats(0.5, 80), st.floats(-80, 80)))
            climb = draw(st.sampled_from(["", {"G17": "Z", "G18": "Y", "G19": "X"}[plane] + "1.5"]))
            text += f"{plane} {word} {offsets[0]}{radii[0]:.4f} {offsets[1]}{radii[1]:.4f} {climb}\n"  # whole turns
        elif kind in {"G0", "G1"}:
            axes = draw(st.lists(st.sampled_from("XYZ"), min_size=1, max_size=3, unique=True))
            text += kind + "".join(f" {axis}{draw(coordinates):.4f}" for axis in axes) + "\n"
        elif kind in {"F", "S"}:
            text += f"{kind}{draw(st.integers(1, 9000))}\n"
        else:
            text += kind + "\n"
    return gcode.read(text + "M2\n")


@given(programs())
def test_any_program_comes_back(program: Program) -> None:
    same(program)


@given(
    start=st.tuples(coordinates, coordinates), radius=st.floats(0.05, 400), begin=st.floats(0, 6.2832),
    sweep=st.floats(0.01, 6.27), word=st.sampled_from(["G2", "G3"]),
)  # fmt: skip
def test_any_arc_comes_back(
    start: tuple[float, float], radius: float, begin: float, sweep: float, word: str
) -> None:  # fmt: skip
    sign = 1.0 if word == "G3" else -1.0
    centre = start[0] - radius * np.cos(begin), start[1] - radius * np.sin(begin)
    angle = begin + sign * sweep
    end = centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle)
    text = (f"G21 F600\nG0 X{start[0]:.8f} Y{start[1]:.8f}\n{word} X{end[0]:.8f} Y{end[1]:.8f} "
            f"I{centre[0] - start[0]:.8f} J{centre[1] - start[1]:.8f}\nM2\n")  # fmt: skip
    same(gcode.read(text))


@pytest.mark.parametrize("path", SAMPLES, ids=lambda path: path.stem)
def test_samples_are_written_in_plain_words_and_short_lines(path: Path) -> None:
    for line in write(gcode.read(path.read_bytes())).splitlines():
        assert set(line) <= PLAIN
        assert len(line) <= TARGETS["grbl"].width


@pytest.mark.parametrize("path", [path for path in SAMPLES if path.stem != "pocket"], ids=lambda path: path.stem)
def test_samples_come_back(path: Path) -> None:
    same(gcode.read(path.read_bytes()))  # the pocket has arcs of several turns: see below


def test_cycles_expressions_and_compensation_become_plain_moves() -> None:
    text = ("T1 M6 G21 F300\no1 sub\nG0 X[#1 * 2] Y[sqrt[#2]]\no1 endsub\no1 call [3] [49]\n"
            "G98 G83 X10 Y10 Z-6 R1 Q2\nX20\nG80\nG41.1 D4 G1 X40 Y0\nX60\nY30\nG40 G0 X0 Y0 Z5\nM2\n")  # fmt: skip
    same(gcode.read(text))


def test_a_helix_of_three_turns_is_three_helices() -> None:
    program = gcode.read("G21 F600\nG0 X10\nG2 X10 Y0 I-10 Z-6 P3\nM2\n")
    arcs = [line.text for line in lines(program) if "I" in line.text]
    assert arcs == ["G2X10Y0Z-2I-10J0F600", "X10Y0Z-4I-10J0", "X10Y0Z-6I-10J0"]


def test_chords_of_a_spline_stay_within_the_bound() -> None:
    program = gcode.read("G21 F600\nG0 X0 Y0\nG5 X30 Y10 I0 J20 P-10 Q15\nM2\n")
    points = program.splines[0]
    ends = np.vstack([program.start[None, :3], back(program).moves["target"][:, :3]])
    t = np.linspace(0, 1, 4001)[:, None]
    curve = (
        (1 - t) ** 3 * points[0] + 3 * t * (1 - t) ** 2 * points[1] + 3 * t * t * (1 - t) * points[2] + t**3 * points[3]
    )
    way = np.diff(ends, axis=0)
    keep = np.linalg.norm(way, axis=1) > 0
    starts, way = ends[:-1][keep], way[keep]
    along = np.clip(((curve[:, None] - starts) * way).sum(2) / (way**2).sum(1), 0, 1)
    away = np.linalg.norm(curve[:, None] - starts - along[..., None] * way, axis=2).min(axis=1)
    assert 1e-5 < away.max() <= TARGETS["grbl"].chord + NEAR


def test_inverse_time_is_written_as_a_feed() -> None:
    program = gcode.read("G21 G93 G1 X30 Y40 F2\nM2\n")  # 50 mm in half a minute
    assert "F100" in write(program)


def test_a_feed_per_turn_is_written_as_a_feed() -> None:
    program = gcode.read("G21 M3 S300 G95 G1 X30 F0.2\nM2\n")
    assert "F60" in write(program)


def test_a_beam_is_lit_by_the_mode_that_follows_speed() -> None:
    program = gcode.read("G21 M3 S300 G1 X10 F600\nS500 X20\nM5\nM2\n")
    words = [line.text for line in lines(program, beam=True)][1:]
    assert words == ["M4S300", "G1X10F600", "X20S500", "M5", "M2"]
    assert "M4S1000" in [line.text for line in lines(program, beam=True, shutter=1000.0)]


@pytest.mark.parametrize(("text", "what"), [
    ("G21 M62 P0\nG1 X1 F100\nM2\n", "synchronised output"),
    ("M3 S100\nM19 R90\nM2\n", "orient"),
    ("M66 P0 L3 Q2\nM2\n", "wait input"),
    ("M3 S100\nG33 Z-5 K1\nM2\n", "spindle lock"),
])  # fmt: skip
def test_what_a_plain_board_lacks_is_refused_with_its_line(text: str, what: str) -> None:
    with pytest.raises(ProgramError, match=f"no {what}") as caught:
        write(gcode.read(text))
    assert caught.value.source is not None


def test_an_axis_the_board_lacks_is_refused() -> None:
    with pytest.raises(LimitError, match="A moves"):
        write(gcode.read("G21 G0 X1\nG1 A90 F100\nM2\n"))
