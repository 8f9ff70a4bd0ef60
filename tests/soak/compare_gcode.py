"""Mutated G-code programs against LinuxCNC's ``rs274``: accepted or refused alike, at the same line, with like output.

    python tests/soak/compare_gcode.py --count 10000 --seed 1 --jobs 2

Case N is made from seed N alone, like those of ``fuzz_gcode.py``.  Differences are told with their seeds, gathered by
what both sides say; ``--show SEED`` prints one case with both answers.  Exit code 1: there were differences.
"""

from __future__ import annotations

import argparse
import collections
import re
import runpy
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from fuzz_gcode import ROOT
from mutations import Case, Origin, case

from trochia.program import WorkState
from trochia.program.tool_file import read_tools

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

ORACLE = runpy.run_path(str(ROOT / "tests" / "oracle" / "conftest.py"))
GOLDEN = runpy.run_path(str(ROOT / "tests" / "golden" / "rewrite.py"))
TOOLS = "T1 P1 Z0.5 D0.25\nT2 P2 X0.1 Z1.5 D.3 Q2\nT10 P7 Z-2 D1\n"  #: of a program that has no table of its own
KNOWN = frozenset({  # golden cases the comparison knows to differ, see tests/oracle/test_rs274.py
    "error-thread-cycle-slide-too-steep", "error-binary", "branches", "error-python-in-comment", "user-codes",
    "error-compensation-no-table", "tools",
})  # fmt: skip
#: what is not asked: Python in comments, NUL bytes (the reference reads up to them), files that the reference writes
NOT_ASKED = re.compile(rb"[(;][ \t]*py|\0|\(\s*(?:log|probe)(?:open|append)", re.IGNORECASE)


def origins() -> tuple[list[Origin], dict[str, dict[str, str]]]:
    """Return programs to begin with, those that are accepted three times, and the reference's files for them."""
    found: list[Origin] = []
    files: dict[str, dict[str, str]] = {}
    for path in GOLDEN["cases"]():
        if path.name not in KNOWN:
            one = Origin(path.name, (path / "program.ngc").read_bytes(), GOLDEN["work_of"](path))
            found += [one] * (1 if (path / "expected.error").exists() else 3)
            extra = {"variables": path / "params.var", "tools": path / "tool.tbl"}
            files[path.name] = {name: file.read_text() for name, file in extra.items() if file.exists()}
    for number, line in enumerate((ROOT / "tests" / "oracle" / "snippets.txt").read_text().split("\n")):
        if line and not line.startswith("#"):
            name = f"snippet {number}"
            text = "\n".join([*line.split(" | "), "m2", ""]).encode("latin-1")
            found.append(Origin(name, text, WorkState(unit=GOLDEN["INCH"])))
            files[name] = {}
    return found, files


_BASES, _FILES = origins()


def made(seed: int) -> tuple[Case, dict[str, str]]:
    """Return the case of a seed, and the reference's files for it."""
    one = case(seed, _BASES, ("linuxcnc",))
    files = _FILES[next(base for base in _BASES if base.work is one.work).name]
    if "variables" in files:  # the stand-alone reference does not turn the point where it starts
        one = replace(one, text=b"g53 g0 x0 y0 z0 a0 b0 c0\n" + one.text)
    if "tools" not in files:
        files = files | {"tools": TOOLS}
        one = replace(one, work=replace(one.work, tools=read_tools(TOOLS, "tool.tbl", unit=one.work.unit)))
    return one, files


def differs(seed: int) -> tuple[str, str] | None:
    """Return what both sides say of a case where they differ: a kind, and the details."""
    one, files = made(seed)
    if NOT_ASKED.search(one.text):
        return None
    return difference(one.text, one.work, files)


def difference(text: bytes, work: WorkState, files: dict[str, str]) -> tuple[str, str] | None:
    """Return how the two differ over a program: a kind, and the details; None where they agree."""
    try:
        judge = ORACLE["reference"](text, **files)
    except subprocess.TimeoutExpired:
        judge = None
    run = ORACLE["ours"](text, fast=True, work=work)
    if judge is None or run.why.startswith("more than"):
        return None  # endless, or too long to ask
    kind = kind_of(judge, run)
    if kind is None or _known(judge, run):
        return None
    return (kind, f"reference: {judge.rejected!r}, {judge.why!r}\nours: {run.why}")


#: what is refused here on purpose, while the reference takes it: it marks a word that is not there by -1, and so does
#: not see a word that says -1; it reads names without their end; it lets infinite numbers go on; polar words may repeat
_STRICTER = (
    "the result is infinite", "the result is no finite number", "the name is not closed", "the word @ stands twice",
    "the word ^ stands twice", "G4 has no time",
    # bounds, and profiles of lathe cycles: see docs/reference/gcode.md
    "would peck more than", "may repeat a cycle at most", "would take more than", "an arc of more than",
    "cannot stand in the profile", " of its profile: ", "cannot stand beside G7", " cannot move ",
    "more than 10000 passes", "cannot stand behind an O-word",
)  # fmt: skip
_MINUS_ONE = re.compile(r"[a-z] *(?:-+ *1(?:\.0*)?(?![\d.])|\[)", re.IGNORECASE)


def _known(judge: Any, run: Any) -> bool:
    """Return whether a difference is one that is meant to be; see docs/soak.md."""
    ours = run.why.split("\n")[0]
    if "no code on this line reads" in ours and _MINUS_ONE.search(run.rejected or ""):
        return True
    if "no code on this line reads" in ours and "g5.3" in (run.rejected or "").lower():
        return True  # a control point beside G5.3, which the reference forgets
    if re.search(r"m\s*0+9[89]", (judge.rejected or "").lower()):
        return True  # it knows M98 and M99 by their letters only
    return "(abort" in judge.why.lower() or judge.why.startswith(" ") or any(what in ours for what in _STRICTER)


def kind_of(judge: Any, run: Any) -> str | None:
    """Return in what kind of way two runs differ; None where they agree."""
    why = re.sub(r"-?\d+(\.\d+)?", "#", judge.why) if judge.rejected is not None else "accepts"
    mine = re.sub(r"^[^ ]* |-?\d+(\.\d+)?", "#", run.why.split("\n")[0]) if run.rejected is not None else "accepts"
    if (judge.rejected is None) != (run.rejected is None):
        return f"reference: {why} | ours: {mine}"
    for theirs, ours in zip(judge.lines, run.lines, strict=False):
        if not ORACLE["alike"](theirs, ours):
            return f"prints {theirs.split('(')[0]}, ours {ours.split('(')[0]}"
    if run.lines[len(judge.lines) :] not in ([], ["ON_RESET()"] * 3):
        return "another number of lines"
    if judge.rejected is None or ORACLE["_sought_in_vain"](judge.why, run.why):
        return None
    same = (run.rejected or "").strip().startswith(judge.rejected.strip())
    return None if same else f"another line: reference: {why} | ours: {mine}"


def campaign(
    differs: Callable[[int], tuple[str, str] | None], given: argparse.Namespace
) -> Iterator[tuple[int, tuple[str, str]]]:
    """Yield the seeds that differ, and how."""
    with ProcessPoolExecutor(given.jobs) as pool:
        seeds = range(given.seed, given.seed + given.count)
        for seed, found in zip(seeds, pool.map(differs, seeds, chunksize=25), strict=True):
            if found is not None:
                yield seed, found


def asked_for(description: str, show: Callable[[int], None]) -> argparse.Namespace | None:
    """Return what the command line asks for; None where there is no reference, or where one case was to be shown."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--count", type=int, default=2000, help="how many cases")
    parser.add_argument("--seed", type=int, default=1, help="the first one")
    parser.add_argument("--jobs", type=int, default=1, help="worker processes")
    parser.add_argument("--show", type=int, metavar="SEED", help="print this case and what both say")
    given = parser.parse_args()
    if ORACLE["RS274"] is None:
        print("LinuxCNC's rs274 is not installed (Debian package linuxcnc-uspace)")
        return None
    if given.show is not None:
        show(given.show)
        return None
    return given


def show(seed: int) -> None:
    """Print the program of a seed, and what both say."""
    one, files = made(seed)
    sys.stdout.write(one.text.decode("latin-1"))
    print(files, *(differs(seed) or ("agree",)), sep="\n")


def main() -> int:
    """Run a campaign as the command line has it, and return the exit code."""
    given = asked_for("mutated G-code programs against rs274", show)
    if given is None:
        return 0
    kinds: collections.Counter[str] = collections.Counter()
    for seed, (kind, details) in campaign(differs, given):
        kinds[kind] += 1
        print(f"seed {seed}: {kind}", *[details] * (kinds[kind] == 1), sep="\n", flush=True)
    print(f"{given.count} cases, {sum(kinds.values())} differ")
    for kind, times in kinds.most_common():
        print(f"{times} times {kind}")
    return 1 if kinds else 0


if __name__ == "__main__":
    sys.exit(main())
