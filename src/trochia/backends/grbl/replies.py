"""What GRBL says, line by line.  In: a line without its end.  Out: what it is, as data; anything else is noise."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from trochia.backends.program import Doing

if TYPE_CHECKING:
    from collections.abc import Mapping

_WELCOME = re.compile(r"Grbl (\S+) \[.*\]\Z")
_ANSWER = re.compile(r"(error|ALARM):(\d{1,3})\Z")
_SETTING = re.compile(r"\$(\d{1,3}|N\d)=(.*)\Z")
_TOLD = re.compile(r"\[([A-Za-z0-9.]+):(.*)\]\Z")
_STATUS = re.compile(r"<([A-Za-z]+)(?::(\d))?((?:\|[A-Za-z]+:[^|<>]*)*)>\Z")
_STARTUP = re.compile(r">.*:(ok|error:\d+)\Z")

DOING = {
    "Idle": Doing.IDLE, "Run": Doing.RUN, "Hold": Doing.HOLD, "Jog": Doing.JOG, "Alarm": Doing.ALARM,
    "Door": Doing.DOOR, "Check": Doing.CHECK, "Home": Doing.HOME, "Sleep": Doing.SLEEP,
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Ok:
    """A line was taken."""


@dataclass(frozen=True, slots=True)
class Error:
    """A line was refused."""

    number: int


@dataclass(frozen=True, slots=True)
class Alarm:
    """The board has stopped by itself."""

    number: int


@dataclass(frozen=True, slots=True)
class Welcome:
    """The board has started, or was reset."""

    version: str


@dataclass(frozen=True, slots=True)
class Setting:
    """One setting or startup line: its name with the $, its value."""

    name: str
    value: str


@dataclass(frozen=True, slots=True)
class Told:
    """Something in brackets: ``[OPT:V,15,128]``."""

    name: str
    value: str


@dataclass(frozen=True, slots=True)
class StatusLine:
    """A status report: what it does, the digit behind that (-1: none), its fields as they stand."""

    doing: Doing
    digit: int
    fields: Mapping[str, str] = field(default_factory=dict[str, str])


@dataclass(frozen=True, slots=True)
class Noise:
    """Nothing GRBL says."""

    text: str


Reply = Ok | Error | Alarm | Welcome | Setting | Told | StatusLine | Noise


def parse(line: str) -> Reply:  # noqa: PLR0911 - one return a kind of line
    """Return what a line says."""
    if line == "ok":
        return Ok()
    if match := _STATUS.match(line):
        return _status(match, line)
    if match := _ANSWER.match(line):
        return (Error if match[1] == "error" else Alarm)(int(match[2]))
    if match := _SETTING.match(line):
        return Setting(f"${match[1]}", match[2])
    if match := _TOLD.match(line):
        return Told(match[1], match[2])
    if match := _WELCOME.match(line):
        return Welcome(match[1])
    if _STARTUP.match(line):
        return Told("startup", line)
    return Noise(line)


def numbers(text: str) -> tuple[float, ...] | None:
    """Return numbers separated by commas; None where one cannot be read."""
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        return None


def _status(match: re.Match[str], line: str) -> StatusLine | Noise:
    if match[1] not in DOING:
        return Noise(line)
    fields = dict(part.split(":", 1) for part in match[3].split("|") if part)
    wanted = ("MPos", "WPos", "WCO", "Bf", "FS", "F", "Ov", "Ln")
    if any(numbers(fields[name]) is None for name in wanted if name in fields):
        return Noise(line)
    return StatusLine(DOING[match[1]], int(match[2]) if match[2] else -1, fields)
