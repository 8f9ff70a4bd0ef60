"""Reading a machine file key by key: every key is read or refused, every mistake is one error in its place.

In: the tables of a TOML document.  Out: values, and a list of errors that name file, line, key, value and expectation.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar, cast

from trochia.errors import ConfigError, MachineError, Source
from trochia.machine.codecs import Text
from trochia.machine.locate import nearest, places
from trochia.machine.schema import Record, Variant, keys_of, required
from trochia.units import did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Mapping

    from trochia.machine.codecs import Codec

T = TypeVar("T")


class Incomplete(MachineError):  # noqa: N818 - it tells of no mistake, those are noted
    """A table that cannot be built because some of its keys are wrong, each noted already."""


class Book:
    """One machine file being read, and the mistakes found in it."""

    def __init__(self, file: str, text: str) -> None:
        self.file = file
        self.lines = text.splitlines()
        self.places = places(text)
        self.problems: list[MachineError] = []

    def catch(self) -> Catch:
        """Note a mistake made inside the ``with`` block and go on behind it."""
        return Catch(self)

    def placed(self, error: MachineError, path: str = "") -> MachineError:
        """Return the error with the full name of its key and the place in the file."""
        if error.source is not None:
            return error
        key = error.key or ""
        if path and not f"{key}.".startswith(f"{path}."):
            key = f"{path}.{key}" if key else path
        place = nearest(self.places, key)
        line, column = place or (1, 0)
        text = self.lines[line - 1] if place else None
        return type(error)(
            error.plain, key=key or None, source=Source(self.file, line, column), text=text, hint=error.hint
        )


class Catch:
    """A ``with`` block that notes a mistake instead of passing it on."""

    def __init__(self, book: Book) -> None:
        self._book = book

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> bool:
        if isinstance(error, MachineError) and not isinstance(error, Incomplete):
            self._book.problems.append(self._book.placed(error))
        return isinstance(error, MachineError)


class Table:
    """One table of the file; remembers which of its keys were read."""

    def __init__(self, values: Mapping[str, object], book: Book, path: str = "") -> None:
        self.values = values
        self.book = book
        self.path = path
        self._read: set[str] = set()

    def __contains__(self, name: str) -> bool:
        return name in self.values

    def name(self, key: str) -> str:
        """Return the dotted name of one of its keys."""
        return f"{self.path}.{key}" if self.path else key

    def error(self, key: str, message: str, *, hint: str | None = None) -> MachineError:
        """Return an error about one of its keys, in place."""
        return self.book.placed(ConfigError(message, key=self.name(key), hint=hint))

    def take(self, key: str) -> object:
        """Return a value as TOML holds it (None: it is not there) and count the key as read."""
        self._read.add(key)
        return self.values.get(key)

    def table(self, key: str) -> Table | None:
        """Return a table inside this one, or None."""
        value = self.take(key)
        if value is None:
            return None
        if not isinstance(value, dict):
            raise self.error(key, f"expected a table, [{self.name(key)}], not {shown(value)}")
        return Table(cast("dict[str, object]", value), self.book, self.name(key))

    def tables(self, key: str) -> dict[str, Table]:
        """Return the tables named inside the table ``key``, in the file's order; what is none is noted."""
        outer = self.table(key)
        found: dict[str, Table] = {}
        for name in outer.values if outer else ():
            with self.book.catch():
                inner = outer.table(name) if outer else None
                if inner is not None:
                    found[name] = inner
        return found

    def read(self, key: str, codec: Codec, *, rotary: bool = False) -> object:
        """Return a value as the codec makes it, or None where the key is not there."""
        value = self.take(key)
        if value is None:
            return None
        try:
            return codec.read(value, rotary=rotary)
        except MachineError as error:
            raise self.book.placed(error, self.name(key)) from None

    def refuse_rest(self) -> None:
        """Note every key that nobody read."""
        for key in self.values:
            if key not in self._read:
                with self.book.catch():
                    free = [name for name in self._read if not isinstance(self.values.get(name, {}), str | int)]
                    known = f"Known here: {', '.join(sorted(self._read)) or 'none'}."
                    raise self.error(key, "unknown key", hint=did_you_mean(key, free) or known)


def build(table: Table, cls: type[T], *, rotary: bool = False, **given: object) -> T:
    """Return the description that a table holds; ``given`` are fields that are no keys.

    Raises
    ------
    MachineError
        Where keys are right one by one but not together; Incomplete where some were wrong and are noted.
    """
    book = table.book
    before = len(book.problems)
    values = given | fields(table, cls, rotary=rotary, given=given)
    table.refuse_rest()
    if len(book.problems) > before:
        raise Incomplete(table.path)
    return construct(table, cls, values)


def fields(table: Table, cls: type[Any], *, rotary: bool, given: Mapping[str, object]) -> dict[str, object]:
    """Return the fields that stand in the table; what is wrong or missing is noted."""
    values: dict[str, object] = {}
    unknown = set(table.values) - set(keys_of(cls)) - {"kind"}
    for name, entry in keys_of(cls).items():
        if name in given:
            continue
        with table.book.catch():
            value = _value(table, name, entry.codec, rotary=rotary)
            if value is not None:
                values[name] = value
            elif required(cls, name) and not did_you_mean(name, unknown):  # a misspelt key is told as one mistake
                raise table.error(name, f"missing; expected {_expected(entry.codec, rotary=rotary)} ({entry.doc})")
    return values


def construct(table: Table, cls: type[T], values: Mapping[str, object]) -> T:
    """Return the description; its own complaints get the table's name and place."""
    try:
        return cls(**values)
    except MachineError as error:
        raise table.book.placed(error, table.path) from None


def _value(table: Table, name: str, codec: Codec | Record | Variant, *, rotary: bool) -> object:
    """Return the value of one key, a description for a table, or None."""
    if isinstance(codec, Record):
        inner = table.table(name)
        return None if inner is None else build(inner, codec.cls, rotary=rotary)
    if isinstance(codec, Variant):
        said = table.values.get(name)
        if isinstance(said, str):
            kind = said if said in codec.registry else next(iter(codec.registry))
            raise table.error(name, f"expected a table, not {shown(said)}",
                              hint=f'Like {name} = {{ kind = "{kind}", … }}.')  # fmt: skip
        inner = table.table(name)
        return None if inner is None else _variant(inner, codec, rotary=rotary)
    return table.read(name, codec, rotary=rotary)


def _variant(table: Table, codec: Variant, *, rotary: bool) -> object:
    """Return the description of the class that ``kind`` names."""
    kind = table.take("kind")
    if not isinstance(kind, str) or kind not in codec.registry:
        said = "missing" if kind is None else f"not {shown(kind)}"
        hint = did_you_mean(kind, codec.registry) if isinstance(kind, str) else None
        raise table.error("kind", f"expected one of {', '.join(codec.registry)}, {said}", hint=hint)
    return build(table, codec.registry[kind], rotary=rotary)


def _expected(codec: Codec | Record | Variant, *, rotary: bool) -> str:
    """Return an example of what the key wants."""
    if isinstance(codec, Variant):
        return f"a table with kind = {' | '.join(codec.registry)}"
    if isinstance(codec, Text) and codec.choices:
        return f"one of {', '.join(codec.choices)}"
    return "a table" if isinstance(codec, Record) else f"something like {codec.example(rotary=rotary)}"
