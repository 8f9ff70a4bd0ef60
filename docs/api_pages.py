"""Writes ``docs/reference/api-messages.md``: every message of the interface, from the messages' own schema.

In: the schemas that ``/api/openapi.json`` serves, and the table of paths.  Out: Markdown, made anew at every build of
the documentation, never committed.
"""

from __future__ import annotations

import inspect
import re
from pathlib import Path
from typing import Any

from trochia.messages import schema
from trochia.server.openapi import PATHS, REFUSALS

PAGE = Path(__file__).resolve().parent / "reference" / "api-messages.md"
_BOUNDS = {
    "minimum": "≥ {}",
    "exclusiveMinimum": "> {}",
    "maximum": "≤ {}",
    "minLength": "{} characters or more",
    "maxLength": "{} characters at most",
    "pattern": "`{}`",
}


def type_of(field: dict[str, Any]) -> str:
    """Return a field's type and bounds in words."""
    if "$ref" in field:
        name = field["$ref"].rpartition("/")[2]
        return f"[{name}](#{name.lower()})"
    if "anyOf" in field:
        return " or ".join(type_of(one) for one in field["anyOf"])
    if "enum" in field:
        return ", ".join(f"`{value}`" for value in field["enum"])
    bounds = "".join(", " + words.format(field[key]) for key, words in _BOUNDS.items() if key in field)
    kind = field.get("type", "any")
    if kind == "array" and isinstance(field.get("items"), dict):
        return f"array of {type_of(field['items'])}"
    if kind == "object" and "additionalProperties" in field:
        return f"object of {type_of(field['additionalProperties'])}"
    return kind + bounds


def prose(text: str) -> str:
    """Return a docstring as Markdown."""
    lines = inspect.cleandoc(text).replace("``", "`").splitlines()
    body = "\n".join("" if line == "Attributes" else line for line in lines if line.strip("-") or not line)
    body = re.sub(r":\w+:`[~.]?([\w.]+)`", r"`\1`", body)
    return re.sub(r"(?m)^(\w[\w, ]*)\n    (.+)$", r"- `\1`: \2", body)


def section(name: str, described: dict[str, Any]) -> list[str]:
    """Return the entry of a message."""
    lines = [f"## {name}", "", prose(described.get("description", "")), ""]
    fields = described.get("properties", {})
    if not fields:
        return [*lines, type_of(described), ""]
    lines += ["| field | type | unless given |", "|---|---|---|"]
    for field, what in fields.items():
        given = "must be given" if field in described.get("required", []) else f"`{what.get('default')}`"
        words = type_of(what).replace("|", "\\|")
        lines.append(f"| `{field}` | {words} | {given} |")
    return [*lines, ""]


def page() -> str:
    """Return the page."""
    lines = [
        "# Messages of the interface",
        "",
        "Made from the schema that the server serves; how they are used is in [the interface](api.md).",
        "",
        "## Paths",
        "",
        "| | takes | gives | refuses | |",
        "|---|---|---|---|---|",
    ]
    for path in PATHS:
        codes = " ".join(str(code) for code in path.refuses)
        about = f"{path.takes or '–'} | {path.gives or '–'} | {codes or '–'} | {path.about}"  # noqa: RUF001 - a dash
        lines.append(f"| `{path.method.upper()} {path.path}` | {about} |")
    lines += ["", *(f"- {code}: {why}" for code, why in sorted(REFUSALS.items())), ""]
    for name, described in schema()["$defs"].items():
        lines += section(name, described)
    return "\n".join(lines)


def write() -> None:
    """Write the page."""
    text = page()
    if not PAGE.exists() or PAGE.read_text("utf-8") != text:
        PAGE.write_text(text, "utf-8")
