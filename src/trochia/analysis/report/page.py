"""The report as one HTML file: template, style, program and data joined, nothing fetched from anywhere.

In: :class:`ReportData`.  Out: text, or a file that is written whole or not at all.
"""

from __future__ import annotations

import base64
import hashlib
import json
from importlib.resources import files
from typing import TYPE_CHECKING, Any, cast

from trochia.analysis.report import summary, texts
from trochia.analysis.report.payload import payload
from trochia.files import write_whole

if TYPE_CHECKING:
    from pathlib import Path

    from jinja2 import Environment

    from trochia.analysis.report.data import ReportData

#: The page's program, in the order in which it is joined into one script; each file may use what stands before it.
SCRIPTS = (
    "format.js", "store.js", "data.js", "colour.js", "scale.js", "camera.js", "path.js", "path-layers.js",
    "path-input.js", "chart.js", "chart-input.js", "charts.js", "table.js", "player.js", "main.js",
)  # fmt: skip
#: Problems beyond these are counted, not listed.
_PROBLEMS_SHOWN = 100


def write_report(path: Path, data: ReportData) -> None:
    """Write the report to ``path``, whole or not at all.

    Raises
    ------
    OSError
        When the file cannot be written; what stood at ``path`` before still does.
    """
    write_whole(path, render_report(data).encode("utf-8"))


def render_report(data: ReportData) -> str:
    """Return the report as the text of one HTML file that needs no network."""
    slow = summary.slow_lines(data)
    shown = data.problems[:_PROBLEMS_SHOWN]
    script = "\n".join(_resource(name) for name in SCRIPTS)
    keep = {row.line for row in slow} | {problem.line for problem in shown if problem.line}
    return _environment().from_string(_resource("report.html")).render(
        data=data,
        verdict=summary.verdict_text(data),
        parts=summary.time_parts(data),
        facts=summary.facts(data),
        peaks=summary.peaks(data),
        reaches=summary.reaches(data),
        errors=summary.errors(data),
        slow_lines=slow,
        reasons=data.reasons,
        problems=shown,
        problems_hidden=len(data.problems) - len(shown),
        payload=_json(payload(data, keep)),
        style=_resource("report.css"),
        script=script,
        script_hash=_hash(script),
    )  # fmt: skip


def _environment() -> Environment:
    from jinja2 import Environment, StrictUndefined  # noqa: PLC0415 - only a report needs it

    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    filters = cast("dict[str, object]", environment.filters)  # jinja's own type lists only the filters it came with
    filters.update(duration=texts.duration, number=texts.number, percent=texts.percent, count=texts.count)
    return environment


def _json(value: Any) -> str:  # noqa: ANN401 - any JSON value
    """Return JSON that may stand inside a script element: no text of the user's can end the element."""
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _hash(script: str) -> str:
    """Return the digest by which the page's policy admits this script and no other."""
    return base64.b64encode(hashlib.sha256(script.encode("utf-8")).digest()).decode("ascii")


def _resource(name: str) -> str:
    return files("trochia").joinpath("data", "report", name).read_text(encoding="utf-8")
