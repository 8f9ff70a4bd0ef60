"""Who moves the machine; a row in ``BACKENDS`` is what makes a backend known and tested."""

from trochia.backends.protocol import Motion, SegmentBackend
from trochia.backends.twin import Twin

BACKENDS: dict[str, type[SegmentBackend]] = {backend.kind: backend for backend in (Twin,)}

__all__ = ["BACKENDS", "Motion", "SegmentBackend", "Twin"]
