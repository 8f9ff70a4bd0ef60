"""What can be asked of a machine: one frozen record a command, told apart on the wire by its ``kind``.

Every command carries an ``id`` its sender chose; the :class:`Ack` that answers it carries the same.  Units are mm,
degrees, seconds; speeds mm/s or degree/s; overrides are fractions (1.0: as programmed).
"""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta

Fraction = Annotated[float, Meta(ge=0.0, le=2.0)]
Speed = Annotated[float, Meta(gt=0.0)]
Letter = Annotated[str, Meta(pattern="^[XYZABCUVW]$")]


class Command(msgspec.Struct, frozen=True, kw_only=True, tag_field="kind", forbid_unknown_fields=True):
    """A request to the controller; ``id`` comes back in its answer."""

    id: int = 0


class Enable(Command, frozen=True, kw_only=True, tag="enable"):
    """Switch the drives on; nothing moves."""


class Disable(Command, frozen=True, kw_only=True, tag="disable"):
    """Switch the drives off, at rest."""


class EmergencyStop(Command, frozen=True, kw_only=True, tag="estop"):
    """Stop everything now, beam and spindle off; positions are lost.  Legal in every state, for everyone."""


class Reset(Command, frozen=True, kw_only=True, tag="reset"):
    """Leave the emergency stop, once it is released."""


class Acknowledge(Command, frozen=True, kw_only=True, tag="acknowledge"):
    """Take note of the alarms; those whose cause is gone are cleared."""


class Load(Command, frozen=True, kw_only=True, tag="load"):
    """Make a part program the one to run."""

    name: str
    text: str


class Unload(Command, frozen=True, kw_only=True, tag="unload"):
    """Have no program."""


class Run(Command, frozen=True, kw_only=True, tag="run"):
    """Run the program from its start."""


class RunFrom(Command, frozen=True, kw_only=True, tag="run-from"):
    """Run from a line, or from where a job was interrupted (``line`` 0).

    Nothing moves until the same is asked with ``confirmed``: the first answer tells the way to get there.
    """

    line: Annotated[int, Meta(ge=0)]
    confirmed: bool = False


class Hold(Command, frozen=True, kw_only=True, tag="hold"):
    """Brake along the path and stay there, beam off."""


class Resume(Command, frozen=True, kw_only=True, tag="resume"):
    """Go on after a hold, a pause of the program, or a tool change."""


class Reverse(Command, frozen=True, kw_only=True, tag="reverse"):
    """Go back along the path from a hold, beam off, and stay there; a resume goes on from there."""

    way: Annotated[float, Meta(ge=0.0)]  # along the path [mm]


class Step(Command, frozen=True, kw_only=True, tag="step"):
    """Run one block of the program and hold at its end."""


class Abort(Command, frozen=True, kw_only=True, tag="abort"):
    """Brake and give the job up, beam and spindle off."""


class Switches(Command, frozen=True, kw_only=True, tag="switches"):
    """Set the operator's switches; what is None stays as it is.

    ``single_block`` holds after every block, ``block_delete`` skips lines that begin with a slash, ``optional_stop``
    lets M1 stop, ``dry_run`` keeps the beam and the spindle off, ``machine_lock`` keeps the axes still.
    """

    single_block: bool | None = None
    block_delete: bool | None = None
    optional_stop: bool | None = None
    dry_run: bool | None = None
    machine_lock: bool | None = None


class Override(Command, frozen=True, kw_only=True, tag="override"):
    """Scale feeds, rapids (1.0 at most) or the spindle; what is None stays as it is."""

    feed: Fraction | None = None
    rapid: Annotated[float, Meta(ge=0.0, le=1.0)] | None = None
    spindle: Fraction | None = None


class Mdi(Command, frozen=True, kw_only=True, tag="mdi"):
    """Run a few lines of G-code, starting where the machine is, in the work state as it stands."""

    text: Annotated[str, Meta(min_length=1, max_length=4096)]


class Jog(Command, frozen=True, kw_only=True, tag="jog"):
    """Move an axis for as long as the lease is renewed by the same command again.

    ``speed`` is signed [mm/s or degree/s]; ``lease`` is how long it lives without renewal [s].
    """

    axis: Letter
    speed: float
    lease: Annotated[float, Meta(gt=0.0, le=1.0)] = 0.15


class JogStop(Command, frozen=True, kw_only=True, tag="jog-stop"):
    """End any jog at once, by braking."""


class JogBy(Command, frozen=True, kw_only=True, tag="jog-by"):
    """Move axes by a way [mm or degree]."""

    way: dict[Letter, float]
    speed: Speed | None = None


class JogTo(Command, frozen=True, kw_only=True, tag="jog-to"):
    """Move axes to machine positions [mm or degree]."""

    position: dict[Letter, float]
    speed: Speed | None = None


class Home(Command, frozen=True, kw_only=True, tag="home"):
    """Find the reference of the axes, in the machine's order; none named: of all."""

    axes: tuple[Letter, ...] = ()


class WorkZero(Command, frozen=True, kw_only=True, tag="work-zero"):
    """Make the present point of a coordinate system (0: that in force) read as given, {axis: mm or degree}."""

    axes: dict[Letter, float]
    system: Annotated[int, Meta(ge=0, le=9)] = 0


class SetOutput(Command, frozen=True, kw_only=True, tag="set-output"):
    """Set an output of the machine file by its name."""

    name: str
    value: float


class SetInput(Command, frozen=True, kw_only=True, tag="set-input"):
    """Set an input of a digital twin by its name (1: active); inputs of a real machine are what they are."""

    name: str
    value: float


class ArmBeam(Command, frozen=True, kw_only=True, tag="arm-beam"):
    """Allow the beam to be lit by programs, or forbid it."""

    on: bool


class Record(Command, frozen=True, kw_only=True, tag="record"):
    """Record every servo tick from now on, in the folder of recordings.

    ``name`` is that of the recording, else the next free ``recording-N``; ``channels`` may have ``*`` and ``?``, none
    are all.  ``triggers`` are ``hold``, ``alarm``, ``line N``, with ``before`` and ``after`` [s] around each; none: all
    the time.  ``limit`` is how many bytes it takes at most, the oldest dropped.
    """

    name: Annotated[str, Meta(pattern="^([A-Za-z0-9][A-Za-z0-9_.-]{0,63})?$")] = ""
    channels: Annotated[tuple[Annotated[str, Meta(max_length=64)], ...], Meta(max_length=64)] = ()
    triggers: Annotated[tuple[Annotated[str, Meta(max_length=32)], ...], Meta(max_length=32)] = ()
    before: Annotated[float, Meta(ge=0.0, le=60.0)] = 1.0
    after: Annotated[float, Meta(ge=0.0, le=3600.0)] = 1.0
    limit: Annotated[int, Meta(ge=1 << 20, le=1 << 34)] = 256 << 20


class RecordStop(Command, frozen=True, kw_only=True, tag="record-stop"):
    """End the recording under way; the answer tells where it is."""


class Answer(Command, frozen=True, kw_only=True, tag="answer"):
    """Answer what the machine asked of its operator: a tool is in, a question is confirmed or not."""

    request: int
    yes: bool = True


AnyCommand = (
    Enable | Disable | EmergencyStop | Reset | Acknowledge | Load | Unload | Run | RunFrom | Hold | Resume | Reverse
    | Step | Abort | Switches | Override | Mdi | Jog | JogStop | JogBy | JogTo | Home | WorkZero | SetOutput | ArmBeam
    | Record | RecordStop | SetInput | Answer
)  # fmt: skip


class Ack(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """The answer to a command.

    ``ok`` says whether it was taken; if not, ``reason`` says why and ``legal`` names what would be taken now.  ``told``
    is what the sender should know, as the way a start from a line would take.
    """

    id: int
    ok: bool
    reason: str = ""
    legal: tuple[str, ...] = ()
    told: str = ""
