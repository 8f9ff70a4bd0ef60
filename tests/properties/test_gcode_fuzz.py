"""Mutated programs: a sample of the campaign of ``make soak``, and whether a campaign would find what it looks for."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
from pathlib import Path

SOAK = Path(__file__).parents[1] / "soak"


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True, check=False,
                          env={**os.environ, "PYTHONPATH": str(SOAK)})  # fmt: skip


def test_a_sample_is_read_or_refused():
    done = run(str(SOAK / "fuzz_gcode.py"), "--count", "2000", "--seed", "1")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "2,000 of 2,000 cases" in done.stdout


def test_an_exception_a_crash_and_a_hang_are_found_and_cut_down():
    program = """
        import os, fuzz_gcode

        def checked(one):
            if one.seed == 3:
                os.abort()
            while one.seed == 5:
                pass
            if b"m2" in one.text.lower():
                raise KeyError("m2")
            return True

        fuzz_gcode.MOST_TRIES = 200
        fuzz_gcode.shrunk.__defaults__ = (60,)
        run = fuzz_gcode.campaign(1, 8, 1, checked=checked, seconds=0.3)
        print(sorted(run.kinds), run.done, run.reached)
    """
    done = run("-c", textwrap.dedent(program))
    assert "['KeyError at <string>:10', 'hang', 'the process died with code -6'] 8 9" in done.stdout, (
        done.stdout + done.stderr
    )


def test_a_case_is_cut_down_to_what_it_takes():
    program = """
        import fuzz_gcode
        bases = fuzz_gcode.origins()
        one = fuzz_gcode.replace(fuzz_gcode.case(1, bases, ("linuxcnc",)), text=b"g0 x1\\ng1 y2 z3\\nm2\\n")
        print(fuzz_gcode.shrunk(one, lambda other: b"z3" in other.text).text)
        print(fuzz_gcode.case(7, bases, ("linuxcnc",)) == fuzz_gcode.case(7, bases, ("linuxcnc",)))
    """
    done = run("-c", textwrap.dedent(program))
    assert done.stdout == "b'z3'\nTrue\n", done.stdout + done.stderr
