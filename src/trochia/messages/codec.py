"""Messages as bytes.  In: JSON from anyone.  Out: checked records, or a sentence about what is wrong with it."""

from __future__ import annotations

from typing import Any

import msgspec

from trochia.errors import RemoteProtocolError
from trochia.messages.command import Ack, AnyCommand
from trochia.messages.status import Status

MOST_BYTES = 64 << 20  #: of one command: a program of a million lines has some 30 MB

_DECODER = msgspec.json.Decoder(AnyCommand)
_ENCODER = msgspec.json.Encoder()


def decode_command(data: bytes | str, *, most: int = MOST_BYTES) -> AnyCommand:
    """Return the command of a JSON text.

    Raises
    ------
    RemoteProtocolError
        When it is too long, no JSON, of no known kind, or has a field of the wrong type or out of its bounds.
    """
    if len(data) > most:
        raise RemoteProtocolError(f"a command has at most {most} bytes, not {len(data)}")
    try:
        return _DECODER.decode(data)
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise RemoteProtocolError(f"not a command: {error}") from None


def encode(message: Status | Ack | AnyCommand) -> bytes:
    """Return a message as JSON."""
    return _ENCODER.encode(message)


def schema() -> dict[str, Any]:
    """Return the JSON schemas of commands, answers and status: ``{"$defs": {name: schema}}``."""
    _, components = msgspec.json.schema_components([AnyCommand, Ack, Status], ref_template="#/$defs/{name}")
    return {"$defs": components}
