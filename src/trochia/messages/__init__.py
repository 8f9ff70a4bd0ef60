"""What crosses a boundary: commands in, acknowledgements, status and faults out.  Pure data, no behaviour."""

from trochia.messages.codec import decode_command, encode, schema
from trochia.messages.command import Ack, AnyCommand, Command
from trochia.messages.fault import Cause, Fault
from trochia.messages.status import AxisStatus, OverrideStatus, ProgramStatus, Request, Status, SwitchStatus

__all__ = [
    "Ack",
    "AnyCommand",
    "AxisStatus",
    "Cause",
    "Command",
    "Fault",
    "OverrideStatus",
    "ProgramStatus",
    "Request",
    "Status",
    "SwitchStatus",
    "decode_command",
    "encode",
    "schema",
]
