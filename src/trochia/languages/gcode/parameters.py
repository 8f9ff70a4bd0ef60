"""The variables of a program: numbered, named, and computed ones.

In: what the program assigns, what handlers set, and functions for what is computed.  Out: values.  Whoever runs a
program gives it one :class:`Parameters`; a live controller gives one whose computed variables ask the machine.

Numbered variables are 1 to 5601.  Names are in lower case without blanks; those that begin with ``_`` are global, the
others belong to the subroutine that runs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from trochia.errors import VariableError
from trochia.languages.gcode.computed import ComputedTable

if TYPE_CHECKING:
    from collections.abc import Iterable

LAST = 5601  #: greatest number
ARGUMENTS = 30  #: #1 to #30 belong to the subroutine that runs
PERSISTENT = range(31, 5001)  #: a parameter file keeps those of them that it names
READ_ONLY = frozenset((*range(5400, 5414), *range(5420, 5429)))
TELLS_DEBUG = 5599  #: 0 silences (DEBUG, ...)


class Frame(NamedTuple):
    """What a call keeps for its return: the arguments and the local names of the caller."""

    arguments: list[float] | None
    names: dict[str, float]


class Parameters:
    """The variables of one run.

    Attributes
    ----------
    numbered
        Values by number (5602); handlers read and set them directly, rules do not apply.
    shared
        Global names (``_name``) and their values.
    local
        Names of the subroutine that runs.
    computed, predefined
        Variables that are worked out, by number and by name.
    """

    __slots__ = ("computed", "local", "numbered", "predefined", "shared")

    def __init__(self) -> None:
        self.numbered = [0.0] * (LAST + 1)
        self.numbered[5220] = 1.0
        self.numbered[TELLS_DEBUG] = 1.0
        self.shared: dict[str, float] = {}
        self.local: dict[str, float] = {}
        self.computed = ComputedTable[int]()
        self.predefined = ComputedTable[str]()

    # --- by number

    def get(self, number: int) -> float:
        """Return the value of ``#number``.

        Raises
        ------
        VariableError
            Where there is no such number.
        """
        if not 1 <= number <= LAST:
            raise _out_of_range(number)
        computed = self.computed.get(number)
        return self.numbered[number] if computed is None else computed.read()

    def check(self, number: int) -> None:
        """Check that a program may set ``#number``.

        Raises
        ------
        VariableError
            Where there is no such number, or it may only be read.
        """
        if not 1 <= number <= LAST:
            raise _out_of_range(number)
        computed = self.computed.get(number)
        if number in READ_ONLY or (computed is not None and computed.write is None):
            raise VariableError(f"#{number} can only be read", hint="Use another number, like #100.")

    def set(self, number: int, value: float) -> None:
        """Set ``#number``; errors are those of :meth:`check`."""
        self.check(number)
        computed = self.computed.get(number)
        if computed is None or computed.write is None:
            self.numbered[number] = value
        else:
            computed.write(value)

    def fill(self, first: int, values: Iterable[float]) -> None:
        """Set a run of numbers from ``first`` on, read-only ones too."""
        for number, value in enumerate(values, first):
            self.numbered[number] = value

    # --- by name

    def find(self, name: str) -> float | None:
        """Return the value of ``#<name>``, or None where nothing is known by that name."""
        if name[:1] != "_":
            return self.local.get(name)
        computed = self.predefined.get(name)
        return self.shared.get(name) if computed is None else computed.read()

    def get_named(self, name: str) -> float:
        """Return the value of ``#<name>``.

        Raises
        ------
        VariableError
            Where nothing has set it.
        """
        value = self.find(name)
        if value is None:
            raise no_value(name)
        return value

    def check_named(self, name: str) -> None:
        """Check that a program may set ``#<name>``.

        Raises
        ------
        VariableError
            Where it may only be read.
        """
        computed = self.predefined.get(name)
        if computed is not None and computed.write is None:
            raise VariableError(f"#<{name}> can only be read", hint="The interpreter works it out; use another name.")

    def names_with(self, name: str) -> dict[str, float]:
        """Return the names that ``name`` is one of; it exists from here on."""
        names = self.shared if name[:1] == "_" else self.local
        if name not in names:
            names[name] = 0.0
        return names

    def is_plain(self, key: int | str) -> bool:
        """Return whether a variable is only a value: neither read nor set by way of the state."""
        if isinstance(key, str):
            return key not in self.predefined
        return 1 <= key <= LAST and key not in READ_ONLY and key not in self.computed

    def set_named(self, name: str, value: float) -> None:
        """Set ``#<name>``; errors are those of :meth:`check_named`."""
        self.check_named(name)
        computed = self.predefined.get(name)
        if computed is not None and computed.write is not None:
            computed.write(value)
        elif name[:1] == "_":
            self.shared[name] = value
        else:
            self.local[name] = value

    # --- by call

    def enter(self, arguments: list[float] | None) -> Frame:
        """Give a called subroutine its arguments, #1 to #30, and no names; return what its end must restore.

        Without arguments (M98) it shares #1 to #30 with its caller.
        """
        if arguments is None:
            frame = Frame(None, self.local)
        else:
            frame = Frame(self.numbered[1 : ARGUMENTS + 1], self.local)
            self.numbered[1 : ARGUMENTS + 1] = arguments + [0.0] * (ARGUMENTS - len(arguments))
        self.local = {}
        return frame

    def leave(self, frame: Frame) -> None:
        """Restore the caller's arguments and names."""
        if frame.arguments is not None:
            self.numbered[1 : ARGUMENTS + 1] = frame.arguments
        self.local = frame.names


def _out_of_range(number: int) -> VariableError:
    return VariableError(f"there is no variable #{number}", hint=f"Numbers go from 1 to {LAST}.")


def no_value(name: str) -> VariableError:
    """Return the error for a name that nothing has set."""
    kind = "global" if name[:1] == "_" else "local"
    return VariableError(f"the {kind} variable #<{name}> has no value",
                         hint=f"Set it before: #<{name}> = 0.  EXISTS[#<{name}>] tells whether it is set.")  # fmt: skip
