"""A progress bar on standard error, for work longer than a second."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from types import TracebackType

PATIENCE = 1.0  #: s of work before anything is drawn
WIDTH = 40


class Progress:
    """Call it with a label and the fraction done; it draws itself once the work has lasted a second.

    Off where standard error is no terminal, so that logs stay clean.
    """

    def __init__(self) -> None:
        self._began = time.monotonic()
        self._drawn = 0.0
        self._on = sys.stderr.isatty()

    def __call__(self, label: str, fraction: float) -> None:
        """Show that ``fraction`` (0 to 1) of the step ``label`` is done."""
        now = time.monotonic()
        if not self._on or now - self._began < PATIENCE or now - self._drawn < 1 / 20:
            return
        self._drawn = now
        full = round(WIDTH * min(max(fraction, 0.0), 1.0))
        sys.stderr.write(
            f"\r{label:<12} [{'#' * full}{'.' * (WIDTH - full)}] {fraction:4.0%} {now - self._began:5.1f} s"
        )
        sys.stderr.flush()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._drawn:
            sys.stderr.write("\r" + " " * (WIDTH + 32) + "\r")
            sys.stderr.flush()
