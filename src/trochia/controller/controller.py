"""The live machine: commands and reports in, orders and status out.  No clock, no thread, no file is touched here.

``command`` answers at once; ``step`` takes the backend's report of now and returns what to tell it.  What should
outlast the moment is put into ``journal``, for whoever runs the controller to write.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.backends.live import Orders, Trouble
from trochia.controller.alarms import TROUBLES, Alarms
from trochia.controller.asking import ask_for, go_on, probe
from trochia.controller.away import Away, detour, go_back
from trochia.controller.doings import OUTPUTS_OFF
from trochia.controller.guards import Guards
from trochia.controller.handlers import HANDLERS
from trochia.controller.interrupted import Interrupted, work_entry
from trochia.controller.job import Job
from trochia.controller.jog import Jog
from trochia.controller.lock import Lock
from trochia.controller.logs import Logs
from trochia.controller.outputs import Outputs
from trochia.controller.panel import Watch
from trochia.controller.readying import MDI, Readier
from trochia.controller.states import MOVING, TABLE, Event, State, legal
from trochia.controller.status import axes_of, axis_statuses, io_of, position_of, unit_of
from trochia.errors import TrochiaError
from trochia.messages import Ack, Cause, OverrideStatus, ProgramStatus, Request, Status, SwitchStatus
from trochia.program import AXES, WorkState

if TYPE_CHECKING:
    from trochia.backends.live import Report
    from trochia.controller.activity import Activity
    from trochia.controller.readying import Ready
    from trochia.languages.gcode import Reading
    from trochia.machine.machine import Machine
    from trochia.messages import AnyCommand

POINT = 0.01  #: time between the points a journal gets [s]


class Controller:
    """One machine.

    Parameters
    ----------
    report
        The backend's first.
    latency, ahead, title
        Of the backend: how long its orders take, the motion it wants to hold [s], its name.
    reading
        How programs are read.

    Attributes
    ----------
    state
        What it is doing.
    work
        Offsets, tools, variables as they stand.
    journal
        (kind, data) of what has happened, until taken.
    """

    def __init__(
        self, machine: Machine, report: Report, *, latency: float, ahead: float, work: WorkState | None = None,
        reading: Reading | None = None, title: str = "",
    ) -> None:  # fmt: skip
        self.machine, self.report = machine, report
        self.latency, self.ahead, self.title = latency, ahead, title
        self.state = State.OFF
        self.work = work or WorkState()
        self.switches, self.overrides = SwitchStatus(), OverrideStatus()
        self.alarms = Alarms()
        self._guards, self.readier = Guards(machine), Readier(machine, reading)
        self.loaded: tuple[str, str] | None = None  # name and text of the program
        self.preview: Ready | None = None  # the program as it was planned when it was loaded
        self.running: Ready | None = None
        self.interrupted: Interrupted | None = None  # the job before, if it did not come to its end
        self.activity: Activity | None = None
        self.request: Request | None = None
        self.hooked: frozenset[int] = frozenset()  # codes M100 to M199 that have programs
        self.hook = self.said = ""  # the one whose program runs; what the program has said last
        self.panel = Watch(machine.panel)
        self.logs = Logs(None)
        self.lock = Lock(machine.servo_period)
        self._outputs = Outputs(machine)
        self.asked = 0.0  # when a command came last [s]
        self.resume_at: float | None = None  # when a job is resumed whose spindle has to get to its speed first [s]
        self.away: Away | None = None  # a held job whose tool was taken away
        self.leaving = False  # whether it is to be, at rest
        self.armed = machine.beam is None
        self.trusted = {axis.name: axis.home is None for axis in machine.axes}
        self.journal: list[tuple[str, dict[str, Any]]] = []
        self.pending: list[Orders] = []
        self.back = 0.0  # plan time at which a resumed job is where it was held
        self._sequence = self._requests = 0
        self._pointed = -POINT
        self._moved = self._on = self._spindle_stopped = False

    # -- in and out

    def command(self, command: AnyCommand, now: float) -> Ack:
        """Take a command, or say why not; what it starts is in the orders of the next step."""
        kind = str(type(command).__struct_config__.tag)
        self.asked = now
        if (self.state, kind) not in TABLE:
            allowed = legal(self.state)
            return Ack(id=command.id, ok=False, reason=f"{kind} is not taken while {self.state.value}", legal=allowed)
        try:
            told = HANDLERS[type(command)](self, command, now)
        except TrochiaError as error:
            self.note("refused", command=kind, reason=str(error))
            return Ack(id=command.id, ok=False, reason=str(error), legal=legal(self.state))
        self.note("command", command=kind)
        target = TABLE[self.state, kind]
        if target not in MOVING or self.activity is not None:  # else it was only asked what it would do
            self.enter(target)
        return Ack(id=command.id, ok=True, told=told)

    def step(self, now: float, report: Report) -> list[Orders]:
        """Take the backend's report of now and return what to tell it, in order.  A report is taken once."""
        self.report = report = self.lock.seen(report)
        for trouble in report.troubles:
            self.fault(trouble)
        for trouble in self._guards.troubles(report, homing=self.state is State.HOMING):
            self.fault(trouble)
        self.panel.look(self, now)
        due = self._outputs.due(report)
        if due:
            self.pending.append(Orders(outputs=due))
        self._look_at_power()
        if isinstance(self.activity, Jog) and self.activity.expired(now):
            self.activity.hold(report, self.latency)
            if self.state is State.JOGGING:
                self.note("lease", text="the jog's lease ran out")
                self.enter(State.STOPPING)
        self._events()
        self._point(now)
        return self.orders()

    def orders(self) -> list[Orders]:
        """Return what there is to tell the backend by what is known, in order."""
        orders, self.pending = self.pending, []
        if self.activity is not None:
            orders += self.activity.feed(self.report)
        return self.lock.kept(orders)

    def status(self, now: float) -> Status:
        """Return everything there is to know now."""
        self._sequence += 1
        report = self.report
        return Status(
            sequence=self._sequence, time=now, state=self.state.value, machine=self.machine.name,
            axes=axis_statuses(self.machine, report, self.work, self.trusted), legal=legal(self.state),
            overrides=self.overrides, switches=self.switches, program=self._program(), request=self.request,
            alarms=tuple(self.alarms.latched), speed=float(np.linalg.norm(self.velocity)), rate=report.rate,
            backend=self.title, beam=report.beam, armed=self.machine.beam is not None and self.lightable,
            spindle=report.outputs.get("spindle", 0.0),
            flood=bool(report.outputs.get("flood")), mist=bool(report.outputs.get("mist")), tool=self.work.tool,
            system=self.work.active, io=io_of(report), queued_s=report.queued, message=self._message(),
        )  # fmt: skip

    # -- what handlers use

    def note(self, kind: str, **data: object) -> None:
        """Put something into the journal."""
        self.journal.append((kind, data))

    @property
    def velocity(self) -> np.ndarray[Any, np.dtype[np.float64]]:
        """Commanded velocity of the linear axes (n,) [mm/s]."""
        linear = [i for i, axis in enumerate(self.machine.axes) if not axis.rotary]
        return axes_of(self.machine, self.report.velocity)[linear]

    def position(self) -> dict[str, float]:
        """Return where each axis is told to be [mm or degree]."""
        return position_of(self.machine, self.report)

    def ask(self, kind: str, text: str) -> None:
        """Ask the operator something."""
        self._requests += 1
        self.request = Request(number=self._requests, kind=kind, text=text)
        self.note("request", number=self._requests, request=kind, text=text)

    def fault(self, trouble: Trouble, text: str = "") -> None:
        """Latch a fault and do what its row says."""
        row = TROUBLES[trouble.cause]
        fault = self.alarms.raise_(trouble, self.report.time, line=self.report.line, text=text,
                                   unit=unit_of(self.machine, trouble.joint))  # fmt: skip
        if fault is None:
            return
        self.note("fault", cause=trouble.cause.value, text=fault.message, line=fault.line)
        if row.warning:
            return
        self.pending.append(Orders(stop=row.at_once or row.dark, lit=False, enable=False if row.dark else None,
                                   outputs=OUTPUTS_OFF))  # fmt: skip
        activity = self.activity
        self.end(whole=False)
        if activity is not None and not (row.at_once or row.dark):
            self.activity = activity
            self._brake(activity)
        if not row.trusted:
            self.distrust(trouble.joint)
        if (self.state, Event.FAULT) in TABLE:
            self.enter(TABLE[self.state, Event.FAULT])

    def _brake(self, activity: Activity) -> None:
        """Brake along the path, or at once where that cannot be planned."""
        try:
            activity.hold(self.report, self.latency)
        except TrochiaError as error:
            self.note("brake", text=str(error))
            self.pending.append(Orders(stop=True, lit=False))
            self.activity = None

    @property
    def lightable(self) -> bool:
        """Whether programs may light the beam: it is armed, and nothing guards it."""
        return self.armed and not self.panel.dark(self)

    def stop_now(self) -> None:
        """Stop everything, drives off, positions lost: an emergency stop."""
        self.fault(Trouble(cause=Cause.ESTOP))
        self.pending.append(Orders(stop=True, enable=False, lit=False))
        self.end(whole=False)
        self.distrust()
        self.enter(State.ESTOP)

    @property
    def job(self) -> Job | None:
        """The job under way, also one whose tool was taken away; None: there is none."""
        return self.away.job if self.away else self.activity if isinstance(self.activity, Job) else None

    def stop_spindle(self) -> None:
        """Stop the spindle of the job under way, until it is resumed."""
        if self.job is not None and self.job.doings.speed and self.machine.spindle is not None:
            self.pending.append(Orders(outputs={"spindle": 0.0}))
            self._spindle_stopped = True

    def resume(self, job: Job) -> None:
        """Go on with a job: at once, or when its spindle is at speed again."""
        self.pending.append(Orders(lit=self.lightable and not job.options.dark))
        if self._spindle_stopped:
            self._spindle_stopped = False
            self.pending.append(Orders(outputs=dict(job.doings.turning())))
            self.resume_at = self.report.time + (self.machine.spindle.spin_up if self.machine.spindle else 0.0)
        else:
            self.resume_at = self.report.time
        self.back = np.inf
        self._resume_in_time()

    def distrust(self, joint: str = "") -> None:
        """Note that positions are lost: of the axes a joint moves, or of all."""
        rows = {j.name: row for j, row in zip(self.machine.joints, self.machine.kinematics.matrix, strict=True)}
        moved = np.abs(rows[joint]) > 0.0 if joint in rows else np.ones(len(self.machine.axes), bool)
        for axis, lost in zip(self.machine.axes, moved, strict=True):
            self.trusted[axis.name] = self.trusted[axis.name] and not lost

    def begin(self, activity: Activity) -> None:
        """Be busy with something from now on."""
        self.activity = activity
        self._moved = False

    def end(self, *, whole: bool) -> None:
        """Be no longer busy; a program that has not come to its end can be gone on with."""
        place = self.away.place if self.away else self.position()
        self.settle()
        self.away, self.leaving = None, False
        made, job = self.running, self.activity
        self._message()  # while the job is there to be asked
        if made is not None and isinstance(job, Job) and not self.lock.shut:
            point = job.point(self.report)
            self.note("end", name=made.name, whole=whole, line=self.report.line, **point)
            if made.name != MDI and not whole:
                start = dict(zip(AXES, made.start, strict=True))
                self.interrupted = Interrupted(
                    name=made.name, text=made.text, start=start, work=work_entry(made.found), line=self.report.line,
                    block_delete=self.switches.block_delete, position=place, closed=True,
                    move=int(point["move"]), distance=point["distance"], done_s=point["done_s"],
                    answers=made.answers or (),
                )  # fmt: skip
        self.activity = self.running = self.request = self.resume_at = None
        self._spindle_stopped = False

    # -- inside

    def enter(self, state: State) -> None:
        """Be in a state."""
        if state is not self.state:
            self.note("state", state=state.value, was=self.state.value)
            self.state = state

    def _resume_in_time(self) -> None:
        """Resume the job once its spindle is at speed."""
        if self.resume_at is not None and self.report.time >= self.resume_at and isinstance(self.activity, Job):
            self.resume_at = None
            if self.away is not None:
                go_back(self, self.away)
                return
            self.back = self.activity.resume(self.report, feed=self.overrides.feed, rapid=self.overrides.rapid)

    def _look_at_power(self) -> None:
        """Take drives that go off by themselves for a fault."""
        if self.state in {State.OFF, State.ESTOP, State.ALARM}:
            self._on = False
        elif self._on and not self.report.enabled:
            self.fault(Trouble(cause=Cause.DRIVE), "they went off by themselves")
        else:
            self._on = self.report.enabled

    def _events(self) -> None:
        """Let what has come about change the state."""
        if self.state is State.RESUMING and self.resume_at is not None:
            self._resume_in_time()
        elif self.activity is not None and self.state is not State.HELD:
            event = self.activity.event(self.report)
            if event is not None:
                self._happen(event)
        job = self.activity if isinstance(self.activity, Job) else None
        if self.state is State.RESUMING and job and job.feeder.plan_time(self.report.executed) >= self.back:
            self._happen(Event.BACK)
        if self.state is State.ALARM and self.activity is not None and self.report.still:
            self.pending.append(self.activity.finish(whole=False))
            self.activity = None  # whatever it planned: nothing moves any more
            self.pending.append(Orders(stop=True, lit=False, watch=()))
        if self.state is State.ALARM and not self.alarms and self.activity is None:
            self._happen(Event.CLEARED if self.report.enabled else Event.DARK)

    def _happen(self, event: Event) -> None:
        """Take an event: settle what ends with it, and enter the state the table names."""
        activity = self.activity
        if self.state is State.ALARM and event is Event.STILL:
            self.activity = None  # motion has come to rest; the alarm stays
            return
        if event is Event.STILL and (self.leaving or self.away is not None) and detour(self):
            return
        target = TABLE.get((self.state, event))
        if target is None:
            return
        if isinstance(activity, Job) and event in {Event.PROBE, Event.CONTACT, Event.ANSWER}:
            self.pending.append(activity.finish(whole=True))
            self.enter(target)
            (probe if event is Event.PROBE else go_on)(self, activity)
            return
        on_the_way = self.state in {State.HOLDING, State.REVERSING}
        if activity is not None and event in {Event.STILL, Event.PAUSED} and not on_the_way:
            self.pending.append(activity.finish(whole=self.state is not State.STOPPING))
        if event is Event.PAUSED and isinstance(activity, Job):
            ask_for(self, activity)
        if target is State.IDLE and activity is not None:
            self._end()
        self.enter(target)

    def settle(self) -> None:
        """Let a job whose tool is away be what is under way again; its clock stood still."""
        if self.away is not None:
            self.away.stand_still(self.report.executed)
            self.activity = self.away.job

    def _end(self) -> None:
        """Be no longer busy: keep what a program leaves set up."""
        whole = self.state in {State.RUNNING, State.STEPPING, State.RESUMING}
        self.settle()
        if isinstance(self.activity, Job) and not whole:
            self.pending.append(Orders(lit=False, outputs=OUTPUTS_OFF))
        elif self.running is not None:
            self.work = self.running.work
        self.end(whole=whole)

    def _message(self) -> str:
        """Return what the program has said last."""
        if isinstance(self.activity, Job):
            self.said = self.activity.doings.last_words
        return self.said

    def _program(self) -> ProgramStatus | None:
        if self.running is not None and isinstance(self.activity, Job):
            line, done = self.activity.place(self.report)
            whole = self.running.plan.time_s
            return ProgramStatus(name=self.running.name, lines=self.running.plan.program.lines, line=line,
                                 distance=self.activity.point(self.report)["distance"],
                                 time_s=whole, done_s=max(done, 0.0), remaining_s=max(whole - done, 0.0))  # fmt: skip
        if self.loaded is None or self.preview is None:
            return None
        return ProgramStatus(name=self.loaded[0], lines=self.preview.plan.program.lines)

    def _point(self, now: float) -> None:
        """Note where the machine is, while it moves and once when it has come to rest."""
        moving = self.state in MOVING
        if now - self._pointed < POINT - 1e-9 or not (moving or self._moved) or self.lock.shut:
            return
        self._pointed, self._moved = now, moving
        place = self.away.place if self.away else self.position()
        data: dict[str, object] = {"line": self.report.line, "position": place}
        if isinstance(self.activity, Job) and self.running is not None and self.running.name != MDI:
            data |= self.activity.point(self.report)
        self.note("point", **data)
