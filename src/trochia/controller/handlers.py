"""What each command does.  In: the controller, a command that its state allows.  Out: what to tell its sender.

A handler that refuses raises; nothing has changed then.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import msgspec

from trochia.backends.live import Orders
from trochia.backends.switches import switches_of
from trochia.controller.doings import OUTPUTS_OFF
from trochia.controller.guards import stands_on
from trochia.controller.homing import Home as Homing
from trochia.controller.job import Job
from trochia.controller.jog import Jog
from trochia.controller.readying import MDI
from trochia.controller.search import squared
from trochia.controller.starting import LEAST, begin, check_overrides, limit_feed, plan_here, run_from, start
from trochia.controller.states import State
from trochia.errors import LimitError, LocalProtocolError, OutOfTravelError
from trochia.messages import command as c
from trochia.program import AXES

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.controller.controller import Controller
    from trochia.machine.axes import Axis

    Handler = Callable[[Controller, Any, float], str]


def enable(it: Controller, _command: c.Enable, _now: float) -> str:
    """Switch the drives on."""
    for key, what in (("estop", "the emergency stop is pressed"), ("interlock", "the interlock is broken")):
        if it.panel.active(it, key):
            raise LocalProtocolError(what, hint="Release or close it first.")
    it.pending.append(Orders(enable=True, lit=it.lightable))
    return ""


def disable(it: Controller, _command: c.Disable, _now: float) -> str:
    """Switch the drives off."""
    it.pending.append(Orders(enable=False, lit=False))
    return ""


def estop(it: Controller, _command: c.EmergencyStop, _now: float) -> str:
    """Stop everything now."""
    it.stop_now()
    return ""


def reset(it: Controller, _command: c.Reset, _now: float) -> str:
    """Leave the emergency stop."""
    if it.panel.active(it, "estop"):
        raise LocalProtocolError("the emergency stop is pressed", hint="Release it first.")
    it.alarms.acknowledge()
    return "home the machine before it runs a program"


def acknowledge(it: Controller, _command: c.Acknowledge, _now: float) -> str:
    """Take note of the alarms."""
    it.alarms.acknowledge()
    return ""


def load(it: Controller, command: c.Load, _now: float) -> str:
    """Make a program the one to run, once it has been read and planned from here."""
    made = plan_here(it, command.text, command.name)
    it.loaded, it.preview = (command.name, command.text), made
    return f"{made.plan.program.lines} lines, {made.plan.time_s:.1f} s"


def unload(it: Controller, _command: c.Unload, _now: float) -> str:
    """Have no program."""
    it.loaded = it.preview = None
    return ""


def run(it: Controller, _command: c.Run, _now: float) -> str:
    """Run the program from its start."""
    return start(it, block_by_block=it.switches.single_block)


def step(it: Controller, _command: c.Step, _now: float) -> str:
    """Run one block."""
    if it.state is State.HELD and isinstance(it.activity, Job):
        if not it.activity.options.block_by_block:
            raise LocalProtocolError("the job was not started block by block", hint="Resume it, or begin with step.")
        job = it.activity
        told = resume(it, c.Resume(), 0.0)
        job.by_block = True
        return told
    return start(it, block_by_block=True)


def mdi(it: Controller, command: c.Mdi, _now: float) -> str:
    """Run a few lines."""
    text = command.text if command.text.endswith("\n") else command.text + "\n"
    return begin(it, text + "M2\n", MDI, block_by_block=False)


def hold(it: Controller, _command: c.Hold, _now: float) -> str:
    """Brake along the path."""
    if it.activity is not None:
        it.activity.hold(it.report, it.latency)
    return ""


def abort(it: Controller, _command: c.Abort, _now: float) -> str:
    """Brake, and give up."""
    if it.state is State.HELD:
        it.pending.append(Orders(lit=False, outputs=OUTPUTS_OFF))
        it.end(whole=False)
    elif it.activity is not None and it.state is not State.HOLDING:
        it.activity.hold(it.report, it.latency)
    return ""


def resume(it: Controller, _command: c.Resume, _now: float) -> str:
    """Go on."""
    if it.hook:
        raise LocalProtocolError(f"{it.hook} still runs", hint="Wait for its end, or abort the job.")
    check_overrides(it)
    it.panel.check_safe(it)
    if isinstance(it.activity, Job):
        it.activity.by_block = it.switches.single_block
        it.resume(it.activity)
    it.request = None
    return ""


def reverse(it: Controller, command: c.Reverse, _now: float) -> str:
    """Go back along the path."""
    if it.away is not None or it.hook or not isinstance(it.activity, Job):
        raise LocalProtocolError("the tool is not on the path" if it.away else "no job is held here", hint="Resume it.")
    it.panel.check_safe(it)
    it.activity.reverse(it.report, command.way)
    return ""


def answer(it: Controller, command: c.Answer, now: float) -> str:
    """Answer the machine's question; yes goes on."""
    if it.request is None or it.request.number != command.request:
        raise LocalProtocolError(f"nothing is asked under number {command.request}")
    if command.yes and it.state is State.HELD:
        resume(it, c.Resume(), now)
        it.enter(State.RESUMING)
    it.request = None
    return ""


def switches(it: Controller, command: c.Switches, _now: float) -> str:
    """Set the operator's switches."""
    lock = command.machine_lock
    if lock is not None and lock != it.switches.machine_lock:
        if it.activity is not None or not it.report.still:
            raise LocalProtocolError("the machine lock is turned at rest only", hint="Wait for the end, or abort.")
        if lock:
            it.lock.shut_at(it.report)
        else:
            it.report = it.lock.open(it.report)
    given = {name: getattr(command, name) for name in it.switches.__struct_fields__}
    it.switches = msgspec.structs.replace(it.switches, **{n: v for n, v in given.items() if v is not None})
    return "" if it.state is State.IDLE else "switches act from the next start on"


def override(it: Controller, command: c.Override, _now: float) -> str:
    """Scale feeds, rapids, spindle."""
    given = {name: getattr(command, name) for name in it.overrides.__struct_fields__}
    it.overrides = msgspec.structs.replace(it.overrides, **{n: v for n, v in given.items() if v is not None})
    told = "" if it.running is None else limit_feed(it, it.running.most)
    if not isinstance(it.activity, Job):
        return told
    it.activity.doings.spindle = it.overrides.spindle
    if command.spindle is not None:
        it.pending.append(Orders(outputs=dict(it.activity.doings.turning())))
    if it.state not in {State.RUNNING, State.STEPPING, State.RESUMING}:
        return told
    if min(it.overrides.feed, it.overrides.rapid) < LEAST:
        it.activity.hold(it.report, it.latency)
        it.enter(State.HOLDING)
        return "held: an override is 0"
    it.activity.override(it.report, it.latency, feed=it.overrides.feed, rapid=it.overrides.rapid)
    return told


def jog(it: Controller, command: c.Jog, now: float) -> str:
    """Jog an axis while its lease lives."""
    if isinstance(it.activity, Jog):
        if not it.activity.renew(command.axis, command.speed, command.lease, now):
            raise LocalProtocolError("another jog is under way", hint="End it with jog-stop first.")
        return ""
    axis = _axis(it, command.axis)
    if not command.speed:
        raise LocalProtocolError("a jog needs a speed that is not 0")
    end = axis.maximum if command.speed > 0.0 else axis.minimum
    here = it.position()[axis.name]
    if not it.trusted[axis.name]:
        end = here + (axis.maximum - axis.minimum) * (1.0 if command.speed > 0.0 else -1.0)
    if (end - here) * command.speed <= 0.0:
        raise OutOfTravelError(f"{axis.name} stands at the end of its travel, {end:g} {axis.unit}",
                               hint="Jog the other way.")  # fmt: skip
    return _jog(it, {axis.name: end}, abs(command.speed), now, lease=(axis.name, command.speed, command.lease))


def jog_stop(it: Controller, _command: c.JogStop, _now: float) -> str:
    """End a jog."""
    if it.activity is not None:
        it.activity.hold(it.report, it.latency)
    return ""


def jog_by(it: Controller, command: c.JogBy, now: float) -> str:
    """Move axes by a way."""
    here = it.position()
    target = {name: here[_axis(it, name).name] + way for name, way in command.way.items()}
    return _jog(it, target, command.speed, now)


def jog_to(it: Controller, command: c.JogTo, now: float) -> str:
    """Move axes to machine positions."""
    for name in command.position:
        if not it.trusted[_axis(it, name).name]:
            raise LocalProtocolError(f"nobody knows where {name} is", hint="Home it first.")
    return _jog(it, command.position, command.speed, now)


def home(it: Controller, command: c.Home, _now: float) -> str:
    """Find the reference of axes."""
    if it.lock.shut:
        raise LocalProtocolError("nothing is found under the machine lock", hint="Turn it off first.")
    names = command.axes or tuple(axis.name for axis in it.machine.axes)
    it.begin(Homing(it, tuple(_axis(it, name) for name in names)))
    return ""


def work_zero(it: Controller, command: c.WorkZero, _now: float) -> str:
    """Make the present point read as given."""
    here = it.position()
    number = command.system or it.work.active
    systems = [list(offsets) for offsets in it.work.systems]
    for name, value in command.axes.items():
        column = AXES.index(_axis(it, name).name)
        shift = it.work.tool_offset[column] + (it.work.g92[column] if it.work.g92_on else 0.0)
        systems[number - 1][column] = here[name] - shift - value
    it.work = replace(it.work, systems=tuple(tuple(offsets) for offsets in systems))
    return ""


def set_output(it: Controller, command: c.SetOutput, _now: float) -> str:
    """Set an output."""
    known = [channel.name for channel in it.machine.io if not channel.kind.endswith("input")]
    if command.name not in known:
        raise LocalProtocolError(f"there is no output {command.name!r}", hint="There are: " + ", ".join(known))
    it.pending.append(Orders(outputs={command.name: command.value}))
    return ""


def set_input(it: Controller, command: c.SetInput, _now: float) -> str:
    """Set an input of a twin."""
    if not it.report.settable:
        raise LocalProtocolError("inputs of a real machine cannot be set", hint="Only a digital twin's can.")
    switches = switches_of(it.machine)
    known = [
        channel.name for channel in it.machine.io
        if channel.kind.endswith("input") and channel.name not in switches and channel.name in it.report.inputs
    ]  # fmt: skip
    if command.name in switches:
        raise LocalProtocolError(f"{command.name} is told by where the machine is", hint="Move the axis.")
    if command.name not in known:
        raise LocalProtocolError(f"there is no input {command.name!r}", hint="There are: " + ", ".join(known))
    it.pending.append(Orders(inputs={command.name: command.value}))
    return ""


def arm_beam(it: Controller, command: c.ArmBeam, _now: float) -> str:
    """Allow or forbid the beam."""
    it.armed = command.on
    it.pending.append(Orders(lit=it.lightable))
    return it.panel.dark(it) if command.on else ""


def _axis(it: Controller, name: str) -> Axis:
    for axis in it.machine.axes:
        if axis.name == name:
            return axis
    raise LocalProtocolError(f"this machine has no axis {name}",
                             hint="It has " + " ".join(axis.name for axis in it.machine.axes))  # fmt: skip


def _jog(
    it: Controller, target: dict[str, float], speed: float | None, now: float,
    lease: tuple[str, float, float] | None = None,
) -> str:  # fmt: skip
    """Begin a jog; return what is to be told: the board may not do the speed."""
    axes = [_axis(it, name) for name in target]
    if not axes:
        raise LocalProtocolError("a jog names at least one axis")
    for axis in axes:
        if it.trusted[axis.name] and not axis.minimum - 1e-9 <= target[axis.name] <= axis.maximum + 1e-9:
            raise OutOfTravelError(f"{axis.name} would go to {target[axis.name]:g} {axis.unit}, its travel is "
                                   f"{axis.minimum:g} to {axis.maximum:g}")  # fmt: skip
    apart = squared(it.machine, it.report)
    if apart:
        raise LocalProtocolError(f"joints of one axis stand apart: {' '.join(apart)}", hint="Home it first.")
    here = it.position()
    for axis in axes:
        switch = stands_on(it.machine, it.report, axis.name, target[axis.name] - here[axis.name])
        if switch is not None:
            raise OutOfTravelError(f"{axis.name} stands on its limit switch {switch}", hint="Jog the other way.")
    feed = speed if speed is not None else min(axis.velocity for axis in axes) / 2
    if not feed > 0.0:
        raise LimitError(f"a jog's speed must be above zero, not {feed!r}")
    words = " ".join(f"{name}{value:.9f}" for name, value in target.items())
    made = it.readier.straight(f"G94 G1 {words} F", 60.0 * feed, "<jog>", at=here)
    it.pending.append(Orders(lit=False, watch=()))
    it.begin(Jog(made.plan, it.machine, origin=it.report.executed, ahead=it.ahead, now=now, lease=lease))
    return f"slowed to {100.0 * made.slowed:.0f} %: the board can make no more steps" if made.slowed < 1.0 else ""


HANDLERS: dict[type[c.Command], Handler] = {
    c.Enable: enable, c.Disable: disable, c.EmergencyStop: estop, c.Reset: reset, c.Acknowledge: acknowledge,
    c.Load: load, c.Unload: unload, c.Run: run, c.RunFrom: run_from, c.Hold: hold, c.Resume: resume, c.Step: step,
    c.Reverse: reverse, c.Abort: abort, c.Switches: switches, c.Override: override, c.Mdi: mdi, c.Jog: jog,
    c.JogStop: jog_stop, c.JogBy: jog_by, c.JogTo: jog_to, c.Home: home, c.WorkZero: work_zero,
    c.SetOutput: set_output, c.SetInput: set_input, c.ArmBeam: arm_beam, c.Answer: answer,
}  # fmt: skip
