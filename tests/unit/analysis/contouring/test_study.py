"""A recording studied: turns, repeatability, resolution, spectra and circle against what was put into it."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np
import pytest
from click.testing import CliRunner

from trochia.analysis.contouring import study, turns
from trochia.analysis.contouring.page import study_rows
from trochia.cli import replay
from trochia.errors import LimitError
from trochia.recorder import Channel, Header, Recording, gather, save

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

PERIOD = 1e-3


def recording(**columns: NDArray[np.float64]) -> Recording:
    names = {name.replace("__", "."): values for name, values in columns.items()}
    channels = tuple(Channel(name=name, unit="A" if name.endswith("current") else "mm") for name in names)
    header = Header(period=PERIOD, duration=(len(next(iter(names.values()))) - 1) * PERIOD, machine="bench", program="",
                    origin="test", channels=channels)  # fmt: skip
    return gather(header, iter([names]))


def to_and_fro(times: int = 4, speed: float = 20.0, rest: int = 200) -> NDArray[np.float64]:
    """Return a command to 10 mm and back, with rests."""
    up = np.arange(1, 501) / 500 * 0.5 * speed
    parts = [np.zeros(rest)]
    for _ in range(times):
        parts += [up, np.full(rest, up[-1]), up[::-1] - up[0], np.zeros(rest)]
    return np.concatenate(parts)


def test_backlash_is_a_spike_of_its_width_at_every_turn() -> None:
    told = to_and_fro()
    way = np.sign(np.diff(told, prepend=told[0]))
    held = way.copy()  # the way it last went
    for i in range(1, len(held)):
        held[i] = held[i] or held[i - 1]
    found = turns(recording(X__commanded=told, X__actual=told - 0.5 * 0.02 * held), "X")
    assert len(found) == 7  # eight ways, the first of which turns nothing
    assert [round(turn.height, 6) for turn in found] == [0.02, -0.02] * 3 + [0.02]
    assert found[0].time == pytest.approx(0.9, abs=2e-3)
    assert found[0].line is None


def test_repeatability_reversal_and_resolution_are_what_was_put_in() -> None:
    told = to_and_fro(times=50, speed=20.0, rest=80)
    rng = np.random.default_rng(8)
    moved = np.concatenate([[0], np.cumsum(np.diff(told) != 0)])
    scatter = np.zeros(len(told))
    drawn: dict[tuple[bool, int], float] = {}
    for i in range(len(told)):
        key = (i > 0 and told[i] == told[i - 1], int(moved[i]))
        if key[0]:
            scatter[i] = drawn.setdefault(key, float(rng.normal(0.0, 2e-3)))
    actual = told + scatter
    found = study(recording(X__commanded=told, X__actual=actual, joint__X__measured=np.round(actual / 1e-4) * 1e-4))
    axis = found.axes["X"]
    assert axis.spread == pytest.approx(3 * 2e-3, rel=0.35)  # the greater of two places
    assert axis.resolution == pytest.approx(1e-4, rel=1e-6)
    assert axis.reversal is None  # neither place is reached from both sides
    assert found.circle is None
    assert {name for name, _ in study_rows(found)} >= {"X repeatability", "X resolution", "contour error"}


def test_a_ripple_shows_at_its_frequency_with_its_amplitude() -> None:
    t = PERIOD * np.arange(8000)
    told = 2.0 * t
    found = study(recording(X__commanded=told, X__actual=told + 5e-3 * np.sin(2 * np.pi * 25.0 * t)))
    (frequency, amplitude), *_ = found.axes["X"].spectrum.peaks(1)  # type: ignore[union-attr]
    assert frequency == pytest.approx(25.0)
    assert amplitude == pytest.approx(5e-3, rel=1e-3)
    assert found.axes["X"].turns == ()
    assert found.axes["X"].resolution is None


def test_a_circle_is_told_with_the_rest_and_drawn(tmp_path: Path) -> None:
    angle = np.concatenate([np.zeros(60), np.linspace(0.0, 3 * np.pi, 3000), np.full(60, 3 * np.pi)])
    x, y = 10 * np.cos(angle), 10 * np.sin(angle)
    one = recording(X__commanded=x, Y__commanded=y, X__actual=0.999 * x, Y__actual=0.999 * y, joint__X__current=0.1 * x)
    found = study(one)
    assert found.circle is not None
    assert found.circle.radial_deviation == pytest.approx((-0.01, -0.01), abs=1e-6)
    assert len(found.axes["X"].turns) == 2
    save(tmp_path / "run", one)
    page = tmp_path / "study.html"
    words = [str(tmp_path / "run"), "--contouring", "-o", str(page), "--json"]
    told = json.loads(CliRunner().invoke(replay.command, words, catch_exceptions=False).output)
    assert told["circle"]["radial_deviation_mm"] == pytest.approx([-0.01, -0.01], abs=1e-6)
    assert told["axes"]["Y"]["reversals"] == 3
    assert told["files"] == [str(page)]
    text = page.read_text()
    assert text.count("<svg") == 1
    assert "radial deviation F" in text
    assert "circular deviation G" in CliRunner().invoke(replay.command, words[:2], catch_exceptions=False).output


def test_what_cannot_be_studied_is_named(tmp_path: Path) -> None:
    with pytest.raises(LimitError, match="no axis in this recording"):
        study(recording(X__commanded=np.zeros(100)))
    save(tmp_path / "run", recording(X__commanded=np.zeros(20), X__actual=np.zeros(20)))
    run = str(tmp_path / "run")
    result = CliRunner().invoke(replay.command, [run, run, "--contouring"])
    assert result.exit_code == 2
    assert "of one recording" in result.output
