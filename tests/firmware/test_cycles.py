"""The committed cycle budget is the image's."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

ROOT = Path(__file__).parents[2]


def test_the_page_is_what_the_image_takes(chip_program: Path, board_image: Callable[[str], Path]):
    spec = importlib.util.spec_from_file_location("cycles_on_chip", ROOT / "benchmarks" / "cycles_on_chip.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    made = module.page(chip_program, board_image("uno-stepdir-1000000"))
    assert made == module.PAGE.read_text(), "run: python benchmarks/cycles_on_chip.py"
