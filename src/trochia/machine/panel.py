"""The inputs of a machine that guard people, and what follows from them."""

from __future__ import annotations

from dataclasses import dataclass, field

from trochia.machine.codecs import Quantity, Text
from trochia.machine.schema import Bound, check_bounds, key


@dataclass(frozen=True, slots=True, kw_only=True)
class Panel:
    """Inputs that guard people, and what follows from them.

    Attributes
    ----------
    door
        Active while it is open: a program is held, and goes on only when it is closed and somebody resumes.
    interlock
        Active while it is broken: motion brakes and is given up.
    arm
        Active while the beam may be lit.
    estop
        Active while the button is pressed.
    retract
        Way that Z goes up, where there is room, when the door or the key holds a job [mm].
    idle_release
        Drives go off when nothing was asked for so long [s].
    """

    door: str | None = field(default=None, metadata=key(Text(), "input that is active while the door is open"))
    interlock: str | None = field(default=None, metadata=key(Text(), "input that is active while it is broken"))
    arm: str | None = field(default=None, metadata=key(Text(), "input that is active while the beam may be lit"))
    estop: str | None = field(default=None, metadata=key(Text(), "input that is active while the button is pressed"))
    retract: float | None = field(
        default=None, metadata=key(Quantity("length"), "way Z goes up when the door or the key holds", Bound.POSITIVE)
    )
    idle_release: float | None = field(
        default=None, metadata=key(Quantity("time"), "drives go off when nothing was asked for so long", Bound.POSITIVE)
    )

    def __post_init__(self) -> None:
        check_bounds(self, path="panel")

    @property
    def inputs(self) -> dict[str, str]:
        """The inputs it names, by key."""
        named = {"door": self.door, "interlock": self.interlock, "arm": self.arm, "estop": self.estop}
        return {at: name for at, name in named.items() if name is not None}
