"""Variables that are worked out when they are read.

In: tables that say how each is made, and the state they ask.  Out: :class:`ComputedTable`, which makes one only when a
program names it: most programs name none, and there are some two hundred.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Generic, NamedTuple, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

_Key = TypeVar("_Key", int, str)


class Computed(NamedTuple):
    """A variable that is worked out when it is read; ``write`` is None where a program may not set it."""

    read: Callable[[], float]
    write: Callable[[float], None] | None = None


class ComputedTable(Generic[_Key]):
    """Computed variables by number or by name."""

    __slots__ = ("_made", "_sources")

    def __init__(self) -> None:
        self._made: dict[_Key, Computed] = {}
        self._sources: list[tuple[Mapping[_Key, Callable[..., Computed]], object]] = []

    def offer(self, makers: Mapping[_Key, Callable[..., Computed]], source: object) -> None:
        """Let the variables of a table exist; each is made of ``source`` when it is first asked for."""
        self._sources.append((makers, source))

    def __setitem__(self, key: _Key, variable: Computed) -> None:
        """Let a variable exist."""
        self._made[key] = variable

    def get(self, key: _Key) -> Computed | None:
        """Return a variable, or None where there is none."""
        found = self._made.get(key)
        if found is None:
            for makers, source in self._sources:
                if key in makers:
                    found = self._made[key] = makers[key](source)
                    break
        return found

    def __contains__(self, key: _Key) -> bool:
        """Return whether there is such a variable."""
        return key in self._made or any(key in makers for makers, _ in self._sources)
