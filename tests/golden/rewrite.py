"""Golden cases: what each must print.  Run as a program it rewrites the expected files; the diff is for review.

A case is a folder with ``program.ngc``, ``expected.canon`` (canonical functions) and, where the program is at fault,
``expected.error`` (the whole report).  ``tool.tbl`` and ``params.var`` are its tools and stored offsets, lengths in
inches as the reference alone has them; where there is a file ``user-codes``, M100 to M199 may be called.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from trochia.errors import ProgramError
from trochia.languages.gcode.canon import Canon
from trochia.languages.gcode.interpreter import interpret
from trochia.program import WorkState
from trochia.program.parameter_file import read_variables, work_from
from trochia.program.tool_file import read_tools

HERE = Path(__file__).parent
INCH = 25.4  # mm


def cases() -> list[Path]:
    """Return the folders of all cases."""
    return sorted(path.parent for path in HERE.glob("*/program.ngc"))


def work_of(case: Path) -> WorkState:
    """Return what the program of a case finds set up on the machine."""
    work = WorkState(unit=INCH, user_codes=(case / "user-codes").exists())
    tools, variables = case / "tool.tbl", case / "params.var"
    if tools.exists():
        work = replace(work, tools=read_tools(tools.read_text(), tools.name, unit=INCH))
    if variables.exists():
        work = work_from(read_variables(variables.read_text(), variables.name), work, unit=INCH)
    return work


def render(case: Path, *, fast: bool = True) -> dict[str, bytes]:
    """Return the expected files of a case, by name."""
    out: list[bytes] = []
    error = ""
    try:
        text = (case / "program.ngc").read_bytes()
        interpret(text, Canon(out.append), name="program.ngc", fast=fast, work=work_of(case))
    except ProgramError as fault:
        error = f"{fault.code}: {fault}\n"
    files = {"expected.canon": b"".join(out)}
    if error:
        files["expected.error"] = error.encode()
    return files


def main() -> None:
    """Write the expected files of every case, and remove those that are no longer expected."""
    for case in cases():
        files = render(case)
        for old in case.glob("expected.[ce]*"):
            if old.name not in files and old.name in ("expected.canon", "expected.error"):
                old.unlink()
        for name, content in files.items():
            (case / name).write_bytes(content)


if __name__ == "__main__":
    main()
