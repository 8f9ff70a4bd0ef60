"""What moves the machine: the seam between a planned motion and whoever carries it out.

A motion backend takes a motion that is planned already and gives back what came of it, in blocks of samples as they
come; :func:`trochia.recorder.write` puts them into a file, :func:`trochia.recorder.gather` into memory.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Protocol

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    import numpy as np
    from numpy.typing import NDArray

    from trochia.machine.machine import Machine
    from trochia.recorder import Header


class Motion(Protocol):
    """What a backend asks of a trajectory; ``t`` is (samples,) [s] within 0 and ``duration``, rising."""

    @property
    def duration(self) -> float:
        """Length of the motion [s]."""
        ...

    def position(self, t: NDArray[np.float64], /) -> NDArray[np.float64]:
        """Return positions of the machine's axes (samples, axes) [mm or degree]."""
        ...

    def path_speed(self, t: NDArray[np.float64], /) -> NDArray[np.float64]:
        """Return the speed along the path (samples,) [mm/s]."""
        ...

    def line_at(self, t: NDArray[np.float64], /) -> NDArray[Any]:
        """Return the source line of the motion (samples,)."""
        ...

    def power_at(self, t: NDArray[np.float64], /) -> NDArray[Any]:
        """Return the power of the beam (samples,), as S gave it, 0 off; asked of machines with a beam."""
        ...


class MotionBackend(Protocol):
    """Carries out a motion on one machine and records it.

    Every recording has ``X.commanded`` and ``X.actual`` for each axis and covers the whole duration, both ends in it.
    """

    kind: ClassVar[str]

    def __init__(self, *, machine: Machine) -> None: ...

    def header(self, motion: Motion, *, program: str = "") -> Header:
        """Return the header of the recording that :meth:`run` gives the samples of."""
        ...

    def run(self, motion: Motion) -> Iterator[Mapping[str, NDArray[Any]]]:
        """Carry the motion out and yield blocks of samples, every channel of the header in each."""
        ...
