"""What the machine is busy with: a job, a jog, a search for its reference.  One at a time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Iterator

    from trochia.backends.live import Orders, Report
    from trochia.controller.states import Event


class Activity(Protocol):
    """Motion under way, until it is still."""

    def feed(self, report: Report) -> Iterator[Orders]:
        """Yield the next orders; none where the backend holds enough."""
        ...

    def event(self, report: Report) -> Event | None:
        """Return what has come about, or None."""
        ...

    def hold(self, report: Report, latency: float) -> None:
        """Brake along the path, as soon as an order can act (``latency`` s from now)."""
        ...

    def finish(self, *, whole: bool) -> Orders:
        """Return what is left to set once motion is still; ``whole``: it has come to its own end, or to a pause."""
        ...
