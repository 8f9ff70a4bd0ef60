"""Tools, variables and machine actions: what programs find, what they leave, and what motion rests for."""

from __future__ import annotations

from importlib import resources

import numpy as np
import pytest

from trochia.cli import main
from trochia.errors import ConfigError
from trochia.languages.gcode import read
from trochia.languages.gcode.reading import Reading
from trochia.languages.gcode.setup import SetupFiles, check_place, read_setup
from trochia.machine.load import load
from trochia.program import Output, Pause, Spindle, SynchronisedOutput, Tool, UserCode, WorkState
from trochia.toolpath import build

INI = """[RS274NGC]
PARAMETER_FILE = work.var
SUBROUTINE_PATH = subs:more
RS274NGC_STARTUP_CODE = G20
[TRAJ]
LINEAR_UNITS = inch
[EMCIO]
TOOL_TABLE = tool.tbl
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "lin.ini").write_text(INI)
    (tmp_path / "work.var").write_text("500\t1.0\n5221\t2.0\n")
    (tmp_path / "tool.tbl").write_text("T1 P1 Z3 ;long\n")
    (tmp_path / "part.ngc").write_text("#500=[#500+6]\nT1 M6\nG43\nG10 L20 P2 X1\nG10 L1 P1 Z2\nM2\n")
    return tmp_path


def test_ini_names_files_folders_startup_code_and_unit(folder):
    files, reading = read_setup(SetupFiles(), ini=folder / "lin.ini")
    assert files.home == folder
    assert reading.subroutines == (folder / "subs", folder / "more")
    assert reading.startup == "G20"
    assert reading.work.systems[0][0] == pytest.approx(50.8)
    assert reading.work.tools[0].offset[2] == pytest.approx(76.2)


def test_a_file_named_by_another_is_not_written_outside_its_folder(folder):
    (folder / "lin.ini").write_text("[RS274NGC]\nPARAMETER_FILE = ../away.var\n")
    files, _ = read_setup(SetupFiles(), ini=folder / "lin.ini", new_parameters=True)
    with pytest.raises(ConfigError, match="outside"):
        check_place(files)


def test_the_program_leaves_what_it_set():
    left = []
    work = WorkState(tools=(Tool(number=4, offset=(0, 0, 10.0, 0, 0, 0, 0, 0, 0)),), variables={500: 1.0})
    reading = Reading(work=work, on_end=left.append)
    read("#500=7\nG10 L2 P3 X5 R20\nG52 Y2\nG0 X1 Z2\nG28.1\nT4 M6\nG43\nG10 L1 P4 Z11\nM2\n", reading=reading)
    (work,) = left
    assert (work.systems[2][0], work.rotations[2], work.g92[1], work.g92_on) == (5.0, 20.0, 2.0, True)
    assert work.g28[:3] == (1.0, 0.0 + 0.0, 2.0)
    assert (work.tool, work.tools[0].offset[2], work.tool_offset[2], work.variables) == (4, 11.0, 10.0, {500: 7.0})


def test_variables_read_and_set_the_state():
    program = read("#1=#5221\n#5241=9\nG55\nG0 X#1\nT2 M6\nG0 Y#5400\nM2\n",
                   reading=Reading(work=WorkState().placed(X=3.0)))  # fmt: skip
    assert program.moves["target"][:, :2].tolist() == [[12.0, 0.0], [12.0, 2.0]]


def test_tool_offsets_shift_the_machine_and_do_not_turn():
    tools = (Tool(number=1, offset=(10.0, 0, 5.0, 0, 0, 0, 0, 0, 0)),)
    program = read(
        "G10 L2 P1 R90\nT1 M6\nG43\nG0 X1 Y0 Z0\nG20\nG0 X1\nM2\n", reading=Reading(work=WorkState(tools=tools))
    )
    assert program.moves["target"][:, :3] == pytest.approx(np.array([[10, 1, 5], [10, 25.4, 5]]))


def test_only_actions_that_need_it_stop_motion():
    text = "F6000 S100 M3\nG1 X10\n{}\nG1 X20\nM2\n"
    machine = load("reference-mill")

    def rests(line, machine=machine):
        path = build(read(text.format(line)), machine)
        return path.segments["stop"][:-1].any()

    for line in ("S200", "(MSG, hello)", "M62 P1", "M63 P1", "M67 E0 Q1", "M48", "M50 P0", "M3"):
        assert not rests(line), line
    for line in ("G4 P1", "M64 P1", "M65 P1", "M68 E0 Q1", "M66 P0", "M19 R5", "M5", "M4", "M8", "M0", "M6"):
        assert rests(line), line


def test_actions_carry_what_the_words_say():
    program = read("M62 P3\nM68 E1 Q2.5\nM101 P4\nM0\nM2\n", reading=Reading(work=WorkState(user_codes=True)))
    kinds = [type(action) for action in program.actions]
    assert kinds[:4] == [SynchronisedOutput, Output, UserCode, Pause]
    assert (program.actions[0].index, program.actions[0].value) == (3, True)
    assert (program.actions[2].number, program.actions[2].p, program.actions[2].q) == (101, 4.0, None)


def test_a_change_of_speed_is_in_the_moves():
    program = read("F100 S5 M3\nG1 X1\nS7\nG1 X2\nG1 X3 S9\nM5\nG1 X4\nM2\n")
    assert program.moves["power"].tolist() == [5.0, 7.0, 9.0, 0.0]
    assert [action.direction for action in program.actions if isinstance(action, Spindle)] == [1, 0]


@pytest.fixture
def run(monkeypatch, capfdbinary):
    """Run a command; return its exit code and what it printed."""

    def run(*words):
        monkeypatch.setattr("sys.argv", ["trochia", *(str(word) for word in words)])
        code = 0
        try:
            main()
        except SystemExit as end:
            code = end.code or 0
        return code, capfdbinary.readouterr().out.decode()

    return run


def test_nothing_is_written_unless_asked_for(folder, run):
    before = (folder / "work.var").read_text(), (folder / "tool.tbl").read_text()
    assert run("canon", folder / "part.ngc", "--ini", folder / "lin.ini")[0] == 0
    assert ((folder / "work.var").read_text(), (folder / "tool.tbl").read_text()) == before
    assert run("canon", folder / "part.ngc", "--ini", folder / "lin.ini", "--save-parameters")[0] == 0
    _, reading = read_setup(SetupFiles(tools=folder / "tool.tbl", parameters=folder / "work.var"))
    assert reading.work.variables[500] == 7.0
    assert reading.work.tools == (Tool(number=1, pocket=1, offset=(0, 0, 2.0, 0, 0, 0, 0, 0, 0), remark="long"),)


def test_a_wrong_program_writes_nothing(folder, run):
    (folder / "part.ngc").write_text("G10 L2 P1 X9\nG1 X1\nM2\n")
    before = (folder / "work.var").read_text()
    assert run("canon", folder / "part.ngc", "--parameters", folder / "work.var", "--save-parameters")[0] == 1
    assert (folder / "work.var").read_text() == before


def test_canon_prints_table_lengths_as_the_reference_alone(folder, run):
    _, printed = run("canon", folder / "part.ngc", "--tools", folder / "tool.tbl")
    assert "USE_TOOL_LENGTH_OFFSET(0.0000 0.0000 76.2000," in printed


def test_the_machine_file_names_files(folder, run):
    head = 'tools = "tool.tbl"\nparameters = "work.var"\nallow_user_m_codes = true\n'
    text = (resources.files("trochia") / "data" / "machines" / "reference-mill.toml").read_text()
    (folder / "mill.toml").write_text(text.replace("format = 1\n", "format = 1\n" + head))
    (folder / "work.var").write_text("5221\t40\n5222\t40\n5223\t-20\n")
    (folder / "part.ngc").write_text("T1 M6\nG43 H1\nM150 P1\nG0 X1 Y1 Z-3\nM2\n")
    assert run("check", folder / "part.ngc", "-m", folder / "mill.toml")[0] == 0
    assert run("check", folder / "part.ngc", "-m", "reference-mill")[0] == 1
