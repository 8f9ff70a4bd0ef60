"""LinuxCNC's stand-alone interpreter as a judge: what it prints, and where it stops."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import tempfile
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import pytest
from hypothesis import currently_in_test_context

from trochia.errors import ProgramError
from trochia.languages.gcode.canon import Canon
from trochia.languages.gcode.interpreter import interpret
from trochia.program import WorkState

RS274 = shutil.which("rs274")
TOLERANCE = 1.001e-4  # both round to four decimals
PRECISION = 1e-12  # of numbers beyond any machine, which powers and logarithms make
_COLUMNS = re.compile(r"^ *\d+ (?:N\.{5}|N\d+|N {5}) *(?=[A-Z])")  # counter and line number
_ASIDE = ("executing", "num_spindles")  # what it says beside the error
_ASKED = Counter[str]()  # programs compared, by where they come from
_NUMBER = re.compile(r"-?\d+\.\d+")


@dataclass(frozen=True)
class Run:
    """Canonical lines, and the text of the line that was rejected (None: accepted; empty: it does not say which)."""

    lines: list[str]
    rejected: str | None
    why: str


def reference(text: bytes, variables: str | None = None, tools: str | None = None, *, seconds: float = 20.0) -> Run:
    """Return what ``rs274 -g`` says.

    It rewrites its variable file and keeps its tools in a file in HOME, so it runs with a directory of its own as both.
    """
    assert RS274 is not None
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "program.ngc").write_bytes(text)
        extra: list[str] = []
        if variables is not None:
            Path(folder, "work.var").write_text(variables, encoding="ascii")
            extra = ["-v", "work.var"]
        if tools is not None:
            Path(folder, "tool.tbl").write_text(tools, encoding="ascii")
            extra += ["-t", "tool.tbl"]
        for _ in range(3):  # once in some thousand runs it dies without a word
            done = subprocess.run(
                [RS274, "-g", *extra, "program.ngc"],
                cwd=folder,
                env={**os.environ, "HOME": folder},
                capture_output=True,
                timeout=seconds,
                check=False,
            )
            said = [line for line in done.stderr.decode("latin-1").split("\n") if not line.startswith(_ASIDE)]
            if done.returncode == 0 or len(said) > 1:
                break
    lines = [_COLUMNS.sub("", line, count=1) for line in done.stdout.decode("latin-1").split("\n")[:-1]]
    rejected = said[1] if done.returncode else None
    if rejected is not None and rejected.strip().encode("latin-1") not in text:
        rejected = ""  # a line of its own making: the call of a lathe cycle, what M72 brings back
    return Run(lines, rejected, said[0])


def ours(text: bytes, *, fast: bool, work: WorkState) -> Run:
    """Return what our interpreter says."""
    out: list[bytes] = []
    rejected, why = None, ""
    try:
        interpret(text, Canon(out.append), name="program.ngc", fast=fast, work=work)
    except ProgramError as error:
        rejected, why = error.text or "", str(error)
    return Run(b"".join(out).decode("latin-1").split("\n")[:-1], rejected, why)


def alike(left: str, right: str) -> bool:
    """Return whether two canonical lines say the same, numbers within the tolerance."""
    if left == right:
        return True
    if _NUMBER.sub("#", left) != _NUMBER.sub("#", right):
        return False
    pairs = zip(_NUMBER.findall(left), _NUMBER.findall(right), strict=True)
    return all(abs(float(a) - float(b)) <= max(TOLERANCE, PRECISION * abs(float(a))) for a, b in pairs)


def compare(
    text: bytes, *, variables: str | None = None, tools: str | None = None, work: WorkState | None = None,
    seconds: float = 20.0,
) -> None:  # fmt: skip
    """Assert that we accept or reject a program as the reference does, at the same line, with the same output."""
    judge = reference(text, variables, tools, seconds=seconds)
    _ASKED["generated" if currently_in_test_context() else "written"] += 1
    _ASKED["accepted"] += judge.rejected is None
    for fast in (False, True):
        run = ours(text, fast=fast, work=work or WorkState())
        for number, (theirs, mine) in enumerate(zip(judge.lines, run.lines, strict=False)):
            assert alike(theirs, mine), f"fast={fast}, canonical line {number}: reference {theirs!r}, ours {mine!r}"
        assert (judge.rejected is None) == (run.rejected is None), f"reference: {judge.why!r}; ours: {run.why}"
        assert len(judge.lines) == len(run.lines), f"fast={fast}: {judge.lines[-3:]} against {run.lines[-3:]}"
        if judge.rejected is not None and run.rejected is not None and not _sought_in_vain(judge.why, run.why):
            # the reference cuts a line that is too long
            assert run.rejected.strip().startswith(judge.rejected.strip()), f"reference: {judge.why!r}; ours: {run.why}"


def _sought_in_vain(theirs: str, ours: str) -> bool:
    """Return whether a label was looked for up to the end: we name the line that asks for it, not the last one."""
    at_the_end = theirs.startswith(("EOF in file", "File ended with no", "Failed to find sub"))
    return at_the_end and ("has no end" in ours or "there is no subroutine" in ours)


@pytest.fixture(scope="session")
def agree(request):
    """Return :func:`compare`, or skip where the reference is not installed; the session tells how many were asked."""
    if RS274 is None:
        pytest.skip("LinuxCNC's rs274 is not installed (Debian package linuxcnc-uspace)")
    request.config.compared_with_rs274 = _ASKED
    return compare


@pytest.fixture(scope="session")
def agree_or_hang(agree):
    """Return :func:`compare` for what the reference may never come to the end of; then only ours must."""

    def check(text: bytes) -> None:
        try:
            agree(text, seconds=1.0)
        except subprocess.TimeoutExpired:
            ours(text, fast=True, work=WorkState())

    return check
