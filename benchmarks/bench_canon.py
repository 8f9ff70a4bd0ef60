"""Canonical text of 200,000 plain lines: LinuxCNC's ``rs274 -g`` against ours, whole command and in process.

The files are a spiral of modal G1 lines and a chain of quarter circles in I J form, plus the spiral as other programs
write it.  ``rs274`` rewrites a parameter file in its working directory, so it runs in one of its own.
"""

from __future__ import annotations

import math
import shutil
import sys
import tempfile
from itertools import pairwise
from pathlib import Path

from harness import Case, command, report

LINES = 200_000


def spiral() -> list[str]:
    """Return the spiral's points as words X Y Z."""
    points: list[str] = []
    for i in range(LINES):
        angle, radius = i * 0.01, 10 + i * 0.0002
        points.append(
            f"x{radius * math.cos(angle):.4f} y{radius * math.sin(angle):.4f} z{-0.5 * math.sin(angle * 0.37):.4f}"
        )
    return points


def line_program() -> str:
    head = "g21 g90 g17 g64 p0.01\nf2400\ng0 x0 y0 z5\n"
    return head + "".join(f"g1 {point}\n" for point in spiral()) + "m2\n"


def arc_program() -> str:
    ends, radii = [0.0], [1 + (i % 7) * 0.5 if i % 2 == 0 else -1 - (i % 7) * 0.5 for i in range(LINES)]
    for radius in radii:
        ends.append(ends[-1] + radius)
    arcs = (f"g2 x{b:.4f} y{b:.4f} i{r:.4f} j0\n" for (_, b), r in zip(pairwise(ends), radii, strict=True))
    return "g21 g90 g17 g91.1\nf2400\ng0 x0 y0 z0\n" + "".join(arcs) + "m2\n"


def post_processor_program() -> str:
    """Upper case, no blanks, line numbers, F on each line, CRLF, a comment now and then."""
    lines: list[str] = ["G21G90G17", "G0X0Y0Z5"]
    for i, point in enumerate(spiral()):
        lines.append(f"N{i % 99999}G01{point.upper().replace(' ', '')}F{600 + i % 5 * 100}.")
        if i % 100 == 0:
            lines += [f"(PASS {i // 100})", "G01 F900", "F900", "; end of pass"]
    return "\r\n".join([*lines, "M30"]) + "\r\n"


PROGRAMS = {"g1": line_program, "arc": arc_program, "post": post_processor_program}


def in_process(path: Path) -> None:
    """Print a program's canonical text into nothing."""
    from trochia.languages.gcode import canon  # noqa: PLC0415 - timed apart from the start of the process

    with Path("/dev/null").open("wb") as out:
        canon.print_program(path, out)


def program_of(path: Path) -> object:
    """Return the program of a file: moves in machine coordinates, and actions."""
    from trochia.languages import gcode  # noqa: PLC0415 - likewise

    return gcode.read(path.read_bytes())


def columns(path: Path) -> int:
    """Read all plain lines of a program into rows of columns; return their number."""
    from trochia.kernels.gcode import STOP_LINE, PlainReader  # noqa: PLC0415 - likewise

    text = path.read_bytes()
    reader, count = PlainReader(text), 0
    reader.modal.axes, reader.modal.feed, reader.modal.spiral = 0x3F, 1.0, 0.02
    reader.modal.spiral_most, reader.modal.spiral_share, reader.modal.least_radius = 2.0, 0.001, 0.00127
    while reader.modal.offset < len(text):
        count += len(reader.read())
        if reader.modal.stop == STOP_LINE:  # a line for the interpreter: skipped here
            reader.modal.offset = text.find(b"\n", reader.modal.offset) + 1 or len(text)
    return count


def main() -> None:
    ours, reference = Path(sys.executable).with_name("trochia"), shutil.which("rs274")
    with tempfile.TemporaryDirectory() as folder:
        for name, program in PROGRAMS.items():
            path = Path(folder, f"{name}.ngc")
            path.write_text(program(), newline="")
            count = path.read_bytes().count(b"\n")
            cases = [
                Case(name="trochia canon", call=command([ours, "canon", path]), count=count, target=600_000),
                Case(name="in process", call=lambda p=path: in_process(p), count=count, target=2_000_000),
                Case(name="to columns", call=lambda p=path: columns(p), count=count, target=5_000_000),
                Case(name="to a program", call=lambda p=path: program_of(p), count=count, target=5_000_000),
            ]
            if reference:
                call = command([reference, "-g", path], Path(folder))
                cases.insert(0, Case(name="rs274 -g", call=call, count=count, reference=True))
            report(f"{name}: {count:,} lines", "lines", cases)


if __name__ == "__main__":
    main()
