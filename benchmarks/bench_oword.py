"""O-word programs: lines executed a second, against LinuxCNC's interpreter in the same call, where it is installed.

Both are timed by the processor time they take, so that the ratio holds on a busy machine, too.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from harness import processor_seconds
from trochia.languages.gcode.canon import Canon
from trochia.languages.gcode.interpreter import interpret

ROUNDS, TIMES = 40_000, 3
#: name -> lines executed in a round, and the program
PROGRAMS = {
    "numbers": (5, f"#1=0|o1 while [#1 lt {ROUNDS}]|#2=[#1*0.01]|g1 x#2 y[#2+0.5]|#1=[#1+1]|o1 endwhile"),
    "names": (5, f"#<i>=0|o1 while [#<i> lt {ROUNDS}]|#<a>=[#<i>*0.01]|g1 x#<a> y[#<a>+0.5]|#<i>=[#<i>+1]|o1 endwhile"),
    "calls": (6, f"o2 sub|g1 x#1 y#2|o2 endsub|#3=0|o1 repeat [{ROUNDS}]|#3=[#3+1]|o2 call [#3] [#3*2]|o1 endrepeat"),
    "branches": (6, f"#3=0|o1 repeat [{ROUNDS}]|#3=[#3+1]|o2 if [#3 lt 9]|g1 x#3|o2 else|g1 y#3|o2 endif|o1 endrepeat"),
    "arcs": (4, f"#3=0|o1 repeat [{ROUNDS}]|#3=[#3+1]|g2 x#3 i.5|o1 endrepeat"),
}  # fmt: skip


def main() -> None:
    """Print the best of some runs of each."""
    reference = shutil.which("rs274")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "loop.ngc")
        for name, (lines, program) in PROGRAMS.items():
            text = f"g21 g90 g17 f2400|{program}|m2|".replace("|", "\n")
            path.write_text(text, encoding="ascii")
            ours, theirs = [], []
            for _ in range(TIMES):
                start = processor_seconds()
                with Path(folder, "out.canon").open("wb") as out:
                    interpret(path.read_bytes(), Canon(out.write), name="loop.ngc")
                ours.append(processor_seconds() - start)
                if reference:
                    start = processor_seconds(children=True)
                    with Path(folder, "out.rs274").open("wb") as out:
                        subprocess.run([reference, "-g", path.name], cwd=folder, stdout=out, stderr=subprocess.DEVNULL,
                                       timeout=60, check=True, env={**os.environ, "HOME": folder})  # fmt: skip
                    theirs.append(processor_seconds(children=True) - start)
            told = f"{name:9} trochia {lines * ROUNDS / min(ours):11,.0f} lines/s"
            if theirs:
                told += f"   rs274 {lines * ROUNDS / min(theirs):11,.0f}   ratio {min(theirs) / min(ours):.2f}"
            print(told)


if __name__ == "__main__":
    main()
