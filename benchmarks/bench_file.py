"""From a file of a million lines to its planned time, the whole command; the reference only reads the same file.

``rs274 -g`` is timed on the same file where it is installed: it has no planner, so it stands for what reading alone
costs elsewhere.
"""

from __future__ import annotations

import math
import shutil
import sys
import tempfile
from pathlib import Path

from harness import Case, command, report

LINES = 1_000_000


def write(path: Path) -> None:
    """Write a spiral with a wave in Z, X Y Z on every line."""
    with path.open("w", encoding="ascii") as file:
        file.write("g21 g90 g17 g64 p0.01\nf2400\ng0 x0 y0 z5\n")
        for i in range(LINES):
            angle, radius = i * 0.01, 10 + i * 0.0002
            x, y, z = radius * math.cos(angle), radius * math.sin(angle), -0.5 * math.sin(angle * 0.37)
            file.write(f"g1 x{x:.4f} y{y:.4f} z{z:.4f}\n")
        file.write("m2\n")


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        part = Path(folder) / "part.ngc"
        write(part)
        trochia = Path(sys.executable).with_name("trochia")
        cases = [
            Case(
                name=f"trochia {verb} --profile {profile}",
                call=command([trochia, verb, part, "-m", "reference-mill", "--profile", profile], Path(folder)),
                count=LINES,
                target=LINES / longest,
            )
            for verb, profile, longest in (
                ("check", "trapezoid", 2.0),
                ("plan", "trapezoid", 2.0),
                ("plan", "s-curve", 4.0),
            )
        ]
        if shutil.which("rs274"):
            cases.insert(
                0, Case(name="rs274 -g", call=command(["rs274", "-g", part], Path(folder)), count=LINES, reference=True)
            )
        report("A file of 1,000,000 lines to its planned time, whole command", "lines", cases, runs=5)


if __name__ == "__main__":
    main()
