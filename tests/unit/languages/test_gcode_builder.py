"""Machine coordinates, rates and actions against hand-made numbers."""

import math

import numpy as np
import pytest

from trochia.errors import ModalConflictError, ProgramError
from trochia.languages.gcode import read
from trochia.program import (
    Coolant,
    Dwell,
    End,
    Message,
    MoveKind,
    PathMode,
    Pause,
    Plane,
    Spindle,
    TimeLaw,
    ToolChange,
    WorkState,
)

NONE = (0.0,) * 9


def build(text: str, **options):
    return read(text + "\nM2\n", **options)


def targets(text: str, **options) -> list[list[float]]:
    return build(text, **options).moves["target"].tolist()


def at(*values: float) -> list[float]:
    return [*values, *[0.0] * (9 - len(values))]


def system(*origin: float, turn: float = 0.0) -> WorkState:
    return WorkState(systems=((*origin, *NONE)[:9], *(NONE,) * 8), rotations=(turn, *(0.0,) * 8))


def test_moves_keep_kind_line_and_target():
    moves = build("(one)\nG0 X1\n\nG1 Y2 F60\nG2 X3 I1 J0 P2").moves
    assert moves["kind"].tolist() == [MoveKind.RAPID, MoveKind.FEED, MoveKind.ARC]
    assert moves["line"].tolist() == [2, 4, 5]
    assert moves["target"].tolist() == [at(1), at(1, 2), at(3, 2)]
    assert moves["centre"].tolist() == [[0, 0], [0, 0], [2, 2]]
    assert moves["turns"].tolist() == [0, 0, -2]


def test_nine_axes_are_read():
    assert targets("G0 X1 Y2 Z3 A4 B5 C6 U7 V8 W9") == [[1, 2, 3, 4, 5, 6, 7, 8, 9]]


def test_inches_scale_lengths_but_not_angles():
    assert targets("G20 G0 X1 A1 W1") == [pytest.approx([25.4, 0, 0, 1, 0, 0, 0, 0, 25.4])]


def test_the_part_lies_where_its_system_says():
    assert targets("G0 X1\nG55 G0 X1", work=system(10, 20, 30, 40)) == [at(11, 0, 0, 0), at(1, 0, 0, 0)]
    assert targets("G0 X1 Y0 Z0 A0", work=system(10, 20, 30, 40)) == [at(11, 20, 30, 40)]


def test_placing_moves_the_origin_of_the_active_system():
    assert WorkState().placed(X=5.0, Z=-1.0).systems[0] == (5.0, 0.0, -1.0, *(0.0,) * 6)
    assert targets("G0 X1 Y1", work=WorkState().placed(X=5.0)) == [at(6, 1)]


def test_a_turned_system_turns_x_and_y():
    assert targets("G0 X10 Y0 Z1", work=system(1, 2, turn=90.0)) == [pytest.approx(at(1, 12, 1))]


def test_an_arc_turns_with_its_system():
    moves = build("G0 X0 Y0\nG2 X2 Y0 I1 J0 F60", work=system(10, 0, turn=90.0)).moves
    assert moves["target"][1, :2] == pytest.approx([10, 2])
    assert moves["centre"][1] == pytest.approx([10, 1])


@pytest.mark.parametrize("text", ["G18 G2 X2 I1 Z0 F60", "G18\nG2 X2 I1 F60", "S1 G19 G2 Y2 J1 F60"])
def test_an_arc_off_the_plane_cannot_turn_with_its_system(text):
    with pytest.raises(ModalConflictError, match="XY plane"):
        build("G0 X0 Y0 Z0\n" + text, work=system(0, turn=30.0))


def test_a_shift_calls_the_point_by_another_name():
    assert targets("G0 X5\nG92 X0\nG0 X1\nG53 G0 X1\nG92.1\nG0 X2") == [at(5), at(6), at(1), at(2)]


def test_where_the_machine_stands_is_where_the_program_starts():
    start = (100.0, 50.0, *(0.0,) * 7)
    program = build("G91 G0 X1\nG90 G0 X1", start=start, work=system(10))
    assert program.start.tolist() == list(start)
    assert program.moves["target"].tolist() == [at(101, 50), at(11, 50)]
    assert program.starts().tolist() == [list(start), at(101, 50)]


def test_stored_points_are_machine_points():
    work = WorkState(g28=(7.0, 8.0, *(0.0,) * 7)).placed(X=1.0)
    assert targets("G0 X1\nG28 X3", work=work) == [at(2), at(4), at(7)]


@pytest.mark.parametrize(
    ("text", "rate"),
    [
        ("G1 X1 F600", 10.0),
        ("G20\nG1 X1 F60", 25.4),
        ("F60\nG20\nG1 X1", 1.0),  # the feed was given in mm and stays what it was
        ("F60 G20\nG1 X1", 1.0),  # F acts before G20 on its line
        ("G20\nF60\nG1 A10", 1.0),  # only a rotary axis moves: degree/s
        ("G20\nF60\nG1 X1 A10", 25.4),
    ],
)
def test_feed_per_minute_is_mm_or_degrees_per_second(text, rate):
    moves = build(text).moves
    assert moves["law"][-1] == TimeLaw.PER_SECOND
    assert moves["rate"][-1] == pytest.approx(rate)


def test_a_feed_keeps_its_unit_through_plain_lines():
    moves = build("F60\nG20\nG1 X1\nX2\nX3 F60\nX4").moves
    assert moves["rate"].tolist() == pytest.approx([1.0, 1.0, 25.4, 25.4])


def test_feed_per_revolution_is_mm_per_turn():
    moves = build("S100 M3 G95\nG20 F.01\nG1 X1\nF.01\nX2").moves
    assert moves["law"].tolist() == [TimeLaw.PER_REV] * 2
    assert moves["rate"].tolist() == pytest.approx([0.01, 0.254])


def test_inverse_time_is_moves_per_second():
    moves = build("G93\nG1 X1 F30\nG0 X2\nG2 X4 I1 F6").moves
    assert moves["law"].tolist() == [TimeLaw.INVERSE] * 3
    assert moves["rate"].tolist() == pytest.approx([0.5, 0.0, 0.1])


def test_a_rapid_has_no_rate():
    assert build("F60\nG0 X1").moves["rate"].tolist() == [0.0]


def test_power_is_the_s_of_what_is_on():
    moves = build("G0 X1\nM3\nG1 X2 F60\nS80 X3\nX4\nM5\nX5\nM4 S0\nX6").moves
    assert moves["power"].tolist() == [0, 1, 80, 80, 0, 0]


def test_path_modes_and_tolerances_are_in_mm():
    moves = build("G0 X1\nG64 P.1\nX2\nG20 G64 P.1 Q.2\nX3\nG61\nX4\nG61.1\nX5\nG64\nX6\nG21 G64 P0 Q1\nX7").moves
    assert moves["path_mode"].tolist() == [
        PathMode.BLEND_DEFAULT, PathMode.BLEND, PathMode.BLEND, PathMode.EXACT_PATH, PathMode.EXACT_STOP,
        PathMode.BLEND_DEFAULT, PathMode.BLEND,
    ]  # fmt: skip
    assert moves["tolerance"][:3].tolist() == [[0, 0], [0.1, 0.1], pytest.approx([2.54, 5.08])]
    assert moves["tolerance"][6].tolist() == [0, 1]


def test_planes_of_arcs():
    moves = build("F60\nG2 X2 I1\nG18 G3 Z2 X4 K2 I0\nG19 G2 Y2 J1").moves
    assert moves["plane"].tolist() == [Plane.XY, Plane.ZX, Plane.YZ]
    assert moves["centre"].tolist() == [[1, 0], [2, 2], [1, 2]]  # first and second axis of the plane


def test_actions_stand_before_the_move_that_follows():
    program = build("G0 X1\nM3 S50\nG4 P2\nG1 X2 F60\nM8\n(MSG,hi)\nM0\nT4 M6\nM1")
    assert program.actions == (
        Spindle(at=1, line=2, direction=1, speed=50.0),
        Dwell(at=1, line=3, seconds=2.0),
        Coolant(at=2, line=5, mist=False, flood=True),
        Message(at=2, line=6, text="hi"),
        Pause(at=2, line=7, optional=False),
        Spindle(at=2, line=8, direction=0, speed=50.0),
        ToolChange(at=2, line=8, tool=4),
        Pause(at=2, line=9, optional=True),
        Coolant(at=2, line=10, mist=False, flood=False),
        End(at=2, line=10),
    )


def test_an_action_that_changes_nothing_is_none():
    assert build("M5\nM3 S10\nM3\nS10\nM9\nG0 X1").actions[:-2] == (Spindle(at=0, line=2, direction=1, speed=10.0),)


def test_lines_are_counted_to_the_end_of_the_program():
    assert read("G0 X1\nM2\nnot read\n").lines == 2
    assert read("%\nG0 X1\n%\n").lines == 3 - 1  # the closing % is no line of the program


def test_arrays_of_a_program_are_read_only():
    program = build("G0 X1")
    assert not program.moves.flags.writeable
    assert not program.start.flags.writeable


def test_an_empty_program_has_no_moves():
    assert len(build("").moves) == 0


def test_many_slow_lines_are_kept_in_order():
    count = 20_000  # more than one batch
    text = "".join(f"S{i % 3} G1 X{i} F60\n" for i in range(count))
    moves = build(text).moves
    assert np.array_equal(moves["target"][:, 0], np.arange(count))
    assert np.array_equal(moves["line"], np.arange(1, count + 1))


def test_a_full_turn_in_inches_is_as_long_as_in_mm():
    moves = build("G20 F1\nG2 I1").moves
    radius = math.dist(moves["centre"][0], moves["target"][0, :2])
    assert radius == pytest.approx(25.4)


def test_what_a_program_says_reaches_the_operator():
    program = build("#5 = 2\n(MSG, one)\n(DEBUG, #5)\n(PRINT, three)\n(LOGOPEN, log.txt)\n(LOG, %d#5)\n(LOGCLOSE)")
    messages = [action for action in program.actions if isinstance(action, Message) and action.text]
    said = [(action.line, action.text.strip()) for action in messages]
    assert said == [(2, "one"), (3, "2.000000"), (4, "three"), (6, "2")]


@pytest.mark.parametrize("name", ["/etc/passwd", "../log.txt", "a/../../b", "C:\\log.txt", "..\\log.txt", "", "  "])
@pytest.mark.parametrize("word", ["LOGOPEN", "LOGAPPEND"])
def test_a_log_outside_the_programs_folder_is_refused(word, name):
    with pytest.raises(ProgramError, match="leads out") as caught:
        build(f"G0 X1\n({word}, {name})")
    assert caught.value.source is not None
    assert caught.value.source.line == 2
