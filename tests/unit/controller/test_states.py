"""The table of transitions: what must hold whatever rows are added."""

from __future__ import annotations

from pathlib import Path

import pytest

from trochia.controller.states import MOVING, TABLE, Event, State, legal
from trochia.messages.command import Command

KINDS = {kind.__struct_config__.tag for kind in Command.__subclasses__()}


def test_every_command_is_legal_somewhere_and_every_row_is_a_command_or_an_event() -> None:
    named = {event for _, event in TABLE if isinstance(event, str)}
    assert named == KINDS


@pytest.mark.parametrize("state", list(State))
def test_the_emergency_stop_is_taken_in_every_state(state: State) -> None:
    assert TABLE[state, "estop"] is State.ESTOP
    assert "estop" in legal(state)


@pytest.mark.parametrize("state", sorted(MOVING, key=str))
def test_all_motion_can_be_given_up_and_ends(state: State) -> None:
    assert state is State.STOPPING or TABLE[state, "abort"] is State.STOPPING
    assert any((state, event) in TABLE for event in (Event.STILL, Event.CONTACT))


@pytest.mark.parametrize("state", [State.OFF, State.ESTOP, State.ALARM])
def test_nothing_moves_without_power_or_with_a_fault(state: State) -> None:
    assert not {target for (at, event), target in TABLE.items() if at is state and isinstance(event, str)} & MOVING


def test_every_state_can_be_reached_from_power_on() -> None:
    seen = {State.OFF}
    while True:
        more = {target for (at, _), target in TABLE.items() if at in seen} - seen
        if not more:
            break
        seen |= more
    assert seen == set(State)


def test_from_every_state_there_is_a_way_to_idle() -> None:
    for state in State:
        seen = {state}
        for _ in State:
            seen |= {target for (at, _), target in TABLE.items() if at in seen}
        assert State.IDLE in seen


def test_the_picture_in_the_documentation_is_that_of_the_table() -> None:
    page = (Path(__file__).parents[3] / "docs" / "explanation" / "controller.md").read_text()
    drawn = page.split("<!-- states: begin -->\n")[1].split("<!-- states: end -->")[0]
    assert drawn == picture(), "write picture() into the page"


def picture() -> str:
    """Return the table as a page shows it: a row a state, what leads from it where."""
    common = {"estop", "abort", Event.FAULT}
    rows = ["| in | comes | to |", "|---|---|---|"]
    for state in State:
        found: dict[State, list[str]] = {}
        for (at, event), target in TABLE.items():
            if at is state and event not in common and (target is not state or event == "jog"):
                found.setdefault(target, []).append(event if isinstance(event, str) else f"*{event.value.lower()}*")
        rows += [f"| `{state.value}` | {', '.join(sorted(what))} | `{to.value}` |" for to, what in found.items()]
    return "\n".join(rows) + "\n"
