"""Joints: the motors behind the axes, with transmission, encoder and backlash.

The crossing from axis space to tick space: ``steps_per_unit`` and ``counts_per_unit`` are exact fractions.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

from trochia.errors import ConfigError
from trochia.machine.codecs import Quantity, Text, Whole
from trochia.machine.compensation import Compensation
from trochia.machine.drivers import DRIVERS, Driver, fed
from trochia.machine.encoders import Encoder
from trochia.machine.error_table import ErrorTable, TableOfErrors
from trochia.machine.loads import JointLoad
from trochia.machine.motors.catalogue import CatalogueStepper
from trochia.machine.motors.library import motor as library_motor
from trochia.machine.motors.wiring import WIRINGS, wired
from trochia.machine.schema import Bound, Record, Variant, check_bounds, key
from trochia.machine.servos import LOOPS, SERVO_MOTORS, DriveTrain, ServoAmplifier, ServoLoop
from trochia.machine.transmissions import TRANSMISSIONS

if TYPE_CHECKING:
    from fractions import Fraction

    from trochia.machine.drivers import Fed
    from trochia.machine.motors.hybrid import HybridStepper
    from trochia.machine.servos import CatalogueDc, CataloguePmsm
    from trochia.machine.transmissions import Transmission

_MODEL = key(Text(), "maker's name for it, for people")


@dataclass(frozen=True, slots=True, kw_only=True)
class Stepper:
    """A stepper with its driver: full steps a turn, micro-steps a step."""

    kind: ClassVar[str] = "stepper"

    full_steps: int = field(default=200, metadata=key(Whole(), "full steps a turn (1.8 degrees: 200)", Bound.POSITIVE))
    microsteps: int = field(
        default=1, metadata=key(Whole(), "pulses a full step, as set at the driver", Bound.POSITIVE)
    )
    model: str | None = field(default=None, metadata=_MODEL)
    library: str | None = field(default=None, metadata=key(Text(), "a motor of Trochia's library: gives it a torque"))
    catalogue: CatalogueStepper | None = field(
        default=None, metadata=key(Record(CatalogueStepper), "a motor written out here, in place of one of the library")
    )
    wiring: str | None = field(
        default=None, metadata=key(Text(WIRINGS), "of half windings, where the catalogue's row is for one half")
    )

    def __post_init__(self) -> None:
        check_bounds(self)
        parameters = self.parameters
        if parameters is not None and parameters.full_steps != self.full_steps:
            raise ConfigError(f"must be {parameters.full_steps}, those of the motor, not {self.full_steps}",
                              key="full_steps")  # fmt: skip

    @property
    def parameters(self) -> HybridStepper | None:
        """What the equations need of the motor, or None where the file does not say which it is."""
        if self.library is not None and self.catalogue is not None:
            raise ConfigError("give the motor by library or by catalogue, not by both", key="library")
        try:
            row = self.catalogue if self.library is None else library_motor(self.library)
        except ConfigError as error:
            raise ConfigError(error.plain, key="library", hint=error.hint) from None
        return None if row is None else wired(row.parameters(), self.wiring)

    @property
    def steps_per_turn(self) -> int:
        """Pulses a turn."""
        return self.full_steps * self.microsteps


@dataclass(frozen=True, slots=True, kw_only=True)
class Servo:
    """A servo motor; the joint's amplifier, train and loop close its loop."""

    kind: ClassVar[str] = "servo"

    model: str | None = field(default=None, metadata=_MODEL)
    catalogue: CatalogueDc | CataloguePmsm | None = field(
        default=None, metadata=key(Variant(SERVO_MOTORS), "the motor's numbers, for its physics")
    )


Motor = Stepper | Servo
MOTORS: dict[str, type[Motor]] = {cls.kind: cls for cls in (Stepper, Servo)}


@dataclass(frozen=True, slots=True, kw_only=True)
class PulseTiming:
    """What a driver's step and direction inputs ask: step high, step low, direction before and after a step [s]."""

    length: float = field(default=1e-6, metadata=key(Quantity("time"), "step input active", Bound.POSITIVE))
    space: float = field(
        default=1e-6, metadata=key(Quantity("time"), "step input at rest between steps", Bound.POSITIVE)
    )
    setup: float = field(
        default=1e-6, metadata=key(Quantity("time"), "direction stable before a step", Bound.NOT_NEGATIVE)
    )
    hold: float = field(
        default=1e-6, metadata=key(Quantity("time"), "direction stable after a step", Bound.NOT_NEGATIVE)
    )

    def __post_init__(self) -> None:
        check_bounds(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class Joint:
    """One motor and what it drives.

    Attributes
    ----------
    backlash
        Lost motion on reversal [mm or degree].
    screw_error, compensation
        What the twin's joint errs by place, and what is corrected of backlash and screw.
    velocity, acceleration, jerk
        Limits of the joint itself, beside those of the axes [mm/s, mm/s², mm/s³, or degrees].
    following_error, following_warning
        Lag behind the command that stops the machine, and that is told only [mm or degree].
    pulse_rate
        Greatest step rate of its driver [1/s].
    """

    name: str
    motor: Motor = field(metadata=key(Variant(MOTORS), "the motor and its driver"))
    transmission: Transmission = field(metadata=key(Variant(TRANSMISSIONS), "from a turn of the motor to travel"))
    encoder: Encoder | None = field(default=None, metadata=key(Record(Encoder), "what measures the position"))
    backlash: float = field(
        default=0.0, metadata=key(Quantity("length", motion=True), "lost motion on reversal", Bound.NOT_NEGATIVE)
    )
    screw_error: ErrorTable | None = field(
        default=None,
        metadata=key(TableOfErrors(), "how far beyond where it should be the load is, by place: what the twin has"),
    )
    compensation: Compensation | None = field(
        default=None, metadata=key(Record(Compensation), "what is corrected of backlash and screw")
    )
    velocity: float | None = field(
        default=None, metadata=key(Quantity("velocity", motion=True), "limit of the joint itself", Bound.POSITIVE)
    )
    acceleration: float | None = field(
        default=None, metadata=key(Quantity("acceleration", motion=True), "limit of the joint itself", Bound.POSITIVE)
    )
    jerk: float | None = field(
        default=None, metadata=key(Quantity("jerk", motion=True), "limit of the joint itself", Bound.POSITIVE)
    )
    following_error: float | None = field(
        default=None,
        metadata=key(Quantity("length", motion=True), "lag behind its command at which it is stopped", Bound.POSITIVE),
    )
    following_warning: float | None = field(
        default=None, metadata=key(Quantity("length", motion=True), "lag that is told", Bound.POSITIVE)
    )
    pulse_rate: float | None = field(
        default=None, metadata=key(Quantity("frequency"), "greatest step rate of the driver", Bound.POSITIVE)
    )
    pulses: PulseTiming = field(
        default=PulseTiming(), metadata=key(Record(PulseTiming), "what the driver's inputs ask for")
    )
    driver: Driver | None = field(
        default=None, metadata=key(Variant(DRIVERS), "what feeds the motor's phases; without it a stepper is ideal")
    )
    load: JointLoad = field(
        default=JointLoad(), metadata=key(Record(JointLoad), "what the motor has to move, for its torque")
    )
    amplifier: ServoAmplifier | None = field(
        default=None, metadata=key(Record(ServoAmplifier), "what feeds a servo's motor")
    )
    train: DriveTrain = field(
        default=DriveTrain(), metadata=key(Record(DriveTrain), "what is between a servo's motor and its load")
    )
    loop: ServoLoop | None = field(
        default=None, metadata=key(Variant(LOOPS), "what closes a servo's loop; without it a servo is ideal")
    )

    def __post_init__(self) -> None:
        check_bounds(self, path=f"joints.{self.name}")
        self._check_servo()
        try:
            _ = self.fed
        except ConfigError as error:
            raise ConfigError(error.plain, key=f"joints.{self.name}.{error.key}", hint=error.hint) from None

    def _check_servo(self) -> None:
        """Refuse a loop without what it closes, and one that counts without an encoder."""
        servo = isinstance(self.motor, Servo)
        for name in ("amplifier", "loop"):
            if getattr(self, name) is not None and not (isinstance(self.motor, Servo) and self.motor.catalogue):
                raise ConfigError("needs a servo whose catalogue says what it is", key=f"joints.{self.name}.{name}",
                                  hint='Like motor = { kind = "servo", catalogue = { kind = "dc", … } }.')  # fmt: skip
        if self.loop is not None and self.amplifier is None:
            raise ConfigError("needs the amplifier that it commands", key=f"joints.{self.name}.loop")
        speed = self.amplifier is not None and self.amplifier.mode == "speed"
        if speed and self.loop is not None and self.loop.kind == "cascade":
            raise ConfigError("closes the speed, and so does the amplifier in mode speed",
                              key=f"joints.{self.name}.loop", hint='Take kind = "pid" or "pmac".')  # fmt: skip
        if self.train.stiffness is not None and not self.load.mass > 0:
            raise ConfigError("needs a load behind it: give load.mass", key=f"joints.{self.name}.train.stiffness")
        if self.closed and self.backlash and self.train.stiffness is None and self.encoder and self.encoder.on_load:
            raise ConfigError("a loop that reads the load through backlash needs the stiffness it closes on",
                              key=f"joints.{self.name}.train.stiffness")  # fmt: skip
        if servo and self.loop is not None and self.loop.kind in ("pmac", "32nds") and self.encoder is None:
            raise ConfigError("counts, and needs an encoder", key=f"joints.{self.name}.loop")
        self._check_edges()

    def _check_edges(self) -> None:
        """Refuse faults of an encoder that nothing reads, or that the loop cannot read."""
        edges, loop = None if self.encoder is None else self.encoder.edges, self.loop
        if edges is None:
            return
        if loop is None:
            raise ConfigError("edges are looked at in a servo's loop, and this joint has none",
                              key=f"joints.{self.name}.encoder", hint="Leave out channels, jitter, missed and clock, "
                              "or give the joint a loop.")  # fmt: skip
        if edges.clock is not None and loop.kind != "cascade":
            raise ConfigError(f"a loop of kind {loop.kind} reads no speed; a cascade does",
                              key=f"joints.{self.name}.encoder.clock")  # fmt: skip
        if edges.single and not (loop.kind == "32nds" and not getattr(loop, "mended")):  # noqa: B009 - of one kind
            raise ConfigError("one channel tells no direction: only a loop that drives one way at a time can read it",
                              key=f"joints.{self.name}.encoder.channels",
                              hint='That is loop.kind = "32nds" with mended = false.')  # fmt: skip

    @property
    def closed(self) -> bool:
        """Whether the file says all of a servo's loop: motor, amplifier and gains; else a servo is ideal."""
        return self.loop is not None

    @property
    def fed(self) -> Fed | None:
        """The motor behind its driver, or None where the file does not give both.

        Raises
        ------
        ConfigError
            For a driver without a known motor, and as :func:`trochia.machine.drivers.fed`.
        """
        if self.driver is None:
            return None
        parameters = self.motor.parameters if isinstance(self.motor, Stepper) else None
        if not isinstance(self.motor, Stepper) or parameters is None:
            raise ConfigError("needs a stepper whose library or catalogue says what it is", key="driver")
        return fed(parameters, self.driver, self.motor.microsteps)

    @property
    def steps_per_unit(self) -> Fraction | None:
        """Step pulses a mm or degree, exactly; None for a servo."""
        if isinstance(self.motor, Stepper):
            return self.motor.steps_per_turn / self.transmission.travel_per_turn
        return None

    @property
    def counts_per_unit(self) -> Fraction | None:
        """Encoder counts a mm or degree, exactly; None without an encoder."""
        if self.encoder is None:
            return None
        if self.encoder.on_load:
            return self.encoder.counts
        return self.encoder.counts / self.transmission.travel_per_turn
