"""Lines that begin with ``$``.  In: such a line.  Out: what it tells; the machine file is never changed from here."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from trochia.gateways.grbl.modes import Modes, Refused, words_of
from trochia.gateways.grbl.queue import MOST, Home, Jog
from trochia.gateways.grbl.reports import machine_position, offsets, origin_of
from trochia.gateways.grbl.settings import settings_of
from trochia.messages import command as c

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.gateways.grbl.session import Session

_HELP = "[HLP:$$ $# $G $I $N $x=val $J=line $SLP $C $X $H ~ ! ? ctrl-x]"
_SETTING = re.compile(r"\$(\d+)=([\d.]+)\Z")
_NUMBER = re.compile(r"N(\d+)")
_JOG_CODES = frozenset({"G20", "G21", "G90", "G91", "G53"})
_READ_ONLY = "[MSG:settings are those of the machine file; change them there]"


def number_of(line: str) -> int:
    """Return a line's N, or 0."""
    match = _NUMBER.match(line)
    return int(match[1]) if match else 0


def run(session: Session, line: str, now: float) -> bool:
    """Do what a line asks; return whether its answer is owed until later.

    Raises
    ------
    Refused
        With the number of the error.
    """
    del now
    if line.startswith("$J="):
        _jog(session, line[3:])
    elif line in _SAYS:
        if line in _AT_REST and not session.at_rest():
            raise Refused(8)
        for text in _SAYS[line](session):
            session.say(text)
    elif line in {"$H", "$HX", "$HY", "$HZ"}:
        return _home(session)
    elif line == "$X":
        session.unlock()
        session.say("[MSG:Caution: Unlocked]")
    elif line == "$C":
        _check(session)
    elif line == "$SLP":
        session.ask(c.Disable())
    else:
        _set(session, line)
    return False


def _settings(session: Session) -> list[str]:
    found = settings_of(session.runtime.controller.machine, session.reporter.mask)
    return [f"{name}={value}" for name, value in found.items()]


_SAYS: dict[str, Callable[[Session], list[str]]] = {
    "$": lambda _: [_HELP],
    "$$": _settings,
    "$#": lambda session: offsets(session.runtime.controller.work),
    "$G": lambda session: [session.modes.shown()],
    "$I": lambda _: ["[VER:1.1h.20190830:Trochia]", f"[OPT:VNM,{MOST},128]"],
    "$N": lambda _: ["$N0=", "$N1="],
}
_AT_REST = frozenset({"$$", "$#", "$I", "$N"})


def _home(session: Session) -> bool:
    if not any(axis.home is not None for axis in session.runtime.controller.machine.axes):
        raise Refused(5)
    if session.status.state != "idle" or session.busy:
        raise Refused(8)
    session.add(Home())
    return True


def _check(session: Session) -> None:
    """Switch check mode; switching it off resets, as GRBL does."""
    if session.checking:
        session.reset()
    elif session.at_rest():
        session.checking = True
        session.say("[MSG:Enabled]")
    else:
        raise Refused(8)


def _set(session: Session, line: str) -> None:
    """Take the one setting that is the sender's own: what status reports show."""
    match = _SETTING.match(line)
    if match is None or f"${int(match[1])}" not in settings_of(session.runtime.controller.machine, 0):
        raise Refused(3)
    if match[1] != "10":
        session.say(_READ_ONLY)
        raise Refused(3)
    session.reporter.mask = int(float(match[2])) & 0xFF


def _jog(session: Session, line: str) -> None:
    """Queue a jog within the travel."""
    if session.locked and any(not axis.trusted for axis in session.status.axes) and session.status.state != "idle":
        raise Refused(9)
    if session.status.state not in {"idle", "jogging"} or session.text is not None:
        raise Refused(8)
    codes, values = words_of(line)
    if set(codes.values()) - _JOG_CODES or set(values) - set("FNXYZ"):
        raise Refused(16)
    if not values.get("F", 0.0) > 0.0:
        raise Refused(22)
    axes = {letter: value for letter, value in values.items() if letter in "XYZ"}
    if not axes:
        raise Refused(26)
    modes: Modes = session.modes
    scale = 25.4 if codes.get("units", modes.codes["units"]) == "G20" else 1.0
    absolute = codes.get("distance", modes.codes["distance"]) == "G90"
    origin = [0.0] * 3
    if codes.get("once") != "G53":
        origin = origin_of(session.runtime.controller.work, int(modes.codes["system"][1:]) - 53)
    way = {axis: value * scale for axis, value in axes.items()}
    if absolute:
        way = {axis: value + origin["XYZ".index(axis)] for axis, value in way.items()}
    _add(session, way, values["F"] * scale / 60.0, absolute=absolute)


def _add(session: Session, way: dict[str, float], speed: float, *, absolute: bool) -> None:
    """Queue a jog as a way from where the jogs before it end; refuse one that leaves the travel."""
    here = dict(zip("XYZ", machine_position(session.status), strict=True))
    ends = session.jog_ends or here
    end = {axis: value if absolute else ends[axis] + value for axis, value in way.items()}
    axes = {axis.name: axis for axis in session.runtime.controller.machine.axes}
    trusted = {axis.name: axis.trusted for axis in session.status.axes}
    for name, value in end.items():
        if name not in axes:
            raise Refused(16)
        if trusted[name] and not axes[name].minimum - 1e-6 <= value <= axes[name].maximum + 1e-6:
            raise Refused(15)
    session.jog_ends = {**ends, **end}
    session.add(Jog(end, min([speed, *(axes[name].velocity for name in end)])))
