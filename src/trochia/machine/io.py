"""Spindle, beam, and digital or analogue channels."""

from __future__ import annotations

from dataclasses import dataclass, field

from trochia.errors import ConfigError
from trochia.machine.codecs import Flag, Number, Quantity, Text, Whole, shortest
from trochia.machine.joints import Encoder
from trochia.machine.schema import Bound, Record, check_bounds, key

#: what a channel does
CHANNELS = {
    "input": "a digital input",
    "latched": "an output that stays as it was set",
    "timed": "an output that goes back by itself after `duration`",
    "train": "an output that gives pulses at `frequency`",
    "analog-input": "a voltage read",
    "analog-output": "a voltage set",
}

#: electrical kind -> greatest current [A] (None: the machine file must say), and what it is
ELECTRICAL: dict[str, tuple[float | None, str]] = {
    "ttl": (0.016, "a standard TTL output sinks 16 mA at 5 V; more needs an open collector or a transistor"),
    "cmos": (0.004, "a CMOS gate gives a few mA"),
    "open-collector": (None, "a transistor to ground; the load brings its own supply"),
    "darlington": (None, "a Darlington transistor, as for a relay coil of 1 A"),
    "relay": (None, "a relay's contact"),
    "thyristor": (None, "a thyristor or triac for a mains load"),
    "opto": (None, "an opto-isolated 24 V input or output"),
    "analog": (0.005, "a voltage, some mA"),
}

BEAMS = ("shutter", "power")


@dataclass(frozen=True, slots=True, kw_only=True)
class Spindle:
    """A spindle: greatest speed [rpm], time from rest to full speed [s] (spin-up is in proportion)."""

    maximum: float = field(metadata=key(Quantity("rotation speed"), "greatest speed", Bound.POSITIVE))
    minimum: float = field(
        default=0.0, metadata=key(Quantity("rotation speed"), "least speed it holds", Bound.NOT_NEGATIVE)
    )
    spin_up: float = field(
        default=0.0, metadata=key(Quantity("time"), "from rest to full speed; in proportion below", Bound.NOT_NEGATIVE)
    )
    encoder: Encoder | None = field(default=None, metadata=key(Record(Encoder), "what measures its angle"))

    def __post_init__(self) -> None:
        check_bounds(self, path="spindle")
        if self.minimum > self.maximum:
            raise ConfigError(f'must not be above maximum ("{self.maximum:g} rpm"), not "{self.minimum:g} rpm"',
                              key="spindle.minimum")  # fmt: skip
        if self.encoder is not None and self.encoder.on_load:
            raise ConfigError("a spindle's encoder counts turns: leave on_load out", key="spindle.encoder.on_load")


@dataclass(frozen=True, slots=True, kw_only=True)
class Beam:
    """A laser or the like: ``kind`` shutter (on or off) or power; S at full power; switching delay [s]; rating [W]."""

    kind: str = field(metadata=key(Text(BEAMS), "shutter (on or off) or power (follows S)"))
    full_power: float = field(default=1.0, metadata=key(Number(), "the S that means full power", Bound.POSITIVE))
    delay: float = field(
        default=0.0, metadata=key(Quantity("time"), "from the command to the light", Bound.NOT_NEGATIVE)
    )
    rating: float | None = field(default=None, metadata=key(Quantity("power"), "optical power at full", Bound.POSITIVE))

    def __post_init__(self) -> None:
        check_bounds(self, path="beam")
        if self.kind not in BEAMS:
            raise ConfigError(f"expected one of {', '.join(BEAMS)}, not {self.kind!r}", key="beam.kind")


@dataclass(frozen=True, slots=True, kw_only=True)
class Channel:
    """One input or output; its electrical kind and current limit [A] are what it may be wired to.

    Attributes
    ----------
    kind
        A name of :data:`CHANNELS`.
    electrical
        A name of :data:`ELECTRICAL`.
    current, load
        What the channel can carry, and what is wired to it [A].
    duration, frequency
        Of a timed output [s], of a pulse train [1/s].
    delay
        From the signal to its effect, as of a valve [s].
    follows
        The input whose level an output has under the live controller.
    """

    name: str
    kind: str = field(metadata=key(Text(tuple(CHANNELS)), "what it does"))
    electrical: str | None = field(default=None, metadata=key(Text(tuple(ELECTRICAL)), "what it is electrically"))
    pin: int | None = field(default=None, metadata=key(Whole(), "pin of the port or board", Bound.NOT_NEGATIVE))
    inverted: bool = field(default=False, metadata=key(Flag(), "active when low, or a contact that opens"))
    current: float | None = field(
        default=None, metadata=key(Quantity("current"), "greatest current it carries", Bound.POSITIVE)
    )
    load: float | None = field(
        default=None, metadata=key(Quantity("current"), "current of what is wired to it", Bound.POSITIVE)
    )
    duration: float | None = field(
        default=None, metadata=key(Quantity("time"), "how long a timed output stays on", Bound.POSITIVE)
    )
    frequency: float | None = field(
        default=None, metadata=key(Quantity("frequency"), "of a pulse train", Bound.POSITIVE)
    )
    delay: float = field(
        default=0.0, metadata=key(Quantity("time"), "from the signal to its effect", Bound.NOT_NEGATIVE)
    )
    follows: str | None = field(default=None, metadata=key(Text(), "input whose level the output has"))

    def __post_init__(self) -> None:
        path = f"io.{self.name}"
        check_bounds(self, path=path)
        for name, owner in (("duration", "timed"), ("frequency", "train")):
            if (getattr(self, name) is not None) != (self.kind == owner):
                what = f"missing: a {owner} output needs it" if self.kind == owner else f"only a {owner} output has one"
                raise ConfigError(what, key=f"{path}.{name}")
        if self.follows is not None and self.kind != "latched":
            raise ConfigError("only a latched output follows an input", key=f"{path}.follows")
        self._check_current(path)

    @property
    def greatest_current(self) -> float | None:
        """What it can carry [A]: its own limit, else that of its electrical kind, else not known."""
        return self.current or (ELECTRICAL[self.electrical][0] if self.electrical else None)

    def _check_current(self, path: str) -> None:
        """Hold current to the electrical kind, load to current."""
        limit, what = ELECTRICAL[self.electrical] if self.electrical else (None, "")
        if self.current is not None and limit is not None and self.current > limit:
            raise ConfigError(f"a {self.electrical} channel carries {shortest(limit, 'current')} at most, "
                              f"not {shortest(self.current, 'current')}", key=f"{path}.current", hint=what)  # fmt: skip
        greatest = self.greatest_current
        if self.load is not None and (greatest is None or self.load > greatest):
            carries = "an unknown current (give `current`)" if greatest is None else shortest(greatest, "current")
            raise ConfigError(f"the channel carries {carries}, the load asks {shortest(self.load, 'current')}",
                              key=f"{path}.load", hint=what or None)  # fmt: skip
