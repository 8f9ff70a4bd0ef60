"""What a sender that speaks GRBL 1.1 sees of the machine, and what the machine does for it."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest

from trochia.controller.hooks import Hooks, codes_in
from trochia.controller.runtime import Runtime
from trochia.gateways.grbl import Service
from trochia.program import WorkState

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from tests.unit.gateways.conftest import Plant

STATUS = re.compile(r"<(\w+)(:\d)?\|MPos:(-?\d+\.\d{3}),(-?\d+\.\d{3}),(-?\d+\.\d{3})\|Bf:\d+,\d+(\|Ln:\d+)?"
                    r"\|FS:\d+,\d+(\|WCO:[-\d.,]+)?(\|Ov:\d+,\d+,\d+)?>\Z")  # fmt: skip


def test_status_has_the_documented_form_with_offsets_now_and_then(mill: Plant) -> None:
    lines = [mill.status() for _ in range(12)]
    assert all(STATUS.match(line) for line in lines)
    assert "WCO" in lines[0]
    assert "Ov" in lines[1]
    assert lines[2].startswith("<Idle|MPos:0.000,0.000,0.000|")


def test_settings_are_those_of_the_machine_file(mill: Plant) -> None:
    answer = mill.say("$$\n")
    assert answer[-1] == "ok"
    found = dict(line.split("=") for line in answer[:-1])
    assert found["$130"] == "1000.000"
    assert found["$30"] == "24000"
    assert found["$22"] == "0"


def test_settings_cannot_be_changed_but_for_the_report(mill: Plant) -> None:
    answer = mill.say("$110=99999\n")
    assert answer[-1] == "error:3"
    assert "machine file" in answer[0]
    assert mill.say("$10=0\n") == ["ok"]
    assert mill.status().startswith("<Idle|WPos:")


@pytest.mark.parametrize(("line", "answers"), [
    ("$", "[HLP:"), ("$G", "[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]"), ("$I", "[VER:1.1h"), ("$#", "[G54:"),
    ("$N", "$N0="),
])  # fmt: skip
def test_questions_are_answered(mill: Plant, line: str, answers: str) -> None:
    answer = mill.say(line + "\r\n")
    assert answer[0].startswith(answers)
    assert answer.count("ok") == 1


@pytest.mark.parametrize(("line", "number"), [
    ("G1 X1", 22), ("G33 Z1 K1", 20), ("G81 X1 Z-1 R1 F100", 20), ("M6", 20), ("G0 G1 X1", 21), ("X1 X2", 25),
    ("G1 X", 2), ("1", 1), ("G2 X1 Y1 F100", 35), ("G2 F100", 26), ("G80 X1", 31), ("G4", 28), ("G53 G2 X1 I1 F1", 30),
    ("G0 X1 P3", 36),
    ("F-1", 4), ("$nonsense", 3), ("$H", 5), ("$J=X1", 22), ("$J=G2X1F1", 16), ("$J=X2000F100", 15), ("$J=F100", 26),
    ("G0 X1" + " " * 80, 11), ("G59.1", 20), ("#1=2", 1), ("O1", 20), ("T-1", 4),
])  # fmt: skip
def test_wrong_lines_have_grbls_numbers_and_move_nothing(mill: Plant, line: str, number: int) -> None:
    assert mill.say(line + "\n") == [f"error:{number}"]
    assert mill.status().startswith("<Idle|MPos:0.000,0.000,0.000|")


def test_lines_are_carried_out_with_the_modes_they_leave(mill: Plant) -> None:
    assert mill.say("G91\nG1 X10 F3000\nX5\n(remark) y2.5 ; more\n\nG20\nX1\n", 3.0) == ["ok"] * 7
    assert mill.place() == pytest.approx({"X": 40.4, "Y": 2.5, "Z": 0.0})
    assert mill.say("X-1\n", 2.0) == ["ok"]  # in a text of its own, modes as they were
    assert mill.place()["X"] == pytest.approx(15.0)


def test_offsets_and_coordinate_systems_are_kept(mill: Plant) -> None:
    mill.say("G10 L2 P2 X100 Y50\nG55\nG0 X0 Y0\n", 3.0)
    assert mill.place()["X"] == pytest.approx(100.0)
    assert "[G55:100.000,50.000,0.000]" in mill.say("$#\n")
    mill.say("G92 X7\n")
    assert any("WCO:93.000,50.000,0.000" in mill.status() for _ in range(11))
    mill.say("G0 X0\n", 2.0)
    assert mill.place()["X"] == pytest.approx(93.0)


def test_the_spindle_turns_on_between_texts_and_stops_at_the_end(mill: Plant) -> None:
    mill.say("M3 S5000\nG0 X1\n", 2.0)
    mill.say("G0 X2\n", 2.0)
    assert mill.runtime.status.spindle == 5000
    mill.say("M30\n", 1.0)
    assert mill.runtime.status.spindle == 0
    assert "M5" in mill.say("$G\n")[0]


def test_hold_and_resume_end_where_they_should(mill: Plant) -> None:
    mill.say("G1 X50 F3000\n", 0.4)
    assert mill.say("!", 0.3) == []
    assert mill.status().startswith("<Hold:0")
    held = mill.place()["X"]
    mill.run(1.0)
    assert mill.place()["X"] == held
    assert 0 < held < 50
    mill.say("~", 3.0)
    assert mill.place()["X"] == pytest.approx(50.0)
    assert mill.status().startswith("<Idle")


def test_a_soft_reset_stops_drops_what_waits_and_keeps_the_position(mill: Plant) -> None:
    mill.say("G1 X50 F3000\nX0\nX50\nM3 S100\n", 0.4)
    assert mill.say(b"\x18", 1.0) == ["Grbl 1.1h ['$' for help]"]
    stood = mill.place()["X"]
    assert 0 < stood < 50
    assert mill.status().startswith(f"<Idle|MPos:{stood:.3f}")
    mill.run(2.0)
    assert mill.place()["X"] == stood
    assert mill.say("G0 X0\n", 2.0) == ["ok"]
    assert mill.place()["X"] == pytest.approx(0.0, abs=1e-9)


def test_overrides_step_and_return(mill: Plant) -> None:
    mill.say(bytes([0x91, 0x91, 0x94, 0x96, 0x9B]))
    over = mill.runtime.status.overrides
    assert (over.feed, over.rapid, over.spindle) == pytest.approx((1.19, 0.5, 0.9))
    assert any("Ov:119,50,90" in mill.status() for _ in range(11))
    mill.say(bytes([0x90, 0x95, 0x99] + [0x92] * 30))
    over = mill.runtime.status.overrides
    assert (over.feed, over.rapid, over.spindle) == pytest.approx((0.1, 1.0, 1.0))


def test_jogs_follow_one_another_inside_the_travel(mill: Plant) -> None:
    assert mill.say("$J=G91 X5 F3000\n$J=G91 X5 Y1 F3000\n$J=G90 G21 Y3 F6000\n", 3.0) == ["ok"] * 3
    assert mill.place() == pytest.approx({"X": 10.0, "Y": 3.0, "Z": 0.0})
    assert mill.say("$J=G91 X489 F3000\n$J=G91 X2 F100\n", 0.1) == ["ok", "error:15"]


def test_a_jog_cancel_brakes_and_drops_the_others(mill: Plant) -> None:
    mill.say("$J=G91 X100 F1200\n$J=G91 Y100 F1200\n", 0.6)
    assert mill.status().startswith("<Jog")
    assert mill.say(b"\x85", 0.5) == []
    assert mill.status().startswith("<Idle")
    assert 0 < mill.place()["X"] < 20
    assert mill.place()["Y"] == 0.0


def test_lines_are_refused_while_jogging(mill: Plant) -> None:
    mill.say("$J=G91 X20 F600\n", 0.3)
    assert mill.say("G0 X0\n", 0.05) == ["error:9"]


def test_beyond_the_travel_is_alarm_two_and_moves_nothing(mill: Plant) -> None:
    answer = mill.say("G0 X5000\n", 1.0)
    assert answer[:2] == ["ok", "ALARM:2"]
    assert "travel" in answer[2]
    assert mill.place()["X"] == 0.0
    assert mill.say("G0 X1\n") == ["error:9"]
    assert mill.say("$X\n")[-1] == "ok"
    assert mill.say("G0 X1\n", 1.0) == ["ok"]
    assert mill.place()["X"] == pytest.approx(1.0)


def test_check_mode_reads_and_moves_nothing(mill: Plant) -> None:
    assert mill.say("$C\n") == ["[MSG:Enabled]", "ok"]
    assert mill.say("G1 X5 F100\nG1 Q\n", 1.0) == ["ok", "error:2"]
    assert mill.status().startswith("<Check")
    assert "Grbl 1.1h ['$' for help]" in mill.say("$C\n")
    assert mill.place()["X"] == 0.0


def test_a_program_stop_waits_for_the_sender(mill: Plant) -> None:
    mill.say("G0 X5\nM0\nG0 X9\n", 2.0)
    assert mill.status().startswith("<Hold:0")
    assert mill.place()["X"] == pytest.approx(5.0)
    mill.say("~", 2.0)
    assert mill.place()["X"] == pytest.approx(9.0)


def test_numbered_lines_are_told_by_their_number(mill: Plant) -> None:
    mill.say("N10 G1 X5 F600\nN20 X10\nN30 X15\n", 1.0)
    assert "|Ln:20|" in mill.status() or "|Ln:10|" in mill.status()


def test_a_hold_between_two_texts_keeps_the_second_from_beginning(mill: Plant) -> None:
    mill.say("G0 X1\n!", 1.0)
    assert mill.status().startswith("<Hold:0")
    assert mill.place()["X"] == 0.0
    mill.say("~", 1.0)
    assert mill.place()["X"] == pytest.approx(1.0)


@pytest.mark.parametrize("stop", [b"!", b"\x18"], ids=["hold", "reset"])
@pytest.mark.parametrize(
    "what", ["G1 X90 F3000\nY50\nX0\nY0\n" * 3, "$J=G91 X30 F6000\n$J=G91 Y30 F6000\n"], ids=["lines", "jogs"]
)
def test_a_stop_at_any_instant_stops_for_good(plants: Callable[..., Plant], stop: bytes, what: str) -> None:
    plant = plants()
    for turns in range(14):  # as near to the start of motion as turns are
        plant.say(what, 0.005 * turns)
        plant.say(stop, 0.6)
        stood = plant.place()
        plant.run(0.4)
        assert plant.place() == stood, turns
        plant.say(b"\x18", 0.6)
        assert plant.status().startswith("<Idle"), turns
        assert plant.say("G90\n", 0.1)[-1] == "ok"
        plant.say("G0 X0 Y0\n", 3.0)
        assert plant.place()["X"] == pytest.approx(0.0, abs=1e-9), turns


def test_more_lines_than_may_wait_are_answered_later(mill: Plant, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("trochia.gateways.grbl.queue.MOST", 3)
    answers = mill.say("G0 X1\nX2\nX3\nX4\nX5\n", 0.02)
    assert answers == ["ok"] * 3
    assert mill.say("", 3.0) == ["ok"] * 2
    assert mill.place()["X"] == pytest.approx(5.0)


def test_a_sender_that_is_gone_leaves_the_machine_held(mill: Plant) -> None:
    mill.say("G1 X50 F1000\n", 0.5)
    mill.door.gone = True
    mill.run(0.5)
    assert mill.runtime.status.state == "held"


def test_a_machine_with_switches_is_locked_until_homed(plants: Callable[..., Plant]) -> None:
    plant = plants(homed=True)
    assert plant.say("") == ["Grbl 1.1h ['$' for help]", "[MSG:'$H'|'$X' to unlock]"]
    assert plant.status().startswith("<Alarm")
    assert plant.say("G0 X1\n") == ["error:9"]
    assert plant.say("$H\n", 0.5) == []
    assert plant.status().startswith("<Home")
    plant.run(120.0, until=lambda: bool(plant.door.outward))
    assert plant.say("") == ["ok"]
    assert plant.status().startswith("<Idle")
    assert all(axis.trusted for axis in plant.runtime.status.axes)
    assert plant.say("G0 X1 Y2\n", 20.0) == ["ok"]
    assert plant.place() == pytest.approx({"X": 1.0, "Y": 2.0, "Z": -15.0})


def test_a_machine_unlocked_without_homing_takes_jogs_only(plants: Callable[..., Plant]) -> None:
    plant = plants(homed=True)
    assert plant.say("$X\n")[-1] == "ok"
    assert plant.say("G91 G0 X1\n")[-1] == "error:9"
    assert plant.say("M3 S100\n") == ["ok"]
    assert plant.say("$J=G91 X1 F600\n", 2.0) == ["ok"]
    assert plant.place()["X"] == pytest.approx(1.0)


@pytest.mark.parametrize("arm", [False, True])
def test_a_beam_is_lit_only_where_it_was_armed(plants: Callable[..., Plant], *, arm: bool) -> None:
    plant = plants("xy-table", arm=arm)
    plant.say("$X\n")
    plant.say("M3 S1\nG91 G1 X5 F600\n", 0.0)
    lit = [False]

    def look(_: float) -> None:
        lit[0] = lit[0] or plant.runtime.status.beam > 0

    plant.beside = look
    plant.run(3.0)
    assert lit[0] is arm


@pytest.mark.parametrize("noise", [b"\x00\xff\xfe\x80", b"\x07" * 500 + b"\n", b"$J=\n$\xc3\n%%%\n", b"G" * 1000])
def test_noise_moves_nothing_and_is_survived(mill: Plant, noise: bytes) -> None:
    mill.say(noise)
    mill.say("\n")
    assert mill.say("G0 X1\n", 1.0)[-1] == "ok"
    assert mill.place()["X"] == pytest.approx(1.0)


def test_codes_of_the_machines_own_run_their_programs(plants: Callable[..., Plant], tmp_path: Path) -> None:
    script = tmp_path / "M101"
    script.write_text('#!/bin/sh\necho "$@" >> ran\n')
    script.chmod(0o755)
    plant = plants()
    codes = codes_in(tmp_path)
    plant.runtime = Runtime(plant.runtime.backend, work=WorkState(user_codes=codes))
    plant.service = Service(plant.runtime, plant.door)
    hooks = Hooks(tmp_path, plant.runtime, blocking=True)
    plant.say("")
    assert plant.say("G21 G91 G1 X1 F600\nM101 P3 Q0.5\nG1 X1\n", 2.0) == ["ok"] * 3
    plant.run(5.0, lambda: plant.place()["X"] == pytest.approx(2.0))
    assert (tmp_path / "ran").read_text() == "3.000000 0.500000\n"
    assert plant.say("M102\n") == ["error:20"]
    assert plant.say("G1 X1 Q1\n") == ["error:20"]
    hooks.close()
