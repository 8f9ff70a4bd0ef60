"""What an importer hands back: a machine file's tables, and an account of every setting it met."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from trochia.errors import ConfigError, Source, UnitError
from trochia.units import parse_ratio, render_fraction

if TYPE_CHECKING:
    from collections.abc import Callable
    from fractions import Fraction


NO_PLACE = "no place in a machine file"  #: why most settings of other controllers are not mapped


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """One setting of a foreign file: section (empty where there are none), name, value as text, line from 1."""

    section: str
    name: str
    value: str
    line: int

    @property
    def full_name(self) -> str:
        """Name as its own documentation writes it: ``[JOINT_0]SCALE``, ``$110``."""
        return f"[{self.section}]{self.name}" if self.section else self.name


@dataclass(frozen=True, slots=True, kw_only=True)
class Unmapped:
    """A setting that has no place in the machine file, or that could not be read, and why."""

    setting: Setting
    why: str


@dataclass(slots=True, kw_only=True)
class Imported:
    """Tables of a machine file under construction.

    Attributes
    ----------
    document
        As TOML would hold it; :func:`trochia.machine.read.read` makes the Machine of it.
    assumed
        What the foreign file does not say and was taken, one sentence each.
    """

    document: dict[str, Any] = field(default_factory=dict[str, Any])
    unmapped: list[Unmapped] = field(default_factory=list[Unmapped])
    assumed: list[str] = field(default_factory=list[str])

    def assume(self, sentence: str) -> None:
        """Note an assumption, once."""
        if sentence not in self.assumed:
            self.assumed.append(sentence)


@dataclass(frozen=True, slots=True, kw_only=True)
class Importer:
    """One foreign format: its name, what recognises a text of it, what reads one (text, file name)."""

    kind: str
    title: str
    recognises: Callable[[str], bool]
    read: Callable[[str, str], Imported]


class Settings:
    """The settings of a foreign file, of which every one is taken or reported."""

    def __init__(self, settings: list[Setting], file: str, *, first_wins: bool = False) -> None:
        self.file = file
        self._settings = settings
        self._winner = 0 if first_wins else -1
        self._taken: set[int] = set()
        self._why: dict[int, str] = {}

    def sections(self) -> list[str]:
        """Return the names of the sections, in order, each once."""
        return list(dict.fromkeys(setting.section for setting in self._settings))

    def find(self, section: str, name: str) -> list[Setting]:
        """Return every line of a setting; none of them counts as mapped by that."""
        return [setting for setting in self._settings if setting.section == section and setting.name == name]

    def take(self, section: str, *names: str) -> Setting | None:
        """Return the first of these settings that is there, counted as mapped; lines that lose to it are reported."""
        for name in names:
            if found := self.find(section, name):
                winner = found[self._winner]
                self._taken.add(id(winner))
                self._why.update((id(setting), f"line {winner.line} gives it again") for setting in found)
                return winner
        return None

    def leave(self, section: str, name: str, why: str) -> None:
        """Report a setting as not mapped, for a reason of its own."""
        for setting in self.find(section, name):
            self._taken.discard(id(setting))
            self._why[id(setting)] = why

    def number(self, section: str, *names: str) -> Fraction | None:
        """Return a setting as an exact number, or None where it is not there.

        Raises
        ------
        ConfigError
            With file and line, when it is no number.
        """
        setting = self.take(section, *names)
        if setting is None:
            return None
        try:
            return parse_ratio((setting.value.split() or [""])[0])
        except UnitError:
            raise self.error(setting, f"expected a number, not {setting.value!r}") from None

    def error(self, setting: Setting, message: str, *, hint: str | None = None) -> ConfigError:
        """Return an error about a setting, in its place."""
        return ConfigError(message, key=setting.full_name, source=Source(self.file, setting.line), hint=hint)

    def missing(self, section: str, what: str, *, hint: str | None = None) -> ConfigError:
        """Return an error about something that a section should hold, placed at its first line."""
        line = next((setting.line for setting in self._settings if setting.section == section), 1)
        return ConfigError(f"expected {what} in the section [{section}]", source=Source(self.file, line), hint=hint)

    def unmapped(self) -> list[Unmapped]:
        """Return what nobody took, in the file's order."""
        return [
            Unmapped(setting=setting, why=self._why.get(id(setting), NO_PLACE))
            for setting in self._settings
            if id(setting) not in self._taken
        ]


def quantity(value: Fraction, unit: str) -> str:
    """Return an exact number with a unit; a plain decimal where it has one."""
    text = render_fraction(value)
    return f"{text} {unit}" if "/" not in text else f"{float(value)!r} {unit}"


def exact(value: Fraction, unit: str) -> str:
    """Return an exact number with a unit, as a fraction where it has no finite decimal."""
    return f"{render_fraction(value)} {unit}"
