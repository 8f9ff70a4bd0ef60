"""Sphinx: the documentation, in MyST Markdown; `make docs` fails on any warning."""

import runpy
from importlib import metadata
from pathlib import Path

project = "Trochia"
release = metadata.version("trochia")
author = copyright = "the Trochia authors"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.viewcode"]
myst_enable_extensions = ["dollarmath", "colon_fence", "deflist"]
myst_heading_anchors = 3
exclude_patterns = ["_build"]
html_theme = "furo"
html_title = f"Trochia {release}"
autodoc_member_order = "bysource"
autodoc_typehints = "description"
nitpicky = False

for _pages in ("language_pages.py", "api_pages.py"):
    runpy.run_path(str(Path(__file__).parent / _pages))["write"]()
