"""Golden cases: what each must print.  Run as a program it rewrites the expected files; the diff is for review.

A case is a folder with ``program.ngc``, ``expected.canon`` (canonical functions) and, where the program is at fault,
``expected.error`` (the whole report).
"""

from __future__ import annotations

from pathlib import Path

from trochia.errors import ProgramError
from trochia.languages.gcode.canon import Canon
from trochia.languages.gcode.interpreter import interpret

HERE = Path(__file__).parent


def cases() -> list[Path]:
    """Return the folders of all cases."""
    return sorted(path.parent for path in HERE.glob("*/program.ngc"))


def render(case: Path, *, fast: bool = True) -> dict[str, bytes]:
    """Return the expected files of a case, by name."""
    out: list[bytes] = []
    error = ""
    try:
        interpret((case / "program.ngc").read_bytes(), Canon(out.append), name="program.ngc", fast=fast)
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
