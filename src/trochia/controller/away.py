"""A job whose tool is taken away from the part while it is held, and back before it goes on.

In: a job at rest in a hold, how far up.  Out: straight moves, and a job whose clock has stood still meanwhile.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.controller.job import Job
from trochia.controller.jog import Jog
from trochia.controller.states import TABLE, Event, State

if TYPE_CHECKING:
    from trochia.controller.controller import Controller

LEAST = 1e-3  #: a shorter way up is none [mm]


class Away:
    """One job and its place [mm or degree], by axis."""

    def __init__(self, job: Job, place: dict[str, float], executed: float) -> None:
        self.job, self.place = job, place
        self._executed = executed

    def stand_still(self, executed: float) -> None:
        """Let the job's clock not count what was run through since it was held."""
        self.job.feeder.origin += executed - self._executed
        self._executed = executed


def leave(it: Controller, job: Job) -> bool:
    """Go up with the tool, as far as is asked for and there is room; False: there is no way up."""
    panel = it.machine.panel
    z = next((axis for axis in it.machine.axes if axis.name == "Z"), None)
    if panel is None or panel.retract is None or z is None or not it.trusted["Z"]:
        return False
    place = it.position()
    up = min(place["Z"] + panel.retract, z.maximum)
    if up - place["Z"] < LEAST:
        return False
    it.away = Away(job, place, it.report.executed)
    _move(it, up, z.velocity)
    return True


def go_back(it: Controller, away: Away) -> None:
    """Go to where the job was held."""
    away.stand_still(it.report.executed)
    z = next(axis for axis in it.machine.axes if axis.name == "Z")
    _move(it, away.place["Z"], z.velocity / 2.0)


def _move(it: Controller, to: float, speed: float) -> None:
    """Move Z."""
    made = it.readier.ready(f"G21 G90 G94 G53 G1 Z{to:.9f} F{60.0 * speed:.9f}\nM2\n", "<away>",
                            work=it.work.__class__(), at=it.position(), bounded=False, ours=True)  # fmt: skip
    it.begin(Jog(made.plan, it.machine, origin=it.report.executed, ahead=it.ahead, now=it.report.time))


def detour(it: Controller) -> bool:
    """Take the tool of a job that rests in a hold away, or let the job go on with its tool back.

    Return whether that is what rest was for; else it means what it always does, with the job under way.
    """
    activity, leaving = it.activity, it.leaving
    it.leaving = False
    if it.away is None:
        if not (leaving and it.state is State.HOLDING and isinstance(activity, Job) and leave(it, activity)):
            return False
        it.enter(TABLE[it.state, Event.AWAY])
        return True
    job = it.away.job
    it.settle()
    if it.state is not State.RESUMING:
        return False
    it.away = None
    it.back = job.resume(it.report, feed=it.overrides.feed, rapid=it.overrides.rapid)
    return True
