"""The generated page of the interface: every message, every path, no field without a type."""

from __future__ import annotations

import runpy
from pathlib import Path

from trochia.messages import schema
from trochia.server.openapi import PATHS

PAGE = runpy.run_path(str(Path(__file__).parents[2] / "docs" / "api_pages.py"))["page"]()


def test_every_message_and_path_has_its_entry():
    assert all(f"\n## {name}\n" in PAGE for name in schema()["$defs"])
    assert all(f"`{path.method.upper()} {path.path}`" in PAGE for path in PATHS)


def test_types_bounds_and_defaults_are_told():
    assert "| `lease` | number, > 0.0, ≤ 1.0 | `0.15` |" in PAGE
    assert "| `axis` | string, `^[XYZABCUVW]$` | must be given |" in PAGE
    assert "| `status` | [Status](#status) or null | `None` |" in PAGE
    assert "- `trusted`: Whether its position is known" in PAGE
    assert "| any |" not in PAGE
