"""A program that asks, and goes on by the answer: the operator, or the machine by probing moves and M66.

In: a job at its question.  Out: the probe is watched, the answer is kept, and the rest of the program is read, planned
and run from where the machine stands.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.backends.live import Orders, Trouble
from trochia.controller.answer_entries import entry_of
from trochia.controller.job import BLOCK_END, Job, Options
from trochia.controller.readying import MDI
from trochia.controller.rerun import Entry
from trochia.controller.status import axes_of
from trochia.errors import TrochiaError
from trochia.languages.gcode.answers import Answer, Probed, Read
from trochia.messages import Cause
from trochia.program import AXES, Pause, Probe, ToolChange, UserCode

if TYPE_CHECKING:
    from trochia.controller.controller import Controller
    from trochia.controller.readying import Ready


def ask_for(it: Controller, job: Job) -> None:
    """Ask the operator for what a job waits for."""
    match job.waiting:
        case ToolChange(tool=tool):
            it.ask("tool", f"put tool {tool} in, then resume")
        case UserCode(number=number) as code if number in it.hooked:
            it.ask("hook", f"{code} runs; the program goes on when it has ended")
        case UserCode() as code:
            it.ask("code", f"{code}: do what it stands for, then resume")
        case Pause() if job.waiting is not BLOCK_END:
            it.ask("pause", "the program has stopped; resume goes on")
        case _:
            it.ask("pause", "the block is done; resume or step goes on")


def probe(it: Controller, job: Job) -> None:
    """Begin the probing move a job waits at, or fail where the probe is at its end already."""
    move, touch = job.waiting, it.machine.probe
    assert isinstance(move, Probe), "the job waits at a probing move"
    assert touch is not None, "it was checked before anything moved"
    if move.must and bool(it.report.inputs.get(touch.input)) == move.toward:
        _fail(it, Cause.PROBE, f"line {move.line}: the probe {'touches' if move.toward else 'is clear'} already")
        return
    it.pending.append(job.probe(touch.input))


def go_on(it: Controller, job: Job) -> None:
    """Take the answer to what a job asked at its end, and begin what follows."""
    answer = _answer(it, job)
    it.pending.append(Orders(watch=()))
    asks, made = job.asks, it.running
    assert made is not None, "a job runs what was made ready"
    if isinstance(asks, Probe) and isinstance(answer, Probed) and asks.must and not answer.touched:
        what = "touched nothing" if asks.toward else "did not come clear"
        _fail(it, Cause.PROBE, f"line {asks.line}: the probe {what} up to the move's end")
        return
    if made.name != MDI and not it.lock.shut:
        it.note("answer", **entry_of(answer))
    try:
        ready = it.readier.onward(made, answer, at=it.position(), exact=job.by_block)
        it.logs.check(ready.plan.program.actions)
        after = _next(it, job, made, ready)
    except TrochiaError as error:
        _fail(it, Cause.PROGRAM, str(error))
        return
    it.begin(after)
    it.running = ready


def _next(it: Controller, job: Job, made: Ready, ready: Ready) -> Job:
    options = Options(
        optional_stop=job.options.optional_stop, block_by_block=job.options.block_by_block, dark=job.options.dark,
        feed=it.overrides.feed, rapid=it.overrides.rapid, spindle=it.overrides.spindle,
    )  # fmt: skip
    after = Job(ready.plan, it.machine, options, origin=it.report.executed, ahead=it.ahead, asks=ready.asks, after=job)
    after.rest_first()
    program = ready.plan.program
    after.entry = Entry(program=program, move=made.moves, way=0, place=program.start, told="")
    return after


def _answer(it: Controller, job: Job) -> Answer:
    """Return what the machine says to the question at a job's end."""
    if not isinstance(job.asks, Probe):
        return Read(job.read)
    place = it.position()
    rest = tuple(place.get(letter, 0.0) for letter in AXES)
    caught = it.report.caught
    if caught is None:
        return Probed(rest, rest, touched=False)
    found = axes_of(it.machine, caught[1])
    at = {axis.name: float(value) for axis, value in zip(it.machine.axes, found, strict=True)}
    return Probed(tuple(at.get(letter, 0.0) for letter in AXES), rest)


def _fail(it: Controller, cause: Cause, text: str) -> None:
    """Give the job up at rest."""
    it.end(whole=False)
    it.fault(Trouble(cause=cause), text)
    it.pending.append(Orders(watch=()))
