"""The end of a day: whatever moves is braked, drives go off.  In: a running runtime.  Out: the same, at rest."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from trochia.controller.states import MOVING, State
from trochia.messages.command import Abort, Disable

if TYPE_CHECKING:
    from trochia.controller.runtime import Runtime

PATIENCE = 20.0  #: for motion to come to rest [s]
LOOK = 0.02


def bring_to_rest(runtime: Runtime) -> bool:
    """Give up what is under way, wait until it rests, switch the drives off; return whether it came to rest.

    The runtime has to run in its own thread.
    """
    until = time.monotonic() + PATIENCE
    while State(runtime.status.state) in MOVING | {State.HELD}:
        if "abort" in runtime.status.legal:
            runtime.send(Abort()).result(PATIENCE)
        time.sleep(LOOK)
        if time.monotonic() > until:
            return False
    if "disable" in runtime.status.legal:
        runtime.send(Disable()).result(PATIENCE)
    return True
