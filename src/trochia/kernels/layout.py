"""Structs of the C headers as numpy dtypes: the header is the schema, there is no second copy.

In: the compiled module's type table.  Out: ``MOVE`` (``core/host/move.h``), ``SEGMENT`` and ``PHASE``
(``core/host/path.h``), and the members of a C enum.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from trochia._core import ffi, lib

_SCALARS = {
    "double": "f8", "float": "f4", "int32_t": "i4", "uint32_t": "u4", "int64_t": "i8", "uint64_t": "u8",
    "int16_t": "i2", "uint16_t": "u2", "int8_t": "i1", "uint8_t": "u1",
}  # fmt: skip


def dtype_of(struct: str) -> np.dtype[np.void]:
    """Return the numpy dtype of a C struct of scalars and arrays of scalars, with the compiler's offsets and size."""
    names: list[str] = []
    formats: list[Any] = []
    offsets: list[int] = []
    ctype = ffi.typeof(struct)
    for name, field in ctype.fields:
        kind, shape = field.type, ()
        if kind.kind == "array":
            kind, shape = kind.item, (kind.length,)
        names.append(name)
        formats.append((_SCALARS[kind.cname], shape))
        offsets.append(field.offset)
    return np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": ffi.sizeof(ctype)})


def pointer(array: np.ndarray[Any, Any], ctype: str) -> Any:  # noqa: ANN401 - a cffi pointer has no Python type
    """Return a C pointer of type ``ctype`` to a contiguous array's data; the caller keeps the array alive."""
    if not array.flags.c_contiguous:
        raise ValueError(f"a C kernel needs a contiguous array, not strides {array.strides}")
    return ffi.cast(ctype, ffi.from_buffer(array)) if array.size else ffi.NULL


MOVE = dtype_of("trochia_move")
SEGMENT = dtype_of("trochia_segment")
PHASE = dtype_of("trochia_phase")

__all__ = ["MOVE", "PHASE", "SEGMENT", "dtype_of", "ffi", "lib", "pointer"]
