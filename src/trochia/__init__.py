"""Trochia: plan a job, prove it on a digital twin, run the same plan.

The names below are loaded on first use (PEP 562), so that ``import trochia.units`` stays light.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from trochia.api import check, gcode, load, plan, read, simulate

__version__ = "0.1.0"
__all__ = ["check", "gcode", "load", "plan", "read", "simulate"]


def __getattr__(name: str) -> Any:  # noqa: ANN401 - the type is the one imported above
    """Return a public name from :mod:`trochia.api`."""
    if name in __all__:
        return getattr(import_module("trochia.api"), name)
    raise AttributeError(f"module 'trochia' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
