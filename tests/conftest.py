"""What every ring shares: how many cases a law is tried on."""

from __future__ import annotations

import importlib.util
import sys
from collections import Counter
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

# the checks run the same seeded sample each time; `make soak` runs a hundred times as many, freshly drawn
settings.register_profile("check", max_examples=60, deadline=None, derandomize=True, print_blob=True,
                          suppress_health_check=[HealthCheck.too_slow])  # fmt: skip
settings.register_profile("soak", max_examples=6000, deadline=None, print_blob=True,
                          suppress_health_check=[HealthCheck.too_slow])  # fmt: skip
settings.load_profile("check")


def _load(name):
    """Import a module that lies beside this file, once."""
    if name in sys.modules:
        return sys.modules[name]
    spec = importlib.util.spec_from_file_location(name, Path(__file__).with_name(f"{name}.py"))
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


for _name in ("steady_spans", "chip_motion", "random_spans", "spoilt_line", "faulty_session"):
    _load(_name)
chip_program, board_image = _load("chip_fixtures").chip_program, _load("chip_fixtures").board_image


@pytest.fixture(scope="session")
def grbl_model():
    """The strict model of a GRBL 1.1 board, as a module."""
    _load("grbl_language")
    return _load("grbl_model")


@pytest.fixture
def talk(chip_program, board_image, request):
    """Greets a board's image on the simulated chip."""

    def begin(board):
        talk = _load("board_talk").Talk(chip_program, board_image(f"{board}-1000000"), board)
        request.addfinalizer(talk.line.close)
        return talk

    return begin


@pytest.fixture
def register():
    """The motor shield's register, read from the chip's pins."""
    return _load("shield_pins").Register()


@pytest.fixture
def plug(chip_program, board_image, request, tmp_path):
    """Plugs a board in: its image on the simulated chip, or a function that answers, on a pseudo-terminal."""

    def begin(board=None, *, answer=None, baud=115_200, name="tty"):
        pseudo = _load("pseudo_board")
        if answer is None:
            file = board if baud == 115_200 else f"{board}-{baud}"
            mcu = importlib.import_module("trochia.backends.avr.wiring").BOARDS[board].mcu
            answer = pseudo.LiveChip(chip_program, board_image(file), mcu)
            request.addfinalizer(answer.close)
        made = pseudo.PseudoBoard(tmp_path / name, answer, baud=baud)
        made.board = answer
        request.addfinalizer(made.end)
        return made

    return begin


_compared = Counter[str]()  # programs compared with rs274 by all processes, see oracle/conftest.py


def pytest_sessionfinish(session):
    """Add up the programs this process has compared."""
    asked = getattr(session.config, "compared_with_rs274", {})
    if hasattr(session.config, "workeroutput"):
        session.config.workeroutput["compared_with_rs274"] = dict(asked)
    else:
        _compared.update(asked)


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node):
    """Add up the programs a worker has compared."""
    _compared.update(getattr(node, "workeroutput", {}).get("compared_with_rs274", {}))


def pytest_terminal_summary(terminalreporter):
    """Tell how many programs were compared with LinuxCNC's interpreter."""
    if _compared:
        terminalreporter.write_line(
            f"compared with rs274: {_compared['generated']} generated and {_compared['written']} written programs, "
            f"{_compared['accepted']} of them accepted"
        )
