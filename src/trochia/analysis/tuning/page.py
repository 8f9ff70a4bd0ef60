"""The tuning report as one HTML page: the picture and its figures, nothing fetched from anywhere.

In: a title, an SVG, rows of a table.  Out: text.
"""

from __future__ import annotations

from html import escape

_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #222; margin: 2rem auto; max-width: 72rem; padding: 0 1rem; }
h1 { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); }
svg { width: 100%; height: auto; }
table { border-collapse: collapse; } td { padding: .25rem 1.5rem .25rem 0; border-bottom: 1px solid #e2e2e2; }
td + td { font-variant-numeric: tabular-nums; }
"""


def page(title: str, svg: str, rows: list[tuple[str, str]]) -> str:
    """Return the page."""
    picture = svg[svg.index("<svg") :]  # an XML head has no place in a page
    table = "\n".join(f"<tr><td>{escape(name)}</td><td>{escape(value)}</td></tr>" for name, value in rows)
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>'
        f"<style>{_STYLE}</style></head>\n<body><h1>{escape(title)}</h1>\n{picture}\n<table>\n{table}\n</table>"
        "</body></html>\n"
    )
