"""The report of servos that were physics shows the current of each motor."""

from __future__ import annotations

import base64
from typing import TYPE_CHECKING

import numpy as np
import pytest

from trochia import api
from trochia.analysis.check import judge
from trochia.analysis.compose import report_data
from trochia.analysis.prove import prove
from trochia.analysis.report.payload import payload
from trochia.program.source import SourceText
from trochia.recorder import read

if TYPE_CHECKING:
    from pathlib import Path

JOB = b"G21 G90 G94\nF900\nG1 X5\nG1 X0\nM2\n"


@pytest.mark.parametrize(("machine", "names"), [("xy-table", ["X", "Y"]), ("reference-mill", None)])
def test_currents_are_those_of_the_recording(machine: str, names: list[str] | None, tmp_path: Path) -> None:
    loaded = api.load(machine)
    verdict = judge(api.plan(api.gcode(JOB, loaded), loaded))
    prove(verdict, JOB, tmp_path)
    assert verdict.plan is not None
    recording = read(tmp_path / "recording")
    shown = payload(report_data(verdict, verdict.plan, recording, SourceText(JOB)))["channels"]["current"]
    if names is None:
        assert shown is None
        return
    assert [one["name"] for one in shown] == names
    values = np.frombuffer(base64.b64decode(shown[0]["values"]["data"]), "<f4")
    assert values.max() == pytest.approx(recording["joint.X.current"][:].max(), rel=1e-6)
