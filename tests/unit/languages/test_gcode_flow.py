import io

import pytest

from trochia.errors import ModalConflictError, ProgramError, VariableError
from trochia.languages import gcode
from trochia.languages.gcode.canon import print_text
from trochia.languages.gcode.parameters import Parameters
from trochia.languages.gcode.reading import Reading
from trochia.languages.gcode.texts import Texts


def canon(text, **options):
    out = io.BytesIO()
    print_text(text.encode(), out, name="p.ngc", reading=Reading(**options))
    return out.getvalue().decode().split("\n")


def test_an_endless_loop_is_named():
    with pytest.raises(ProgramError, match="more than 50 lines") as caught:
        canon("#1=0\no7 while [1]\n#1=[#1+1]\no7 endwhile\nm2\n", most_lines=50)
    assert caught.value.source is not None
    assert caught.value.source.line == 2
    assert "WHILE" in caught.value.message


def test_a_subroutine_is_found_in_a_folder(tmp_path):
    (tmp_path / "inner").mkdir()
    (tmp_path / "inner" / "hole.ngc").write_text("o<hole> sub\ng0 x#1\no<hole> endsub\nm2\n")
    lines = canon("o<hole> call [3]\no<hole> call [4]\nm2\n", subroutines=(tmp_path / "none", tmp_path / "inner"))
    moves = [line for line in lines if line.startswith("STRAIGHT")]
    assert [move.split("(")[1].split(",")[0] for move in moves] == ["3.0000", "4.0000"]


def test_an_error_in_a_file_names_the_file(tmp_path):
    (tmp_path / "bad.ngc").write_text("o<bad> sub\ng0 x[1/0]\no<bad> endsub\n")
    with pytest.raises(ProgramError, match="division by zero") as caught:
        canon("o<bad> call\nm2\n", subroutines=(tmp_path,))
    assert caught.value.source is not None
    assert (caught.value.source.file, caught.value.source.line) == (str(tmp_path / "bad.ngc"), 2)


@pytest.mark.parametrize("name", ["../out", "a/../../out", "/etc/out", "..", "", ".hidden", "link"])
def test_a_name_never_leads_out_of_its_folder(tmp_path, name):
    folder = tmp_path / "in"
    folder.mkdir()
    (tmp_path / "out.ngc").write_text("m2\n")
    (folder / "link.ngc").symlink_to(tmp_path / "out.ngc")
    assert Texts([folder]).find(name) is None


def test_every_wrong_line_of_a_loop_is_reported_once():
    found = gcode.problems("o1 repeat [5]\ng0 x[1/0]\ng0 y#<no>\no1 endrepeat\nm2\n")
    assert [error.source.line for error in found if error.source] == [2, 3]


def test_a_wrong_o_word_ends_the_report():
    found = gcode.problems("o1 if [1/0]\ng0 x1 x1\no1 endif\nm2\n")
    assert len(found) == 1


def test_calls_restore_arguments_and_names():
    store = Parameters()
    store.set(1, 5.0)
    store.set_named("here", 2.0)
    frame = store.enter([7.0])
    assert (store.get(1), store.get(30), store.find("here")) == (7.0, 0.0, None)
    store.leave(frame)
    assert (store.get(1), store.get_named("here")) == (5.0, 2.0)


@pytest.mark.parametrize("number", [0, -1, 5602])
def test_there_is_no_such_parameter(number):
    with pytest.raises(VariableError, match="there is no variable"):
        Parameters().get(number)


def test_a_subroutine_that_is_nowhere_is_an_error_at_its_call():
    with pytest.raises(ModalConflictError, match="there is no subroutine O5") as caught:
        canon("g0 x1\no5 call\ng0 x2\nm2\n")
    assert caught.value.source is not None
    assert caught.value.source.line == 2


@pytest.mark.parametrize("label", ["o1", "o<name>", "o[#9 + 3]"])
def test_loops_run_alike_with_and_without_kept_lines(label):
    text = f"f100 g1 x0\n{label} while [#1 lt 20]\ng1 x#1 y[#1 * 2]\nx1\ny2\n#1 = [#1 + 1]\n{label} endwhile\nm2\n"
    looped = [line for line in canon(text) if line.startswith("STRAIGHT_FEED")]
    flat = "f100 g1 x0\n" + "".join(f"g1 x{n} y{2 * n}\nx1\ny2\n" for n in range(20)) + "m2\n"
    assert looped == [line for line in canon(flat) if line.startswith("STRAIGHT_FEED")]


def test_diameters_count_in_loops_too():
    lines = canon("f100 g7\no1 repeat [4]\ng1 x#1 z1\n#1=[#1+2]\no1 endrepeat\nm2\n")
    moves = [line for line in lines if line.startswith("STRAIGHT_FEED")]
    assert [move.split("(")[1].split(",")[0] for move in moves] == ["0.0000", "1.0000", "2.0000", "3.0000"]
