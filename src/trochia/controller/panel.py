"""The inputs that guard people: door, interlock, the beam's key, the emergency stop; and drives that nobody uses.

In: reports.  Out: holds, faults, beams that may not be lit, drives switched off.  What each input does is told in
:class:`trochia.machine.panel.Panel`; a machine file without one asks for none of it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.backends.live import Orders, Trouble
from trochia.controller.states import MOVING, TABLE, Event, State
from trochia.errors import LocalProtocolError
from trochia.messages import Cause

if TYPE_CHECKING:
    from trochia.controller.controller import Controller
    from trochia.machine.panel import Panel

#: states in which an open door brakes what moves; a jog goes on: whoever jogs may have to reach in
_BRAKED = MOVING - {State.JOGGING, State.HOLDING, State.RETRACTING, State.STOPPING}
_QUIET = frozenset({State.OFF, State.ESTOP, State.ALARM})


class Watch:
    """The watch over one machine's panel."""

    def __init__(self, panel: Panel | None) -> None:
        self._panel = panel
        self._lit = True  # whether the beam may be lit, at the last look
        self._used = 0.0  # when the drives were last of use

    def active(self, it: Controller, key: str) -> bool:
        """Whether an input of the panel is active; one that the machine does not have is not."""
        name = None if self._panel is None else self._panel.inputs.get(key)
        return name is not None and bool(it.report.inputs.get(name))

    def dark(self, it: Controller) -> str:
        """Return why the beam may not be lit; empty: it may."""
        if self.active(it, "door"):
            return "the door is open"
        if self.active(it, "interlock"):
            return "the interlock is broken"
        if self._panel is not None and self._panel.arm is not None and not self.active(it, "arm"):
            return "the beam's key is off"
        return ""

    def check_safe(self, it: Controller) -> None:
        """Refuse to run a program with the door open, or its beam without the key.

        Raises
        ------
        LocalProtocolError
            With what to do first.
        """
        if self.active(it, "door"):
            raise LocalProtocolError("the door is open", hint="Close it, then ask again.")
        why = self.dark(it)
        if why and it.armed and it.machine.beam is not None and not it.switches.dry_run:
            raise LocalProtocolError(why, hint="Turn it on, or run dry, or disarm the beam.")

    def look(self, it: Controller, now: float) -> None:
        """Do what the inputs ask for now."""
        if self._panel is None:
            return
        if self.active(it, "estop") and it.state is not State.ESTOP:
            it.stop_now()
            return
        if self.active(it, "interlock") and it.state not in _QUIET:
            it.fault(Trouble(cause=Cause.DOOR), f"the interlock {self._panel.interlock} is broken")
        dark = self.dark(it)
        if dark and self._lit:
            it.pending.append(Orders(lit=False))
        self._lit = not dark
        if self.active(it, "door"):
            self._brake(it, "the door is open: close it, then resume")
        elif dark and it.job is not None and not it.job.options.dark and it.armed:
            self._brake(it, f"{dark}: turn it on, then resume")
        self._release(it, now)

    def _brake(self, it: Controller, text: str) -> None:
        """Brake what moves; a program can be gone on with, its spindle stopped meanwhile."""
        if it.state not in _BRAKED or it.activity is None:
            return
        it.activity.hold(it.report, it.latency)
        it.enter(TABLE[it.state, "hold"])
        it.note("guard", text=text)
        if it.job is not None and it.state is State.HOLDING:
            it.stop_spindle()
            it.leaving = it.away is None
            it.ask("guard", text)

    def _release(self, it: Controller, now: float) -> None:
        """Switch drives off that nobody has used for a while."""
        wait = None if self._panel is None else self._panel.idle_release
        if it.state is not State.IDLE:
            self._used = now
        elif wait is not None and now - max(self._used, it.asked) >= wait:
            it.pending.append(Orders(enable=False, lit=False))
            it.note("release", text=f"nothing was asked for in {wait:g} s: drives off")
            it.enter(TABLE[it.state, Event.RELEASED])
