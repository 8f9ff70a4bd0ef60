"""How a program is begun: from its start, inside it, or where it was interrupted.

In: the controller, a program.  Out: a job under way, and what to tell whoever asked.  Everything is planned before
anything moves; what must not be is refused.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from trochia.backends.live import Orders
from trochia.controller.doings import check
from trochia.controller.interrupted import work_entry
from trochia.controller.job import Job, Options
from trochia.controller.readying import MDI
from trochia.controller.rerun import entry, move_of_line
from trochia.errors import LocalProtocolError, OutOfTravelError
from trochia.program import AXES, Probe

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.controller.controller import Controller
    from trochia.controller.readying import Ready
    from trochia.controller.rerun import Entry
    from trochia.messages import command as c

LEAST = 0.01  #: override of feed or rapid below which motion is held
STAYS = 1e-6  #: extent of an axis that does not move [mm or degree]


def known(it: Controller) -> bool:
    """Whether the positions of all axes are known."""
    return all(it.trusted.values())


def start(it: Controller, *, block_by_block: bool) -> str:
    """Run the program that is loaded."""
    name, text = _loaded(it)
    check_known(it)
    return begin(it, text, name, block_by_block=block_by_block)


def run_from(it: Controller, command: c.RunFrom, _now: float) -> str:
    """Run from a line, or from where a job was interrupted; asked without ``confirmed`` only tell the way."""
    check_known(it)
    check_overrides(it)
    if command.line == 0:
        made, move, place = _interrupted(it)
    else:
        name, text = _loaded(it)
        made = _asked(it, it.readier.ready(text, name, work=it.work, at=it.position(),
                                           block_delete=it.switches.block_delete))  # fmt: skip
        move, place = _line(made, command.line), None
    here = it.position()
    inside = entry(made.plan.program, move, it.machine, at=np.array([here.get(a, 0.0) for a in AXES]),
                   tool=it.work.tool, place=place)  # fmt: skip
    ready = it.readier.inside(made, inside.program, exact=it.switches.single_block)
    if not command.confirmed:
        return f"the way to {inside.told}; the same command, confirmed, goes"
    return _go(it, ready, block_by_block=it.switches.single_block, inside=inside)


def plan_here(it: Controller, text: str, name: str, *, exact: bool = False) -> Ready:
    """Return the plan of a text from where the machine is."""
    return it.readier.ready(text, name, work=it.work, at=it.position(), block_delete=it.switches.block_delete,
                            exact=exact, bounded=known(it))  # fmt: skip


def begin(it: Controller, text: str, name: str, *, block_by_block: bool) -> str:
    """Plan a text from here and run it."""
    check_overrides(it)
    made = plan_here(it, text, name, exact=block_by_block)
    made = _asked(it, made, exact=block_by_block)
    for axis in it.machine.axes:
        low, high = made.plan.extents.get(axis.name, (0.0, 0.0))
        if not it.trusted[axis.name] and high - low > STAYS:
            raise LocalProtocolError(f"nobody knows where {axis.name} stands", hint="Home it first, or jog.")
        if it.trusted[axis.name] and not known(it) and not axis.minimum - STAYS <= low <= high <= axis.maximum + STAYS:
            raise OutOfTravelError(f"{axis.name} would go from {low:g} to {high:g} {axis.unit}, its travel is "
                                   f"{axis.minimum:g} to {axis.maximum:g}")  # fmt: skip
    return _go(it, made, block_by_block=block_by_block)


def _go(it: Controller, made: Ready, *, block_by_block: bool, inside: Entry | None = None) -> str:
    """Begin a job of what is planned."""
    it.panel.check_safe(it)
    told = [f"{made.plan.time_s:.1f} s", it.logs.check(made.plan.program.actions), limit_feed(it, made.most)]
    options = Options(
        optional_stop=it.switches.optional_stop, block_by_block=block_by_block,
        dark=it.switches.dry_run, feed=it.overrides.feed, rapid=it.overrides.rapid, spindle=it.overrides.spindle,
    )  # fmt: skip
    job = Job(made.plan, it.machine, options, origin=it.report.executed, ahead=it.ahead, asks=made.asks)
    job.entry = inside
    it.begin(job)
    it.running = made
    it.pending.append(Orders(lit=it.lightable and not it.switches.dry_run, watch=()))
    if made.name != MDI and not it.lock.shut:
        it.interrupted = None
        start = dict(zip(AXES, (float(at) for at in made.start), strict=True))
        it.note("job", name=made.name, program=made.text, start=start, work=work_entry(made.found),
                block_delete=it.switches.block_delete, seconds=made.plan.time_s)  # fmt: skip
    return "; ".join(text for text in told if text)


def limit_feed(it: Controller, most: float) -> str:
    """Lower the override of the feed to what the board can do; return what to tell, if it was higher."""
    if it.overrides.feed <= most:
        return ""
    it.overrides = msgspec.structs.replace(it.overrides, feed=max(math.floor(100.0 * most) / 100.0, 1.0))
    return f"feed override limited to {100.0 * it.overrides.feed:.0f} %: the board can make no more steps"


def _asked(it: Controller, made: Ready, *, exact: bool = False) -> Ready:
    """Return the plan up to the program's first question to the machine, if it has any."""
    if not made.asking:
        return made
    check_known(it)
    check(made.plan.program, it.machine)
    if it.lock.shut and any(isinstance(act, Probe) for act in made.plan.program.actions):
        raise LocalProtocolError("nothing is probed under the machine lock", hint="Turn it off first.")
    return it.readier.ready(made.text, made.name, work=it.work, at=it.position(), block_delete=made.block_delete,
                            exact=exact, answers=())  # fmt: skip


def _line(made: Ready, line: int) -> int:
    """Return the number of the first move of a line."""
    if made.asks is not None and line > made.asks.line:
        raise LocalProtocolError(f"line {line} stands behind line {made.asks.line}, whose outcome nobody knows yet",
                                 hint="Run from that line, or one before it.")  # fmt: skip
    return move_of_line(made.plan.program, line)


def check_overrides(it: Controller) -> None:
    """Refuse to move under an override of 0."""
    if min(it.overrides.feed, it.overrides.rapid) < LEAST:
        raise LocalProtocolError("an override is 0: nothing would move", hint="Raise it to 1 % at least, then go on.")


def check_known(it: Controller) -> None:
    """Refuse to run a program where a position is not known."""
    lost = [name for name, known in it.trusted.items() if not known]
    if lost:
        raise LocalProtocolError(f"nobody knows where {' '.join(lost)} stands", hint="Home first.")


def _loaded(it: Controller) -> tuple[str, str]:
    if it.loaded is None:
        raise LocalProtocolError("no program is loaded", hint="Load one first.")
    return it.loaded


def _interrupted(it: Controller) -> tuple[Ready, int, NDArray[np.float64]]:
    """Return the plan of the job that was interrupted, and where to go on."""
    job = it.interrupted
    if job is None:
        raise LocalProtocolError("no job was interrupted", hint="Name the line to run from.")
    if not job.text:
        raise LocalProtocolError(f"the text of {job.name} was not kept", hint="Load it, and name the line to run from.")
    work = job.set_up(it.work)
    made = it.readier.ready(job.text, job.name, work=work, at=job.start, block_delete=job.block_delete)
    if made.asking:
        made = it.readier.ready(job.text, job.name, work=work, at=job.start, block_delete=job.block_delete,
                                answers=job.answers)  # fmt: skip
    it.loaded, it.preview = (job.name, job.text), made
    return made, min(job.move, max(len(made.plan.program.moves) - 1, 0)), job.place(AXES)
