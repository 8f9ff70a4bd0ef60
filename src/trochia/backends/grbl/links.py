"""The states of a connection to a GRBL board, and the one table of how it gets from one to another."""

from __future__ import annotations

from enum import Enum


class Link(Enum):
    """How far the connection is."""

    CONNECTING = "connecting"  # nothing understood yet
    ASKING = "asking"  # settings are being read
    READY = "ready"  # lines are sent as there is room
    STOPPING = "stopping"  # held, to be reset at rest
    RESETTING = "resetting"  # reset, its welcome is waited for
    LOST = "lost"


class Seen(Enum):
    """What makes it change."""

    WELCOME = "welcome"  # the board says that it has started
    STATUS = "status"  # it answers as GRBL does
    ANSWERED = "answered"  # all questions have been
    STOP = "stop"  # a fault, or someone gives up
    STILL = "still"  # held, or no motion at all
    RESET = "reset"  # a reset is asked for
    CUT = "cut"  # port closed, silence, or another language
    AGAIN = "again"  # someone connects anew


TABLE: dict[tuple[Link, Seen], Link] = {
    **{(link, Seen.CUT): Link.LOST for link in Link},
    (Link.LOST, Seen.AGAIN): Link.CONNECTING,
    (Link.CONNECTING, Seen.WELCOME): Link.ASKING,
    (Link.CONNECTING, Seen.STATUS): Link.ASKING,
    (Link.ASKING, Seen.WELCOME): Link.ASKING,
    (Link.ASKING, Seen.ANSWERED): Link.READY,
    (Link.READY, Seen.WELCOME): Link.ASKING,  # it restarted by itself
    (Link.READY, Seen.STOP): Link.STOPPING,
    (Link.READY, Seen.RESET): Link.RESETTING,
    (Link.STOPPING, Seen.STILL): Link.RESETTING,
    (Link.STOPPING, Seen.RESET): Link.RESETTING,
    (Link.STOPPING, Seen.WELCOME): Link.READY,
    (Link.RESETTING, Seen.WELCOME): Link.READY,
}
