"""Who asked for what, when, from where, kept in a journal of its own.

In: entries from the server's thread.  Out: the same in files (:mod:`trochia.controller.journal`), by a thread that may
wait for the disk where the server must not.
"""

from __future__ import annotations

import threading
import time
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING

from trochia.controller.journal import Journal

if TYPE_CHECKING:
    from pathlib import Path

    from trochia.server.sessions import Session

REST = 0.25  #: between writings [s]
SHOWN = 200  #: characters of what a stranger sent that are kept
STRANGE = 20  #: entries a second about people who are not logged in; more are counted


class Audit:
    """The log of a server.

    Parameters
    ----------
    folder
        Of the journal; None: nothing is kept.
    """

    def __init__(self, folder: Path | None) -> None:
        self._journal = None if folder is None else Journal(folder)
        self._waiting: SimpleQueue[tuple[str, float, dict[str, object]]] = SimpleQueue()
        self._over = threading.Event()
        self._second, self._strange = 0, 0
        self._thread = threading.Thread(target=self._run, name="trochia-audit", daemon=True)
        if self._journal is not None:
            self._thread.start()

    def note(self, what: str, who: Session | None, address: str, **more: object) -> None:
        """Keep what somebody did or tried; ``who`` is None before a login."""
        now = time.time()
        if who is None and not self._room(now):
            return
        entry: dict[str, object] = {"from": address, **{key: _short(value) for key, value in more.items()}}
        if who is not None:
            entry |= {"user": who.user, "role": who.role, "session": who.number}
        self._waiting.put((what, now, entry))

    def close(self) -> None:
        """Bring everything to the disk."""
        self._over.set()
        if self._journal is not None:
            self._thread.join()
            self._journal.close()

    def _room(self, now: float) -> bool:
        """Whether one more entry about strangers is kept, so that they cannot flood the log."""
        if int(now) != self._second:
            more, self._second, self._strange = self._strange - STRANGE, int(now), 0
            if more > 0:
                self._waiting.put(("refused", now, {"reason": f"{more} more like these", "from": ""}))
        self._strange += 1
        return self._strange <= STRANGE

    def _run(self) -> None:
        journal = self._journal
        while journal is not None:
            over = self._over.wait(REST)
            try:
                while True:
                    what, when, entry = self._waiting.get_nowait()
                    journal.write(what, when, **entry)
            except Empty:
                journal.flush(time.monotonic())
            if over:
                return


def _short(value: object) -> object:
    return value[:SHOWN] + "…" if isinstance(value, str) and len(value) > SHOWN else value
