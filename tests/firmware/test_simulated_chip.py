"""The simulated chip against cycles counted by hand from the instruction set manual, and where libsimavr 1.6 errs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from trochia.backends.simulated_chip import LOST, PWM, ChipRun, SimulatedChip
from trochia.errors import LinkError

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

BIT = 17 * 8  # 115,200 baud: UBRR 16 at double speed
BYTE = 10 * BIT  # start, eight data, stop


@pytest.fixture
def counted(start: Callable[[str], SimulatedChip]) -> tuple[SimulatedChip, ChipRun]:
    chip = start("counted")
    return chip, chip.run_until(9_000)


def test_an_interrupt_costs_what_the_manual_says(counted: tuple[SimulatedChip, ChipRun]):
    run = counted[1]
    begin, end = (int(cycle) for cycle in run.edges("B0")[:2])
    rises, falls = (int(cycle) for cycle in run.edges("B1"))
    started = begin + 2  # after the sbi
    flag = started + 41  # the compare value is 40: one count after the counter stands on it
    assert rises == flag + 4 + 3  # entry, then the jump in the vector table
    assert falls == rises + 2
    # sbi, sts, 100 nops; and of the interrupt: entry, jump, sbi, cbi, reti
    assert end - begin == 2 + 2 + 100 + (4 + 3 + 2 + 2 + 4)


def test_waking_costs_four_cycles_more(counted: tuple[SimulatedChip, ChipRun]):
    run = counted[1]
    begin, rises = int(run.edges("B0")[2]), int(run.edges("B2")[0])
    assert rises == begin + 2 + 1001 + 4 + 4 + 3
    assert run.asleep == rises - 11 - (begin + 2 + 2 + 1)  # from the end of sbi, sts, sleep to the flag


def test_flags_are_cleared_one_by_one(counted: tuple[SimulatedChip, ChipRun]):
    run = counted[1]
    before, after = (int(cycle) for cycle in (run.edges("C0")[0], run.edges("C2")[0]))
    assert run.edges("C1")[0] == before  # both flags were up
    assert run.edges("C0")[1] == after  # A's is cleared
    assert run.edges("C1")[1] > after  # B's is not


def test_a_stopped_timer_keeps_its_count(counted: tuple[SimulatedChip, ChipRun]):
    rises, falls = (int(cycle) for cycle in counted[1].edges("C3"))
    assert 100 * 8 <= falls - rises <= 100 * 8 + 10  # a hundred counts; the program polls every five cycles


def test_compare_value_zero_matches(counted: tuple[SimulatedChip, ChipRun]):
    assert counted[1].edges("C4").size == 2
    assert counted[1].edges("C5").size == 0


def test_a_byte_takes_ten_bit_times(counted: tuple[SimulatedChip, ChipRun]):
    run = counted[1]
    assert run.sent == b"abc"
    ends = run.events["cycle"][run.events["kind"] == 2]
    assert np.diff(ends).tolist() == [BYTE, BYTE]  # back to back: one byte waits behind the shift register


def test_the_receiver_holds_two_bytes(counted: tuple[SimulatedChip, ChipRun]):
    chip, run = counted
    chip.feed(b"wxyz", not_before=run.cycle + 100)
    later = chip.run_until(200_000)
    assert later.sent == b"wx"
    assert later.lost == 2
    lost = later.events["cycle"][later.events["kind"] == LOST]
    assert lost.tolist() == [run.cycle + 100 + 3 * BYTE, run.cycle + 100 + 4 * BYTE]
    assert later.unread == 0


def test_memory_and_inputs(start: Callable[[str], SimulatedChip]):
    chip = start("counted")
    chip.write_memory(0x400, b"\x01\x02\x03")
    assert chip.read_memory(0x400, 4)[:3] == b"\x01\x02\x03"
    chip.set_pin("D3", 1)
    assert chip.run_until(10).edges("D3").size == 0  # what comes from outside is no edge of the chip's
    assert chip.read_memory(0x29, 1)[0] & 8  # PIND


def test_a_chip_that_is_gone_is_named(start: Callable[[str], SimulatedChip]):
    chip = start("counted")
    chip.close()
    with pytest.raises(LinkError, match="stopped answering"):
        chip.run_until(1)


def test_cycles_of_an_interrupt(counted: tuple[SimulatedChip, ChipRun]):
    costs = counted[0].interrupts()
    assert costs[11] == (1, 15, 15)  # TIMER1_COMPA: entry 4, jump 3, sbi 2, cbi 2, reti 4
    assert costs[12] == (1, 19, 19)  # TIMER1_COMPB wakes the chip: 4 more


def test_a_missed_compare_value_waits_for_the_whole_turn(start: Callable[[str], SimulatedChip]):
    rises, falls = (int(cycle) for cycle in start("units").run_until(80_000).edges("B0"))
    assert falls - rises == pytest.approx(65536 - 1000 + 500, abs=15)  # the program polls


def test_pwm_tells_its_duty(start: Callable[[str], SimulatedChip]):
    run = start("units").run_until(80_000)
    told = run.events[run.events["kind"] == PWM]
    assert [(row["unit"], int(row["line"]), int(row["value"])) for row in told][-2:] == [
        (b"2", 0, 64 | 255 << 16),
        (b"2", 0, 192 | 255 << 16),
    ]


def test_an_analogue_input(start: Callable[[str], SimulatedChip], image: Callable[[str], Path],
                           symbols: Callable[[Path], dict[str, int]]):  # fmt: skip
    chip, place = start("units"), symbols(image("units"))["voltage"]
    for millivolts in (2500, 1000):
        chip.set_analogue(3, millivolts)
        chip.run_until(chip.run_until(0).cycle + 120_000)
        assert int.from_bytes(chip.read_memory(place, 2), "little") == pytest.approx(millivolts * 1024 / 5000, abs=1)


@pytest.mark.parametrize(("name", "state"), [("lost", "crashed"), ("halted", "stopped"), ("counted", "runs")])
def test_how_a_program_ends(start: Callable[[str], SimulatedChip], name: str, state: str):
    assert start(name).run_until(50_000).state == state


def test_a_simulator_that_is_not_there_is_named(tmp_path: Path):
    with pytest.raises(LinkError, match="cannot be started"):
        SimulatedChip(tmp_path / "chip", tmp_path / "image.elf")
