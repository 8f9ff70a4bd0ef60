"""Who moves the machine; a row in ``BACKENDS`` is what makes a backend known and tested."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.backends.grbl import GrblBackend
from trochia.backends.live_twin import LiveTwin
from trochia.backends.protocol import Motion, MotionBackend
from trochia.backends.twin import Twin

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.backends.grbl import Port
    from trochia.backends.live import SegmentBackend
    from trochia.backends.program import ProgramBackend
    from trochia.machine.machine import Machine

#: they carry out a whole motion in virtual time
BACKENDS: dict[str, type[MotionBackend]] = {backend.kind: backend for backend in (Twin,)}
#: they take segments as the controller plans them
LIVE_BACKENDS: dict[str, Callable[[Machine], SegmentBackend]] = {backend.kind: backend for backend in (LiveTwin,)}
#: boards that plan for themselves, each on a port
PROGRAM_BACKENDS: dict[str, Callable[[Callable[[], Port]], ProgramBackend]] = {
    backend.kind: backend for backend in (GrblBackend,)
}

__all__ = [
    "BACKENDS",
    "LIVE_BACKENDS",
    "PROGRAM_BACKENDS",
    "GrblBackend",
    "LiveTwin",
    "Motion",
    "MotionBackend",
    "Twin",
]
