"""One exception tree: what the caller got wrong, where, and what to do about it.

TrochiaError
├─ ProgramError(source)   ParseError · UnknownCodeError · ModalConflictError · VariableError
├─ MachineError           ConfigError · UnitError
├─ PlanningError(source)  OutOfTravelError · LimitError · RunInError
├─ JobError(source)
├─ RecordingError
└─ LinkError              LocalProtocolError · RemoteProtocolError · VersionMismatch · LinkTimeout

What a *machine* does wrong is never an exception; it is a ``Fault``, which is data.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Source:
    """A place in a text: file name, line and column counted from 1 (column 0: the whole line)."""

    file: str
    line: int
    column: int = 0

    def __str__(self) -> str:
        place = f"{self.file}:{self.line}"
        return f"{place}:{self.column}" if self.column else place


class TrochiaError(Exception):
    """A user's mistake, told in one message.

    Parameters
    ----------
    message
        What is wrong and what was expected, in one sentence.
    source
        Where, if it is a place in a text.
    text
        The line itself, for the caret.
    hint
        What to do about it.
    """

    code = "error"  # stable name of the mistake, for scripts: the `code` key of `check --json`

    def __init__(
        self, message: str, *, source: Source | None = None, text: str | None = None, hint: str | None = None
    ) -> None:
        super().__init__(message)
        self.message = message
        self.source = source
        self.text = text
        self.hint = hint

    def __str__(self) -> str:
        """Return the whole report: place and message, the line with a caret, and the remedy."""
        lines = [f"{self.source}: {self.message}" if self.source else self.message]
        if self.text is not None and self.source is not None:
            shown = self.text.rstrip("\r\n").replace("\t", " ")
            lines.append(f"    {shown}")
            if self.source.column:
                lines.append("    " + " " * (self.source.column - 1) + "^")
        if self.hint:
            lines.append(f"  {self.hint}")
        return "\n".join(lines)


class ProgramError(TrochiaError):
    """The part program is at fault."""

    code = "program"


class ParseError(ProgramError):
    """The line cannot be read."""

    code = "parse"


class UnknownCodeError(ProgramError):
    """A word or code this dialect does not have."""

    code = "unknown-code"


class ModalConflictError(ProgramError):
    """Codes that cannot stand together, or a code the present mode forbids."""

    code = "modal-conflict"


class VariableError(ProgramError):
    """A parameter that does not exist or cannot be set."""

    code = "variable"


class MachineError(TrochiaError):
    """The machine file is at fault; ``key`` is the dotted name of what is wrong, when it is one key."""

    code = "machine"

    def __init__(
        self,
        message: str,
        *,
        key: str | None = None,
        source: Source | None = None,
        text: str | None = None,
        hint: str | None = None,
    ) -> None:
        super().__init__(f"{key}: {message}" if key else message, source=source, text=text, hint=hint)
        self.key = key
        self.plain = message  # without the key, for whoever knows the key's full name


class ConfigError(MachineError):
    """A key that is missing, unknown, or has a value that cannot be."""

    code = "config"


class UnitError(MachineError):
    """A quantity without a unit, or of the wrong dimension."""

    code = "unit"


class PlanningError(TrochiaError):
    """The program is well formed, but this machine cannot do it."""

    code = "planning"


class OutOfTravelError(PlanningError):
    """Motion would leave an axis' travel."""

    code = "travel"


class LimitError(PlanningError):
    """A limit that is zero, missing or contradictory, or a motion that no limit allows."""

    code = "limit"


class RunInError(PlanningError):
    """Too little way to reach synchronous speed."""

    code = "run-in"


class JobError(TrochiaError):
    """A drawing or part that cannot be taken."""

    code = "job"


class RecordingError(TrochiaError):
    """A recording that cannot be read, written or compared."""

    code = "recording"


class LinkError(TrochiaError):
    """The connection to a controller failed."""

    code = "link"


class LocalProtocolError(LinkError):
    """We would have broken the protocol."""

    code = "protocol-local"


class RemoteProtocolError(LinkError):
    """The other side broke the protocol."""

    code = "protocol-remote"


class VersionMismatch(LinkError):  # noqa: N818 - the plan of the house names it so
    """Both sides speak, but not the same schema."""

    code = "version"


class LinkTimeout(LinkError):  # noqa: N818 - likewise
    """No answer in time."""

    code = "timeout"
