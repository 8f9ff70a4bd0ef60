"""How an axis finds its reference after power-up, and the switches at its ends."""

from __future__ import annotations

from dataclasses import dataclass, field

from trochia.machine.codecs import Quantity, Text, Whole
from trochia.machine.schema import Bound, check_bounds, key

#: ways to find a reference, with what each needs
METHODS = {
    "switch": "the edge of a switch (`input`)",
    "switch-index": "the encoder's first index pulse beyond the edge of a switch (`input`)",
    "index": "the encoder's next index pulse",
    "limit": "the edge of the limit switch on that side",
    "absolute": "nothing: the encoder knows",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitSwitch:
    """A switch at one end of an axis: the input that opens or closes, and where on the axis it does [mm or degree]."""

    input: str = field(metadata=key(Text(), "name of its input under [io]"))
    at: float = field(metadata=key(Quantity("length", motion=True), "position at which it trips, from inside"))


@dataclass(frozen=True, slots=True, kw_only=True)
class Homing:
    """How one axis is homed: towards a switch at ``search``, off it by ``back_off``, onto it again at ``latch``.

    Attributes
    ----------
    method
        A name of :data:`METHODS`.
    towards
        ``-`` or ``+``: the direction of the search.
    input
        The home switch, by its name under [io].
    position
        What the axis reads at the reference [mm or degree]; None: the end of travel in that direction.
    search, latch
        Speeds [mm/s or degree/s]; None: a fifth of the axis' velocity, and a tenth of the search.
    back_off
        Way off the switch before it is sought slowly [mm or degree].
    rest
        Where the axis goes afterwards; None: it stays.
    order
        Lower orders first; axes of equal order together.  None: Z first (0), as it has to leave the work, then the
        others (1).
    second, square
        The home switch of a gantry's second joint, by its name under [io], and what that joint reads there less what
        the first reads at its own, when the gantry is square [mm or degree].
    """

    method: str = field(default="switch", metadata=key(Text(tuple(METHODS)), "what tells the reference"))
    towards: str = field(default="-", metadata=key(Text(("-", "+")), "direction of the search"))
    input: str | None = field(default=None, metadata=key(Text(), "name of the home switch under [io]"))
    position: float | None = field(
        default=None,
        metadata=key(Quantity("length", motion=True), "what the axis reads there; else the end of travel on that side"),
    )
    search: float | None = field(
        default=None,
        metadata=key(
            Quantity("velocity", motion=True), "speed of the search; else a fifth of the axis'", Bound.POSITIVE
        ),
    )
    latch: float | None = field(
        default=None,
        metadata=key(Quantity("velocity", motion=True), "speed of the second approach; else a tenth", Bound.POSITIVE),
    )
    back_off: float = field(
        default=2.0, metadata=key(Quantity("length", motion=True), "way off the switch in between", Bound.POSITIVE)
    )
    rest: float | None = field(
        default=None, metadata=key(Quantity("length", motion=True), "where the axis goes afterwards; else it stays")
    )
    order: int | None = field(
        default=None,
        metadata=key(
            Whole(), "lower ones first, axes of one order together; else Z is 0 and the others 1", Bound.NOT_NEGATIVE
        ),
    )
    second: str | None = field(default=None, metadata=key(Text(), "home switch of a gantry's second joint, under [io]"))
    square: float = field(
        default=0.0,
        metadata=key(
            Quantity("length", motion=True), "where the second joint trips it less where the first does its own"
        ),
    )

    def __post_init__(self) -> None:
        check_bounds(self)
