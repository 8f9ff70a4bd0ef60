"""O-word loops: lines executed a second, against LinuxCNC's interpreter in the same call, where it is installed."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
import time
from pathlib import Path

from trochia.languages.gcode.canon import Canon
from trochia.languages.gcode.interpreter import interpret

ROUNDS = 40_000
TEXT = f"""G21 G90 G17 F2400
#1 = 0
O100 WHILE [#1 LT {ROUNDS}]
#2 = [#1 * 0.01]
G1 X#2 Y[#2 + 0.5]
#1 = [#1 + 1]
O100 ENDWHILE
M2
"""
EXECUTED = 5 * ROUNDS + 5


def main() -> None:
    """Print the best of three runs of each."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "loop.ngc")
        path.write_text(TEXT, encoding="ascii")
        ours, theirs = [], []
        for _ in range(3):
            start = time.perf_counter()
            with Path(folder, "out.canon").open("wb") as out:
                interpret(path.read_bytes(), Canon(out.write), name="loop.ngc")
            ours.append(time.perf_counter() - start)
            if shutil.which("rs274"):
                start = time.perf_counter()
                subprocess.run(["rs274", "-g", path.name], cwd=folder, capture_output=True, timeout=60, check=True)
                theirs.append(time.perf_counter() - start)
    print(f"trochia  {EXECUTED / min(ours):9.0f} lines/s")
    if theirs:
        print(f"rs274    {EXECUTED / min(theirs):9.0f} lines/s, ratio {min(theirs) / min(ours):.2f}")


if __name__ == "__main__":
    main()
