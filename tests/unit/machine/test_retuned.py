"""A loop changed in a machine file and had back: nothing else moves, and it is whole or not at all."""

from __future__ import annotations

from importlib import resources
from typing import TYPE_CHECKING

import pytest

from trochia.errors import ConfigError
from trochia.machine.load import loads
from trochia.machine.loop_text import with_loop
from trochia.machine.servos import CascadeLoop, NotchData
from trochia.machine.undo import change, record_of, undo

if TYPE_CHECKING:
    from pathlib import Path

TEXT = (resources.files("trochia") / "data" / "machines" / "xy-table.toml").read_text(encoding="utf-8")
LOOP = CascadeLoop(position_gain=30.5, speed_gain=0.012, speed_integral=20.0,
                   notch=NotchData(frequency=80.0, width=0.5, depth=0.1))  # fmt: skip


@pytest.mark.parametrize("joint", ["X", "Y"])
def test_only_the_loop_of_the_joint_is_another(joint: str) -> None:
    changed = with_loop(TEXT, joint, LOOP)
    before, after = loads(TEXT), loads(changed)
    for one, two in zip(before.joints, after.joints, strict=True):
        assert two.loop == (LOOP if one.name == joint else one.loop)
    kept = [line for line in TEXT.split("\n") if not line.startswith("i")]
    assert set(kept) - set(changed.split("\n")) <= {'kind = "pmac"'}
    assert "# The stages travel 150 mm" in changed


def test_a_loop_on_a_line_becomes_a_table() -> None:
    head, tail = TEXT.split("[joints.X.loop]")
    table, rest = tail.split("\n\n", 1)
    line = f"loop = {{ {', '.join(table.strip().splitlines())} }}\n"
    inline = head.replace("[joints.X.motor]", f"{line}\n[joints.X.motor]", 1) + rest
    assert loads(inline) == loads(TEXT)
    assert loads(with_loop(inline, "X", LOOP)).joints[0].loop == LOOP
    again = with_loop(with_loop(inline, "X", LOOP), "X", CascadeLoop(position_gain=1.0, speed_gain=0.1))
    assert loads(again).joints[0].loop == CascadeLoop(position_gain=1.0, speed_gain=0.1)


def test_a_form_that_is_not_found_is_named() -> None:
    dotted = TEXT.replace("[joints.X.loop]\n", "[joints.X]\n")
    with pytest.raises(ConfigError):
        with_loop(dotted, "X", LOOP)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "table.toml"
    path.write_text(TEXT, encoding="utf-8")
    return path


def test_changes_are_undone_one_by_one(file: Path) -> None:
    first = with_loop(TEXT, "X", LOOP)
    change(file, first, "joints.X.loop")
    change(file, with_loop(first, "Y", LOOP), "joints.Y.loop")
    assert undo(file) == "joints.Y.loop"
    assert file.read_text(encoding="utf-8") == first
    assert undo(file) == "joints.X.loop"
    assert file.read_text(encoding="utf-8") == TEXT
    assert not record_of(file).exists()
    with pytest.raises(ConfigError, match="nothing to undo"):
        undo(file)


def test_what_was_edited_since_is_not_written_over(file: Path) -> None:
    change(file, with_loop(TEXT, "X", LOOP), "joints.X.loop")
    edited = file.read_text(encoding="utf-8").replace("40 mm/s", "30 mm/s")
    file.write_text(edited, encoding="utf-8")
    with pytest.raises(ConfigError, match="was edited since"):
        undo(file)
    assert file.read_text(encoding="utf-8") == edited
    assert record_of(file).exists()


def test_a_cut_between_file_and_record_loses_nothing(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    after = with_loop(TEXT, "X", LOOP)
    with monkeypatch.context() as patched:
        patched.setattr("trochia.machine.undo.write_whole", lambda path, content: _once(path, content, file))
        with pytest.raises(OSError, match="No space"):
            change(file, after, "joints.X.loop")
    assert file.read_text(encoding="utf-8") == TEXT
    assert undo(file) == "joints.X.loop"
    assert file.read_text(encoding="utf-8") == TEXT


def _once(path: Path, content: bytes, file: Path) -> None:
    """Write a record, and fail at the file itself."""
    if path == file:
        raise OSError(28, "No space left on device", str(path))
    path.write_bytes(content)


@pytest.mark.parametrize("text", ["", "[]", '{"format": 7, "changes": []}', '{"format": 1, "changes": [{}]}'])
def test_a_record_that_is_none_is_named(file: Path, text: str) -> None:
    record_of(file).write_text(text, encoding="utf-8")
    with pytest.raises(ConfigError, match="undo"):
        undo(file)
    assert file.read_text(encoding="utf-8") == TEXT
