"""Every error that a program can earn has a golden program, so an entry on the page of errors; all have a remedy."""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

import trochia
import trochia.languages.gcode as room
from trochia.errors import ProgramError
from trochia.languages.gcode import Reading

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOM = Path(room.__file__).parent
GOLDEN = Path(__file__).parents[2] / "golden"
REPORTS = "\n".join(path.read_text("utf-8") for path in GOLDEN.glob("*/expected.error"))

#: files whose errors are not those of a program that is read, and where they are tested
ELSEWHERE = {
    "setup.py": "files that the command line names: test_gcode_setup.py",
    "write.py": "programs written for boards: tests/properties/test_gcode_write.py",
    "written_actions.py": "likewise",
}
#: errors that canon does not have, as it prints more than a program can be, or only after ten million lines
UNSHOWN = {
    "in a turned coordinate system an arc must lie in the XY plane": "G10 L2 P1 R30\nG18 F100 G2 X1 Z1 I1\nM2\n",
    "this move would end at a point that is not finite": "F3\nG5.1 Y[EXP[700]] I1 J0\nM2\n",
    "more than .* lines were executed, the last ones by this .*": "O1 WHILE [1]\nO1 ENDWHILE\nM2\n",
    "more than .* lines were executed": 60 * "#1 = 1\n" + "M2\n",
}


def _calls() -> Iterator[tuple[str, ast.Call]]:
    """Yield the calls that make errors: of ``fault``, and of an exception by its name."""
    for path in sorted(ROOM.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Call):
                name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
                if name == "fault" or (name.endswith("Error") and name not in {"ValueError", "GougeError"}):
                    yield path.name, node


def _pattern(node: ast.expr) -> str:
    """Return a regular expression for a message; empty where it is not one."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return re.escape(node.value)
    if isinstance(node, ast.JoinedStr):
        return "".join(re.escape(str(part.value)) if isinstance(part, ast.Constant) else ".*" for part in node.values)
    return ""


def _messages() -> dict[str, str]:
    """Return the patterns of messages, with the file they stand in."""
    found: dict[str, str] = {}
    for file, call in _calls():
        patterns = [pattern for pattern in map(_pattern, call.args[:3]) if len(pattern.replace(".*", "")) > 5]
        if patterns:
            found[patterns[0]] = file
    return found


MESSAGES = _messages()


@pytest.mark.parametrize("pattern", [one for one, file in MESSAGES.items() if file not in ELSEWHERE])
def test_every_error_has_a_golden_program(pattern: str) -> None:
    assert len(MESSAGES) > 150
    plain = pattern.replace("\\", "")
    if plain in UNSHOWN:
        with pytest.raises(ProgramError, match=pattern) as caught:
            trochia.gcode(UNSHOWN[plain], reading=Reading(most_lines=50))
        assert caught.value.source is not None
        assert caught.value.hint
    else:
        assert re.search(pattern, REPORTS), f"no program in tests/golden earns {plain!r}"


def test_every_error_has_a_remedy() -> None:
    bare = [f"{file}:{call.lineno}" for file, call in _calls()
            if call.args and not any(word.arg in {"hint", None} for word in call.keywords)]  # fmt: skip
    assert bare == []
