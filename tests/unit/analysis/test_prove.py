"""The proof of a plan: its files, its figures, and a recording that stays bounded."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

import trochia
from trochia.analysis import prove as proving
from trochia.analysis.check import judge

if TYPE_CHECKING:
    from pathlib import Path

TEXT = b"G21 G90 M3 S100\nG1 X20 F1200\nG4 P0.5\nG1 Y10\nM2\n"


@pytest.fixture(scope="module")
def verdict():
    mill = trochia.load("reference-mill")
    return judge(trochia.plan(trochia.gcode(TEXT, mill), mill))


def test_files_and_figures(verdict, tmp_path: Path):
    told: list[tuple[str, float]] = []
    proof = proving.prove(verdict, TEXT, tmp_path / "out", progress=lambda step, done: told.append((step, done)))
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["path.png", "recording", "report.html"]
    figures = json.loads(json.dumps(proof.figures()))
    assert figures["dwell_s"] == 0.5
    assert figures["lost_steps"] == dict.fromkeys("XYZ", 0)
    assert set(figures["following_error"]["X"]) >= {"peak", "rms"}
    assert told[-1][0] == "simulating"
    assert told[-1][1] == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize(("most", "period"), [(10_000, 0.001), (1000, 0.003), (100, 0.022)])
def test_a_long_recording_takes_every_second_third_servo_period(
    verdict, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, most: int, period: float
):
    assert verdict.time_s == pytest.approx(2.14, abs=0.1)
    monkeypatch.setattr(proving, "MOST_SAMPLES", most)
    proof = proving.prove(verdict, TEXT, tmp_path)
    assert proof.recording.period == pytest.approx(period)
    assert len(proof.recording) <= most + 2


def test_the_period_asked_for_is_kept(verdict, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(proving, "MOST_SAMPLES", 10)
    assert proving.prove(verdict, TEXT, tmp_path, period=0.01).recording.period == 0.01
