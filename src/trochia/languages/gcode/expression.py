"""Values: numbers, ``[expressions]``, ``#parameters``, functions, signs; read once, worked out as often as wanted.

In: the compact line (no blanks, lower case) and where a value begins.  Out: the value, a plain number where nothing in
it can change and a function without arguments otherwise, and where the text goes on.

value     = number | sign value | "[" expression "]" | "#" name or value | function "[" expression "]"
expression = value { operator value }
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from trochia.errors import ParseError, VariableError
from trochia.languages.gcode.functions import (
    FUNCTION,
    FUNCTIONS,
    OPERATOR,
    OPERATORS,
    Refusal,
    arc_tangent,
    finite,
)
from trochia.languages.gcode.numbers import as_integer, read_number
from trochia.languages.gcode.parameters import LAST, no_value

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.languages.gcode.parameters import Parameters
    from trochia.languages.gcode.place import Place

    Thunk = Callable[[], float]
    Value = float | Thunk

_NAME = re.compile(r"<([^>]*)>")
_SIGNED_NUMBER = re.compile(r"[+-]*[0-9.]")
_DEEPEST = 60  # brackets in brackets; a line of 252 characters could hold more than Python's stack
_FINISH = 0


def work_out(value: Value) -> float:
    """Return the number a value is now."""
    return value() if callable(value) else value


class Expressions:
    """Reads the values of one line.

    Parameters
    ----------
    text
        The compact line.
    place
        Where it stands, for errors.
    parameters
        What ``#`` refers to.
    """

    __slots__ = ("_depth", "_parameters", "_place", "_text")

    def __init__(self, text: str, place: Place, parameters: Parameters) -> None:
        self._text = text
        self._place = place
        self._parameters = parameters
        self._depth = 0

    def value(self, at: int) -> tuple[Value, int]:
        """Return the value that begins at ``at``, and where it ends.

        Raises
        ------
        ParseError
            Where no value stands, or one that is not whole.
        VariableError
            For a parameter that cannot be; those of a value that can change are raised when it is worked out.
        """
        first = self._text[at : at + 1]
        if first == "[":
            return self.bracket(at)
        if first == "#":
            return self._parameter(at)
        if first in ("+", "-") and not _SIGNED_NUMBER.match(self._text, at):
            return self._signed(at)
        if "a" <= first <= "z" or first == "":
            return self._function(at)
        return read_number(self._text, at, self._place)

    def bracket(self, at: int) -> tuple[Value, int]:
        """Return the value of the expression whose ``[`` stands at ``at``, and where it ends."""
        if self._depth == _DEEPEST:
            raise self._place.fault(ParseError, f"more than {_DEEPEST} brackets in each other", at,
                                    hint="Use parameters for parts of it.")  # fmt: skip
        self._depth += 1
        value, end = self._operation(*self.value(at + 1), _FINISH, at)
        self._depth -= 1
        return self._guard(value, at, finite), end + 1

    # --- operators

    def _operation(self, left: Value, at: int, least: int, start: int) -> tuple[Value, int]:
        """Return ``left`` with all operators behind it that bind tighter than ``least``."""
        while True:
            binding, function, end = self._operator(at, start)
            if binding <= least:
                return left, at
            right, after = self.value(end)
            right, after = self._operation(right, after, binding, start)
            left, at = self._combine(function, left, right, at), after

    def _operator(self, at: int, start: int) -> tuple[int, Callable[[float, float], float], int]:
        text = self._text
        if text[at : at + 1] == "]":
            return _FINISH, max, at
        match = OPERATOR.match(text, at)
        if match is not None:
            return *OPERATORS[match.group()], match.end()
        if at >= len(text):
            raise self._place.fault(ParseError, "the bracket [ is not closed", start, hint="Write ] at its end.")
        raise self._place.fault(ParseError, f"{text[at].upper()!r} is no operator", at,
                                hint="Known are ** * / MOD + - EQ NE GT GE LT LE AND OR XOR; ] ends it.")  # fmt: skip

    def _combine(self, function: Callable[[float, float], float], left: Value, right: Value, at: int) -> Value:
        if callable(left):
            first = left
            if callable(right):
                second = right
                return lambda: function(first(), second())
            constant = right
            return lambda: function(first(), constant)
        if callable(right):
            second, known = right, left
            return lambda: function(known, second())
        return self._try(lambda: function(left, right), at)

    def _guard(self, value: Value, at: int, function: Callable[[float], float]) -> Value:
        if callable(value):
            inner = value
            return lambda: function(inner())
        return self._try(lambda: function(value), at)

    def _try(self, work: Thunk, at: int) -> float:
        try:
            return work()
        except Refusal as refusal:
            raise self._place.fault(ParseError, refusal.message, at, hint=refusal.hint) from None

    # --- signs, functions, parameters

    def _signed(self, at: int) -> tuple[Value, int]:
        value, end = self.value(at + 1)
        if self._text[at] == "+":
            return value, end
        if callable(value):
            inner = value
            return (lambda: -inner()), end
        return -value, end

    def _function(self, at: int) -> tuple[Value, int]:
        match = FUNCTION.match(self._text, at)
        if match is None:
            return read_number(self._text, at, self._place)  # it says what is wrong
        name, end = match.group(), match.end()
        if self._text[end : end + 1] != "[":
            raise self._place.fault(ParseError, f"{name.upper()} has no argument", at,
                                    hint=f"Write it in brackets: {name.upper()}[...].")  # fmt: skip
        if name == "exists":
            return self._exists(end)
        argument, after = self.bracket(end)
        if name == "atan":
            return self._arc_tangent(argument, after, at)
        return self._guard(self._guard(argument, at, FUNCTIONS[name]), at, finite), after

    def _arc_tangent(self, up: Value, at: int, start: int) -> tuple[Value, int]:
        if self._text[at : at + 2] != "/[":
            raise self._place.fault(ParseError, "ATAN has one argument", start, hint="It needs two: ATAN[y]/[x].")
        along, end = self.bracket(at + 1)
        return self._combine(arc_tangent, up, along, start), end

    def _exists(self, at: int) -> tuple[Value, int]:
        """Return whether a named parameter has a value; a numbered one always has."""
        text, store = self._text, self._parameters
        if text[at + 1 : at + 2] != "#":
            raise self._place.fault(ParseError, "EXISTS asks for a parameter", at, hint="Write EXISTS[#<name>].")
        name = _NAME.match(text, at + 2)
        value: Value = 1.0
        if name is None:
            _, end = self._parameter(at + 1)
        else:
            wanted, end = name.group(1), name.end()
            value = lambda: 0.0 if store.find(wanted) is None else 1.0  # noqa: E731 - a number or a function
        if text[end : end + 1] != "]":
            raise self._place.fault(ParseError, "the bracket [ is not closed", at, hint="Write EXISTS[#<name>].")
        return value, end + 1

    def _parameter(self, at: int) -> tuple[Thunk, int]:
        """Return the value of the parameter whose ``#`` stands at ``at``."""
        target, end = self.target(at)
        store = self._parameters
        if isinstance(target, str):
            return self._named(target, at), end
        if not callable(target):
            return self._numbered(int(target), at), end
        number = target

        def indirect() -> float:
            try:
                return store.get(self._integer(number(), at))
            except VariableError as error:
                raise self._relocated(error, at) from None

        return indirect, end

    def _named(self, name: str, at: int) -> Thunk:
        """Return how to read a parameter with a name."""
        store, is_global = self._parameters, name[:1] == "_"
        computed = store.predefined.get(name) if is_global else None
        if computed is not None:
            return computed.read

        def named() -> float:
            value = store.shared.get(name) if is_global else store.local.get(name)
            if value is None:
                raise self._relocated(no_value(name), at)
            return value

        return named

    def _numbered(self, number: int, at: int) -> Thunk:
        """Return how to read a parameter whose number is known."""
        store = self._parameters
        if not 1 <= number <= LAST:
            try:
                store.get(number)
            except VariableError as error:
                raise self._relocated(error, at) from None
        computed = store.computed.get(number)
        if computed is not None:
            return computed.read
        values = store.numbered
        return lambda: values[number]

    def target(self, at: int) -> tuple[Value | str, int]:
        """Return what the ``#`` at ``at`` names, a name or a number (whole where it is known), and where it ends.

        Raises
        ------
        ParseError
            For a name that is not closed, or a number that is not whole.
        """
        if self._text[at + 1 : at + 2] == "<":
            name = _NAME.match(self._text, at + 1)
            if name is None:
                raise self._place.fault(ParseError, "the name is not closed", at, hint="Write > at its end.")
            return name.group(1), name.end()
        value, end = self.value(at + 1)
        return (value if callable(value) else float(self._integer(value, at))), end

    def _integer(self, value: float, at: int) -> int:
        whole = as_integer(value)
        if whole is None:
            raise self._place.fault(VariableError, f"#{value:g}: the number of a parameter must be whole", at,
                                    hint="Use FIX, ROUND or FUP.")  # fmt: skip
        return whole

    def _relocated(self, error: VariableError, at: int) -> VariableError:
        return self._place.fault(VariableError, error.message, at, hint=error.hint)
