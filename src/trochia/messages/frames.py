"""Bulk data as one binary frame: a path, samples.

A frame is ``TRO1``, the length of its header (uint32), the header, and its columns one after the other, each on a
multiple of 8 bytes, everything little-endian.  The header is JSON, blank-padded to such a multiple:
``{"kind": "path", "rows": 3, "columns": [["points", "<f4", 3], ["lines", "<u4", 1]], "about": {"axes": "XYZ"}}``.
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Annotated, Any, Literal

import msgspec
import numpy as np
from msgspec import Meta

from trochia.errors import RemoteProtocolError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

MAGIC = b"TRO1"
GRAIN = 8  #: every column begins on a multiple of this many bytes

Column = tuple[str, Literal["<f4", "<f8", "<u4", "|u1"], Annotated[int, Meta(ge=1, le=64)]]


class FrameHead(msgspec.Struct, frozen=True, kw_only=True):
    """What a frame holds: (name, type, width) of its columns, its rows, and what else is to be said of it."""

    kind: str
    rows: Annotated[int, Meta(ge=0, le=1 << 30)]
    columns: tuple[Column, ...]
    about: dict[str, Any] = {}


class Frame(msgspec.Struct, frozen=True, kw_only=True):
    """A frame that has been read: columns by name, (rows,) or (rows, width)."""

    head: FrameHead
    columns: dict[str, Any]


_decode = msgspec.json.Decoder(FrameHead).decode


def pack(kind: str, columns: Mapping[str, NDArray[Any]], **about: Any) -> bytes:  # noqa: ANN401 - any JSON value
    """Return a frame of columns, (rows,) or (rows, width), all of as many rows."""
    rows = len(next(iter(columns.values())))
    arrays = {name: np.ascontiguousarray(column, column.dtype.newbyteorder("<")) for name, column in columns.items()}
    described = [(name, array.dtype.str, array.size // rows if rows else 1) for name, array in arrays.items()]
    head = msgspec.json.encode({"kind": kind, "rows": rows, "columns": described, "about": about})
    head += b" " * (-(len(MAGIC) + 4 + len(head)) % GRAIN)
    parts = [MAGIC, struct.pack("<I", len(head)), head]
    for array in arrays.values():
        data = array.tobytes()
        parts += [data, bytes(-len(data) % GRAIN)]
    return b"".join(parts)


def unpack(data: bytes) -> Frame:
    """Return what a frame holds; its columns are views of ``data``.

    Raises
    ------
    RemoteProtocolError
        When it is no frame, or cut.
    """
    if len(data) < 8 or data[:4] != MAGIC:
        raise RemoteProtocolError("a binary frame begins with TRO1 and the length of its header")
    (length,) = struct.unpack_from("<I", data, 4)
    try:
        head = _decode(data[8 : 8 + length])
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise RemoteProtocolError(f"the header of a binary frame cannot be read: {error}") from None
    at, columns = 8 + length, dict[str, Any]()
    for name, kind, width in head.columns:
        count = head.rows * width
        size = count * np.dtype(kind).itemsize
        if at + size > len(data):
            raise RemoteProtocolError(f"a binary frame ends inside its column {name}")
        column = np.frombuffer(data, kind, count, at)
        columns[name] = column if width == 1 else column.reshape(head.rows, width)
        at += size + -size % GRAIN
    return Frame(head=head, columns=columns)
