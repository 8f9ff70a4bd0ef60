"""Intel HEX, with damaged rows told apart from good ones.

In: the text of a memory dump.  Out: bytes by address, and for each bad row what is wrong with it.  A row is
``:LLAAAATT`` + data + check sum; sums of all bytes of a row are 0 modulo 256.
"""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True, kw_only=True)
class Dump:
    """What a dump holds.

    Attributes
    ----------
    memory
        Bytes by address, good rows only.
    problems
        (line number, what is wrong) for each bad row.
    guesses
        Bytes by address of rows that lost one byte: the check sum tells its value, not its place; it is taken as the
        last.
    """

    memory: dict[int, int] = field(default_factory=dict[int, int])
    problems: list[tuple[int, str]] = field(default_factory=list[tuple[int, str]])
    guesses: dict[int, int] = field(default_factory=dict[int, int])

    def block(self, first: int, count: int, *, guess: bool = False) -> list[int | None]:
        """Return the bytes from an address on; None where nothing good is known."""
        known = self.guesses | self.memory if guess else self.memory
        return [known.get(address) for address in range(first, first + count)]


def read_hex(text: str) -> Dump:
    """Return what is in an Intel HEX text; nothing in it is an error but told as a problem."""
    dump = Dump()
    for number, line in enumerate(text.splitlines(), 1):
        row = line.strip().replace(" ", "")
        if not row:
            continue
        problem = _take(dump, row)
        if problem:
            dump.problems.append((number, problem))
    return dump


def _take(dump: Dump, row: str) -> str:
    """Take a row, and return what is wrong with it."""
    try:
        data = bytes.fromhex(row[1:]) if row.startswith(":") else b""
    except ValueError:
        return "is not made of whole bytes in hexadecimal"
    if len(data) < 5:
        return f"has {len(data)} bytes behind a colon; a row has at least 5"
    length, address, kind = data[0], data[1] << 8 | data[2], data[3]
    missing, odd = length + 5 - len(data), sum(data) & 0xFF
    problem = ""
    if missing == 1 and kind == 0:
        dump.guesses.update(enumerate([*data[4:-1], -odd & 0xFF], address))
        problem = f"has {length - 1} of {length} bytes; by the check sum the lost one is 0x{-odd & 0xFF:02X}"
    elif missing:
        problem = f"has {len(data) - 5} bytes of data, {length} are announced"
    elif odd:
        dump.guesses.update(enumerate(data[4:-1], address))
        problem = f"has a wrong check sum: 0x{data[-1]:02X}, its bytes make 0x{-sum(data[:-1]) & 0xFF:02X}"
    elif kind == 0:
        dump.memory.update(enumerate(data[4:-1], address))
    return problem
