"""Messages as JSON: what is well formed comes back the same, everything else is refused in one sentence."""

from __future__ import annotations

import json

import msgspec
import pytest

from trochia import messages
from trochia.errors import RemoteProtocolError
from trochia.messages import command


@pytest.mark.parametrize("kind", [*command.Command.__subclasses__()], ids=lambda kind: kind.__name__)
def test_every_command_is_told_apart_by_its_kind(kind: type[command.Command]) -> None:
    given = {
        "Load": {"name": "a.ngc", "text": "M2"}, "RunFrom": {"line": 3}, "Mdi": {"text": "G0 X1"},
        "Jog": {"axis": "X", "speed": -2.0}, "JogBy": {"way": {"X": 1.0}}, "JogTo": {"position": {"Z": 0.0}},
        "WorkZero": {"axes": {"X": 0.0}}, "SetOutput": {"name": "lamp", "value": 1.0}, "ArmBeam": {"on": True},
        "SetInput": {"name": "door", "value": 1.0}, "Reverse": {"way": 4.0},
        "Answer": {"request": 4},
    }.get(kind.__name__, {})  # fmt: skip
    sent = kind(id=7, **given)
    back = messages.decode_command(messages.encode(sent))
    assert back == sent
    assert type(back) is kind


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (b"", "truncated"),
        (b"{}", "kind"),
        (b'{"kind": "dance"}', "dance"),
        (b'{"kind": "jog", "axis": "Q", "speed": 1}', "axis"),
        (b'{"kind": "jog", "axis": "X", "speed": "fast"}', "speed"),
        (b'{"kind": "jog", "axis": "X", "speed": 1, "lease": 60}', "lease"),
        (b'{"kind": "override", "feed": 2.5}', "feed"),
        (b'{"kind": "hold", "why": "because"}', "why"),
        (b'{"kind": "jog", "axis": "X", "speed": NaN}', "malformed"),
        (b"\xff\xfe", "not a command"),
    ],
)
def test_what_is_no_command_is_refused_and_says_why(text: bytes, why: str) -> None:
    with pytest.raises(RemoteProtocolError) as refused:
        messages.decode_command(text)
    assert why in str(refused.value)


def test_a_command_beyond_the_bound_is_refused_before_it_is_read() -> None:
    with pytest.raises(RemoteProtocolError, match="at most 10 bytes"):
        messages.decode_command(b'{"kind": "hold"}', most=10)


def test_the_schema_has_every_command_and_the_status() -> None:
    definitions = messages.schema()["$defs"]
    names = {kind.__name__ for kind in command.Command.__subclasses__()}
    assert names | {"Status", "Ack", "Fault"} <= set(definitions)
    json.dumps(definitions)  # plain data


def test_a_status_is_immutable() -> None:
    status = messages.Status(sequence=1, time=0.0, state="idle", machine="m", axes=(), legal=())
    with pytest.raises(AttributeError):
        status.state = "running"  # type: ignore[misc]
    assert msgspec.json.decode(messages.encode(status), type=messages.Status) == status
