"""What crosses a boundary: commands in, acknowledgements, status and faults out.  Pure data, no behaviour."""

from trochia.messages.codec import components, decode_command, decode_message, decode_told, encode, schema
from trochia.messages.command import Ack, AnyCommand, Command
from trochia.messages.fault import Cause, Fault
from trochia.messages.frames import Frame, FrameHead, pack, unpack
from trochia.messages.session import (
    AnyMessage,
    Credentials,
    Release,
    Role,
    Seen,
    SessionMessage,
    SessionStatus,
    ShowPath,
    Take,
    Told,
    Watch,
)
from trochia.messages.status import AxisStatus, OverrideStatus, ProgramStatus, Request, Status, SwitchStatus

__all__ = [
    "Ack",
    "AnyCommand",
    "AnyMessage",
    "AxisStatus",
    "Cause",
    "Command",
    "Credentials",
    "Fault",
    "Frame",
    "FrameHead",
    "OverrideStatus",
    "ProgramStatus",
    "Release",
    "Request",
    "Role",
    "Seen",
    "SessionMessage",
    "SessionStatus",
    "ShowPath",
    "Status",
    "SwitchStatus",
    "Take",
    "Told",
    "Watch",
    "components",
    "decode_command",
    "decode_message",
    "decode_told",
    "encode",
    "pack",
    "schema",
    "unpack",
]
