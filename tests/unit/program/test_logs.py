"""Log files of a program: in its folder, whole, never over what is no log."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

import trochia
from trochia.errors import ProgramError
from trochia.program import Log
from trochia.program.logs import logs_of, write_logs

if TYPE_CHECKING:
    from pathlib import Path

TEXT = """G21 F600
(LOG, nobody reads this)
(LOGOPEN, a.txt)
(LOG,x is %.1f#<_x>)
G1 X5
(LOG,x is #<_x>)
(LOGCLOSE)
(LOG, nor this)
(LOGAPPEND, b.txt)
(LOG,more)
M2
"""


def _actions(text: str):
    return trochia.gcode(text).actions


def test_lines_go_to_the_log_that_is_open_and_to_the_operator(tmp_path: Path) -> None:
    (tmp_path / "b.txt").write_text("first\n")
    actions = _actions(TEXT)
    assert write_logs(actions, tmp_path / "part.ngc") == [tmp_path / "a.txt", tmp_path / "b.txt"]
    assert (tmp_path / "a.txt").read_text() == "x is 0.0\nx is 5.000000\n"
    assert (tmp_path / "b.txt").read_text() == "first\nmore\n"
    assert [action.text for action in actions if hasattr(action, "text")] == [
        " nobody reads this", "", "x is 0.0", "x is 5.000000", " nor this", "", "more",
    ]  # fmt: skip


def test_a_log_that_is_opened_again_begins_anew_and_one_without_lines_is_empty(tmp_path: Path) -> None:
    actions = _actions("(LOGOPEN,a)\n(LOG,1)\n(LOGOPEN,a)\n(LOG,2)\n(LOGOPEN,c)\nM2\n")
    assert logs_of(actions, tmp_path / "part.ngc") == {tmp_path / "a": b"2\n", tmp_path / "c": b""}


@pytest.mark.parametrize("name", ["part.ngc", "mill.toml", ".profile", "run", "folder", "none/a.txt", "link/a.txt"])
def test_nothing_but_a_log_is_written_over_or_elsewhere(tmp_path: Path, name: str) -> None:
    home = tmp_path / "home"
    (home / "folder").mkdir(parents=True)
    (home / "link").symlink_to(tmp_path)
    for file in ("part.ngc", "mill.toml", "run"):
        (home / file).write_text("kept")
    (home / "run").chmod(0o755)
    actions = _actions(f"(LOGOPEN, good.txt)\n(LOGOPEN, {name})\n(LOG,1)\nM2\n")
    with pytest.raises(ProgramError, match="the log file") as refused:
        write_logs(actions, home / "part.ngc")
    assert refused.value.source is not None
    assert refused.value.source.line == 2
    assert not (home / "good.txt").exists()
    assert (home / "mill.toml").read_text() == "kept"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["home"]


def test_what_the_system_forbids_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def forbidden(path: Path, content: bytes) -> None:
        raise PermissionError(13, "Permission denied", str(path), content)

    monkeypatch.setattr("trochia.program.logs.write_whole", forbidden)
    with pytest.raises(ProgramError, match="cannot be written: Permission denied"):
        write_logs([Log(at=0, line=1, text="", file="a", opens=True)], tmp_path / "part.ngc")
