"""M100 to M199 on the command line: which of them a machine has, and who runs them.

In: a machine and the name it was loaded by.  Out: the codes its programs may call, and a controller that runs them.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.controller.runtime import Runtime
    from trochia.machine.machine import Machine


def codes_of(machine: Machine, name: str) -> bool | frozenset[int]:
    """Return whether programs may call M100 to M199, or which of them.

    Raises
    ------
    ConfigError
        Where the machine file names a folder that is not there.
    """
    if machine.allow_user_m_codes or machine.user_m_codes is None:
        return machine.allow_user_m_codes
    from trochia.controller.hooks import codes_in  # noqa: PLC0415 - only for machines that have them

    return codes_in(_folder(machine.user_m_codes, name))


def attach(runtime: Runtime, machine: Machine, name: str, *, blocking: bool = False) -> Callable[[], None]:
    """Let the machine's programs run for its codes; return what ends those that still run."""
    if machine.user_m_codes is None:
        return lambda: None
    from trochia.controller.hooks import Hooks  # noqa: PLC0415 - only for machines that have them

    return Hooks(_folder(machine.user_m_codes, name), runtime, blocking=blocking).close


def _folder(folder: str, name: str) -> Path:
    """Return a folder that a machine file names, relative to it."""
    return Path(name).resolve().parent / folder
