"""The made-up motion that the report's tests draw."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

SPECIMEN = runpy.run_path(str(Path(__file__).parents[2] / "report_specimen.py"))


@pytest.fixture(scope="session")
def hostile():
    return SPECIMEN["HOSTILE"]


@pytest.fixture(scope="session")
def contour():
    return SPECIMEN["contour"]()


@pytest.fixture(scope="session")
def failing():
    return SPECIMEN["contour"](depth=True, over=True)
