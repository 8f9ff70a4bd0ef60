"""A host that dies or freezes: a sample of the campaign of ``make soak``, and whether it finds what it looks for."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator

SOAK = Path(__file__).parents[1] / "soak"
KILLED = 20  #: a case in which the host is killed with much of the motion still to come


@pytest.fixture
def campaign(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(SOAK))
    import dead_hosts  # noqa: PLC0415 - it lies beside the other campaigns

    return dead_hosts


@pytest.fixture
def chip(campaign: Any, chip_program: Path, board_image: Any) -> Iterator[tuple[Path, Path]]:
    assert board_image(campaign.built.__globals__["IMAGE"]).exists()
    assert chip_program.exists()
    with tempfile.TemporaryDirectory() as folder:
        yield campaign.built(Path(folder), image=True)


def test_a_sample_stops_under_control(campaign: Any, chip: tuple[Path, Path]):
    ends = [campaign.case(seed, chip) for seed in (6, 7, 25, KILLED)]
    assert any("silence, the beam was on" in end for end in ends)


def test_a_beam_that_stays_on_a_rate_that_falls_too_fast_and_a_wrong_place_are_found(
    campaign: Any, chip: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
):
    controlled, next_host = campaign.controlled, campaign.next_host

    def within(slew: float) -> Any:
        def judged(host: Any) -> None:
            with monkeypatch.context() as patch:
                patch.setattr(campaign, "SLEW", slew)
                controlled(host)

        return judged

    def wrong(host: Any) -> Any:
        status = next_host(host).copy()
        status["position"][0] += 1
        return status

    for name, instead, words in (
        ("BEAM", 0x24, "the beam is on after"),
        ("slowed", lambda *_: 700, "while steps fell back"),
        ("controlled", within(2.0), "the rate falls by"),
        ("next_host", wrong, "told"),
    ):
        with monkeypatch.context() as patch:
            patch.setattr(campaign, name, instead)
            with pytest.raises(AssertionError, match=words):
                campaign.case(KILLED, chip)
