"""Messages as bytes.  In: JSON from anyone.  Out: checked records, or a sentence about what is wrong with it."""

from __future__ import annotations

from typing import Any

import msgspec

from trochia.errors import RemoteProtocolError
from trochia.messages.command import Ack, AnyCommand
from trochia.messages.frames import FrameHead
from trochia.messages.session import AnyMessage, Credentials, SessionMessage, SessionStatus, Told
from trochia.messages.status import Status

MOST_BYTES = 64 << 20  #: of one command: a program of a million lines has some 30 MB

_DECODER = msgspec.json.Decoder(AnyCommand)
_MESSAGE = msgspec.json.Decoder(AnyMessage)
_TOLD = msgspec.json.Decoder(Told)
_ENCODER = msgspec.json.Encoder()


def decode_command(data: bytes | str, *, most: int = MOST_BYTES) -> AnyCommand:
    """Return the command of a JSON text.

    Raises
    ------
    RemoteProtocolError
        When it is too long, no JSON, of no known kind, or has a field of the wrong type or out of its bounds.
    """
    return _decoded(_DECODER, data, most, "command")


def decode_message(data: bytes | str, *, most: int = MOST_BYTES) -> AnyMessage:
    """Return what somebody says on a socket: a command, or another message; errors as of :func:`decode_command`."""
    return _decoded(_MESSAGE, data, most, "message")


def decode_told(data: bytes | str) -> Told:
    """Return what the machine says on a socket; errors as of :func:`decode_command`."""
    return _decoded(_TOLD, data, MOST_BYTES, "message of a machine")


def _decoded(decoder: msgspec.json.Decoder[Any], data: bytes | str, most: int, what: str) -> Any:  # noqa: ANN401
    """Return what a decoder makes of a text."""
    if len(data) > most:
        raise RemoteProtocolError(f"a {what} has at most {most} bytes, not {len(data)}")
    try:
        return decoder.decode(data)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise RemoteProtocolError(f"not a {what}: {error}") from None


def encode(message: Status | Ack | AnyCommand | SessionMessage | SessionStatus | Credentials | Told) -> bytes:
    """Return a message as JSON."""
    return _ENCODER.encode(message)


def schema() -> dict[str, Any]:
    """Return the JSON schemas of commands, answers, status and what sessions say: ``{"$defs": {name: schema}}``."""
    return {"$defs": components("#/$defs/{name}")}


def components(template: str) -> dict[str, Any]:
    """Return the schemas by name, referring to each other as ``template`` says."""
    types = [AnyCommand, Ack, Status, SessionMessage, SessionStatus, Credentials, Told, FrameHead]
    return msgspec.json.schema_components(types, ref_template=template)[1]
