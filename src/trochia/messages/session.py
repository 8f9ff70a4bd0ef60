"""What people and programs at a distance say beside commands, and what they are told.

On a socket every message is one JSON object.  To the machine: a command, or one of the records here, told apart by
``kind``.  From it: a :class:`Told`, with one of its fields.
"""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from trochia.messages.command import Ack, AnyCommand
from trochia.messages.status import Status  # noqa: TC001 - msgspec reads the types at run time

Role = Literal["operator", "viewer"]
Name = Annotated[str, Meta(min_length=1, max_length=64, pattern=r"^[\w.@-]+$")]
MOST_POINTS = 1_000_000  #: of a path that is shown


class Credentials(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Who wants to come in."""

    user: Annotated[str, Meta(max_length=64)]
    password: Annotated[str, Meta(max_length=256)]


class Asked(msgspec.Struct, frozen=True, kw_only=True, tag_field="kind", forbid_unknown_fields=True):
    """Something asked of the server, not of the machine; ``id`` comes back in its answer."""

    id: int = 0


class Take(Asked, frozen=True, kw_only=True, tag="take"):
    """Become the one who may move the machine; ``over`` takes that from whoever has it."""

    over: bool = False


class Release(Asked, frozen=True, kw_only=True, tag="release"):
    """Be no longer the one who may move the machine."""


class ShowPath(Asked, frozen=True, kw_only=True, tag="path"):
    """Send the path of the loaded program as a binary frame, in at most so many points."""

    points: Annotated[int, Meta(ge=2, le=MOST_POINTS)] = 200_000


class Watch(Asked, frozen=True, kw_only=True, tag="watch"):
    """Send samples of every turn of the controller as binary frames, or stop sending them."""

    samples: bool


class Seen(msgspec.Struct, frozen=True, kw_only=True, tag_field="kind", tag="seen", forbid_unknown_fields=True):
    """The status of this sequence number has arrived: makes room for newer ones, and says that the sender is awake."""

    sequence: Annotated[int, Meta(ge=0)]


SessionMessage = Take | Release | ShowPath | Watch | Seen
AnyMessage = AnyCommand | SessionMessage


class SessionStatus(msgspec.Struct, frozen=True, kw_only=True):
    """Who one is to the machine.

    Attributes
    ----------
    control
        Whether this session may move the machine.
    holder
        Name of the user who may; empty: nobody.
    """

    user: str
    role: Role
    control: bool = False
    holder: str = ""


class Told(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """One message from the machine: a status, the answer to a command, or who one is; the others are None."""

    status: Status | None = None
    ack: Ack | None = None
    session: SessionStatus | None = None
