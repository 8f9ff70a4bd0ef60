"""What a machine tells: one immutable record, made anew whenever it is asked for."""

from __future__ import annotations

import msgspec

from trochia.messages.fault import Fault  # noqa: TC001 - msgspec reads the types at run time

SCHEMA_VERSION = 1  #: of Status and Command; raised when an older client would misread them


class AxisStatus(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """One axis; positions in machine coordinates [mm or degree].

    Attributes
    ----------
    commanded
        Where it should be now.
    encoder
        Where its encoder says it is; None without one.
    actual
        Where it really is; only a twin knows, None elsewhere.
    work
        ``commanded`` in the coordinate system in force.
    velocity
        Commanded [mm/s or degree/s].
    trusted
        Whether its position is known: homed, and not lost since.
    """

    name: str
    unit: str
    commanded: float
    work: float
    velocity: float = 0.0
    encoder: float | None = None
    actual: float | None = None
    trusted: bool = False
    enabled: bool = False


class ProgramStatus(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """The program loaded: the line executed (not sent), how far through its time, and how far along that line [mm]."""

    name: str
    lines: int
    line: int = 0
    distance: float = 0.0
    time_s: float = 0.0
    done_s: float = 0.0
    remaining_s: float = 0.0


class OverrideStatus(msgspec.Struct, frozen=True, kw_only=True):
    """Overrides in force, as fractions."""

    feed: float = 1.0
    rapid: float = 1.0
    spindle: float = 1.0


class SwitchStatus(msgspec.Struct, frozen=True, kw_only=True):
    """The operator's switches."""

    single_block: bool = False
    block_delete: bool = False
    optional_stop: bool = False
    dry_run: bool = False
    machine_lock: bool = False


class Request(msgspec.Struct, frozen=True, kw_only=True):
    """What the machine asks of its operator: ``kind`` tool, confirm, pause or code; answered by its number.

    ``hook``: nothing is asked, a program of the machine's own runs (M100 to M199), and the job goes on after it.
    """

    number: int
    kind: str
    text: str


class Status(msgspec.Struct, frozen=True, kw_only=True):
    """Everything there is to know about the machine at one instant.

    Attributes
    ----------
    sequence
        Counts up with every status made.
    time
        The controller's clock [s].
    state
        Name of the state (``trochia.controller.states``).
    legal
        Kinds of command that are taken now.
    speed
        Commanded path speed [mm/s], and ``rate``, at what fraction of planned time the machine runs.
    beam, armed
        Power of the beam as S gave it, 0 off; whether programs may light it.
    spindle
        Signed speed asked for [rpm].
    queued_s
        Motion the backend still holds [s].
    backend
        Who moves: ``twin``, or which board where.
    message
        What the program under way, or the last one, has said last; or which is being planned.
    """

    sequence: int
    time: float
    state: str
    machine: str
    axes: tuple[AxisStatus, ...]
    legal: tuple[str, ...]
    overrides: OverrideStatus = OverrideStatus()
    switches: SwitchStatus = SwitchStatus()
    program: ProgramStatus | None = None
    request: Request | None = None
    alarms: tuple[Fault, ...] = ()
    speed: float = 0.0
    rate: float = 1.0
    beam: float = 0.0
    armed: bool = False
    spindle: float = 0.0
    flood: bool = False
    mist: bool = False
    tool: int = 0
    system: int = 1
    io: dict[str, float] = {}
    queued_s: float = 0.0
    backend: str = ""
    message: str = ""
    schema: int = SCHEMA_VERSION
