"""What steps, bends and spans cost a board's processor, from the rates at which its image just keeps up.

    python benchmarks/load_on_chip.py [BOARD] > build/load.txt

In: a board's image on the simulated chip at 1,000,000 baud, a status asked for a hundred times a second.  For every
number of motors, lengths of spans and strides the greatest rate is sought at which no tick is missed, by halving.  Out:
those rates, and by number of motors the least costs with which rate · step + bends · bend + spans · span comes to
16,000,000 cycles a second or more at each of them: the table of ``trochia.backends.avr.load``.  What takes turns all
the time (slices, the line, statuses) is in them in proportion.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from scipy.optimize import linprog

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests"))
import board_talk  # noqa: E402 - the tests' folder is no package
import steady_spans  # noqa: E402
from trochia.backends.avr.wiring import BOARDS  # noqa: E402
from trochia.kernels.link import CAUSES  # noqa: E402

CLOCK = 16e6
SECONDS = 0.6  #: of motion a try: more than the queue holds
LENGTHS = (1 << 15, 1 << 16, 1 << 17, 1 << 18, 1 << 19)  #: of spans [ticks]
RUNS, BENT, SEVERAL = (8, 20, 60, 100), (1, 2, 4, 7), (1, 4, 20, 100)  #: strides of one motor, of one, of several
NEAR = 1.02  #: two rates that are as good as one


def cause(rates: list[float], ticks: int, stride: int, *, board: str = "uno-stepdir", seconds: float = SECONDS) -> str:
    """Return why motion at these rates ended, ``no_cause`` if it went to its end."""
    count = max(round(seconds * CLOCK / ticks), 4)
    spans = steady_spans.steady(rates, count, ticks=ticks, stride=stride, slew=3000)
    talk = board_talk.Talk(ROOT / "build/sim/chip", ROOT / f"build/avr/{board}-1000000.elf", board)
    try:
        return CAUSES[int(talk.stream(spans)["cause"])]
    finally:
        talk.line.close()


def apart(total: float, motors: int) -> list[float]:
    """Return rates of motors that make a total together, none like another."""
    each = 1.0 + 0.013 * np.arange(motors)
    return (total * each / each.sum()).tolist()


def greatest(board: str, motors: int, ticks: int, stride: int) -> float:
    """Return the greatest rate of all motors together that is kept [Hz]."""
    low, high = 4e3, 0.97 * motors * CLOCK / BOARDS[board].closest
    while high > NEAR * low:
        middle = (low * high) ** 0.5
        kept = cause(apart(middle, motors), ticks, stride, board=board) == "no_cause"
        low, high = (middle, high) if kept else (low, middle)
    return low


def seek(board: str, motors: int, strides: tuple[int, ...]) -> None:
    """Seek rates and the costs that explain them; print both."""
    rows: list[tuple[float, float, float]] = []
    for ticks in LENGTHS:
        for stride in strides:
            rate = greatest(board, motors, ticks, stride)
            rows.append((rate, rate / stride, CLOCK / ticks))
            print(f"{motors} motors, spans of {1e3 * ticks / CLOCK:.0f} ms, stride {stride}: {rate:,.0f} steps/s",
                  flush=True)  # fmt: skip
    parts = np.array(rows) / CLOCK
    cost = linprog(parts.sum(axis=0), A_ub=-parts, b_ub=-np.ones(len(parts)), bounds=[(0.0, None)] * 3).x
    told = parts @ cost
    print(f"{board}, {motors} motors, strides {strides}: step {cost[0]:.0f}, bend {cost[1]:.0f}, span {cost[2]:.0f};",
          f"{told.min():.2f} to {told.max():.2f}, {told.mean():.2f}", flush=True)  # fmt: skip


def main() -> None:
    """Seek for one motor in runs, one on the grid, and several."""
    board = sys.argv[1] if len(sys.argv) > 1 else "uno-stepdir"
    seek(board, 1, RUNS)
    seek(board, 1, BENT)
    for motors in range(2, BOARDS[board].motors + 1):
        seek(board, motors, SEVERAL)


if __name__ == "__main__":
    main()
