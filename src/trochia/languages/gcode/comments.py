"""Comments that act: ``(MSG,)``, ``(DEBUG,)``, ``(PRINT,)``, ``(LOG,)`` and its files, ``(ABORT,)``.

In: the text of a comment.  Out: calls to the sink.  All but MSG show parameters: ``#5`` or ``#<name>`` stands for its
value, in a format set by ``%d`` (a whole number), ``%f`` (four decimals) or ``%.3f`` before it.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from trochia.errors import ProgramError, UnknownCodeError, VariableError
from trochia.languages.gcode.parameters import TELLS_DEBUG

if TYPE_CHECKING:
    from trochia.languages.gcode.parameters import Parameters
    from trochia.languages.gcode.place import Place
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State

KINDS = {
    "msg": "tells the operator a text as it is", "debug": "tells a text with values, unless #5599 is 0",
    "print": "tells a text with values", "log": "writes a text with values into the log that is open",
    "logopen": "begins a log file", "logappend": "goes on with a log file", "logclose": "closes the log",
    "abort": "ends the program with an error", "py": "is refused: a part program runs no other language",
}  #: word -> what a comment that begins with it does  # fmt: skip
_BARE = "logclose"  # the one that has no text
_KIND = re.compile(rf"({'|'.join(kind for kind in KINDS if kind != _BARE)}),|({_BARE})$", re.IGNORECASE)
_PART = re.compile(r"%(d|f|\.[0-9]f)|(%\.)|#<([^>]*)(>?)|#([0-9]+)")
_UNKNOWN = "######"
_DECIMALS, _FEWER = 6, 4


def act(text: str, place: Place, state: State, sink: Sink) -> None:
    """Let a comment act, or pass it on.

    Raises
    ------
    ProgramError
        For ``(ABORT, why)``.
    UnknownCodeError
        For ``(PY, ...)``, which this interpreter does not run.
    """
    kind = _KIND.match(text)
    if kind is None:
        sink.comment(text)
        return
    name, rest = (kind.group(1) or kind.group(2)).lower(), text[kind.end() :]
    if name == "msg":
        sink.message(rest)
    elif name == "debug":
        if state.parameters.numbered[TELLS_DEBUG]:
            sink.message(shown(rest, state.parameters))
    elif name == "print":
        sink.say(shown(rest, state.parameters))
    elif name == "abort":
        raise place.fault(ProgramError, shown(rest, state.parameters) or "the program aborts itself",
                          hint="A comment (ABORT, ...) of the program stops it here.")  # fmt: skip
    elif name == "py":
        raise place.fault(UnknownCodeError, "Python in comments is not run here", hint="Take the comment away.")
    else:
        _log(name, rest, place, state, sink)


def _log(name: str, rest: str, place: Place, state: State, sink: Sink) -> None:
    """Open, fill or close the log, which lies in the program's folder."""
    if name == "log":
        sink.log(shown(rest, state.parameters))
    elif name == "logclose":
        sink.close_log()
    else:
        parts = rest.strip().replace("\\", "/").split("/")
        if parts[0] == "" or ":" in parts[0] or ".." in parts:
            raise place.fault(ProgramError, f"the log file {rest.strip()!r} leads out of the program's folder",
                              hint="Name it without a folder, like log.txt.")  # fmt: skip
        sink.open_log(rest, append=name == "logappend")


def shown(text: str, parameters: Parameters) -> str:
    """Return a text with its parameters' values; what has none is shown as ``######``."""
    parts: list[str] = []
    at, decimals = 0, _DECIMALS
    for match in _PART.finditer(text):
        parts.append(text[at : match.start()])
        at = match.end()
        form, lone, name, closed, number = match.groups()
        if form is not None:
            decimals = 0 if form == "d" else _FEWER if form == "f" else int(form[1])
        elif lone is not None:
            parts.append(".")
        elif name is None:
            parts.append(_number(_numbered(int(number), parameters), decimals))
        elif closed:
            parts.append(_number(parameters.find("".join(name.lower().split())), decimals))
        else:
            at = len(text)  # the name is not closed: it takes the rest
    return "".join(parts) + text[at:]


def _numbered(number: int, parameters: Parameters) -> float | None:
    try:
        return parameters.get(number) if number else 0.0
    except VariableError:
        return None


def _number(value: float | None, decimals: int) -> str:
    if value is None:
        return _UNKNOWN
    text = f"{value:.{decimals}f}"
    return text[1:] if text[0] == "-" and not text.strip("-0.") else text
