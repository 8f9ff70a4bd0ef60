"""`trochia boards` and `trochia flash`: what is on a port, through real pseudo-terminals; what is written where."""

from __future__ import annotations

import json
import os
import shutil
import stat
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import serial
from click.testing import CliRunner

from trochia.backends.avr import flash, images, ports
from trochia.backends.avr.wiring import BOARDS
from trochia.cli import boards as boards_command
from trochia.cli import flash as flash_command
from trochia.errors import ConfigError, LinkError, VersionMismatch
from trochia.kernels.link import ANSWER, SCHEMA, TYPES, FrameReader, frame

if TYPE_CHECKING:
    from collections.abc import Callable

UNO = BOARDS["uno-stepdir"]
HEX = ":0400000012345678E8\n:00000001FF\n"


def look(board: Any) -> ports.Found:
    return ports.look(str(board.link), boots=0.4)


@pytest.mark.parametrize(
    ("name", "baud"), [("uno-stepdir", 115_200), ("uno-stepdir", 1_000_000), ("mega-stepdir", 115_200)]
)
def test_our_image_is_found_at_its_baud_rate(plug: Callable[..., Any], name: str, baud: int):
    found = look(plug(name, baud=baud))
    assert (found.kind, found.board, found.baud, found.schema) == ("trochia", name, baud, SCHEMA)
    assert found.text == f"{name} at {baud} baud, schema {SCHEMA:08x}"


def test_looking_changes_nothing_on_a_board(plug: Callable[..., Any]):
    board = plug("uno-stepdir")
    look(board)
    pins = np.concatenate(board.board.runs)
    assert not np.any((pins["kind"] == 1) & (pins["unit"] == b"D") & (pins["line"] >= 2))  # steps and directions


def mute(_came: bytes) -> bytes:
    return b""


def answering(schema: int) -> Callable[[bytes], bytes]:
    """Answers every hello with this schema."""
    reader = FrameReader()

    def answer(came: bytes) -> bytes:
        told = np.zeros((), ANSWER)
        told["schema"] = schema
        told["board"][:5] = np.frombuffer(b"other", np.uint8)
        return b"".join(
            frame(0, TYPES["answer"], told.tobytes()) for got in reader.feed(came) if got.kind == TYPES["hello"]
        )

    return answer


def test_an_image_of_another_version_is_told_with_both_schemas(plug: Callable[..., Any]):
    found = look(plug(answer=answering(0x1234ABCD)))
    assert found.kind == "trochia"
    assert "schema 1234abcd; this program speaks" in found.text
    assert f"{SCHEMA:08x}" in found.text


@pytest.mark.parametrize(
    ("answer", "kind", "text"),
    [
        (lambda came: b"<Idle|MPos:0,0,0|FS:0,0>\r\n" if b"?" in came else b"", "grbl", "a GRBL board: <Idle"),
        (lambda came: b"\r\nGrbl 1.1h ['$' for help]\r\n" if came else b"", "grbl", "Grbl 1.1h ['$' for help]"),
        (lambda came: b"echo: busy processing\n" if came else b"", "other", "neither our protocol nor GRBL's: 'echo"),
        (lambda came: bytes(range(128, 148)) if came else b"", "other", "make no sense: another baud rate"),
        (mute, "silent", "nothing answers"),
    ],
)  # fmt: skip
def test_strangers(plug: Callable[..., Any], answer: Callable[[bytes], bytes], kind: str, text: str):
    found = look(plug(answer=answer))
    assert found.kind == kind
    assert text in found.text


def test_a_grbl_board_gets_its_status_question_and_nothing_else(plug: Callable[..., Any]):
    heard = bytearray()

    def grbl(came: bytes) -> bytes:
        heard.extend(came)
        return b"<Idle|MPos:0,0,0>\r\n" * came.count(b"?")

    look(plug(answer=grbl))
    assert set(heard) == set(b"?")


def test_what_other_strangers_get_starts_no_motion_in_grbl():
    """No cycle start, no line that could be executed, no reset, no override."""
    assert not set(ports.question()) & {*b"~!?$\r\n\x18", *range(0x80, 0x100)}


def test_a_port_in_use_is_left_alone(plug: Callable[..., Any]):
    board = plug(answer=bytes)
    with serial.Serial(str(board.link), 115_200, exclusive=True):
        found = look(board)
    assert (found.kind, found.text) == ("closed", "is in use by another program")


def test_the_command_tells_of_every_port(plug: Callable[..., Any], monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(ports, "BOOTS", 0.3)
    board = plug(answer=answering(SCHEMA))
    done = CliRunner().invoke(boards_command.command, [str(board.link), "/dev/not-there", "--json"])
    rows = json.loads(done.stdout)["boards"]
    assert [row["kind"] for row in rows] == ["trochia", "closed"]
    assert rows[0]["schema"] == f"{SCHEMA:08x}"
    text = CliRunner().invoke(boards_command.command, ["/dev/not-there"]).stdout
    assert text == "/dev/not-there  is not there\n"


# -- images and flashing


def test_images_are_found_by_board_baud_and_schema(tmp_path: Path):
    (tmp_path / f"uno-stepdir-115200-{SCHEMA:08x}.hex").write_text(HEX)
    image = images.shipped("uno-stepdir", folder=tmp_path)
    assert (image.size, image.schema, image.baud) == (4, SCHEMA, 115_200)
    with pytest.raises(ConfigError, match="no image for uno-stepdir at 1000000") as caught:
        images.shipped("uno-stepdir", 1_000_000, folder=tmp_path)
    assert "gcc-avr" in str(caught.value)
    (tmp_path / "mega-stepdir-115200-00000001.hex").write_text(HEX)
    with pytest.raises(VersionMismatch, match=f"schema 00000001, this program with {SCHEMA:08x}"):
        images.shipped("mega-stepdir", folder=tmp_path)


@pytest.mark.parametrize("text", ["garbage", ":0400000012345678E9\n", ":04\n", "\x7fELF"])
def test_a_damaged_image_is_refused(tmp_path: Path, text: str):
    (tmp_path / "x.hex").write_text(text)
    with pytest.raises(ConfigError, match="no Intel HEX file"):
        _ = images.Image(path=tmp_path / "x.hex").size


def test_the_makefile_makes_what_is_looked_for(board_image: Callable[[str], Path], tmp_path: Path):
    board_image("uno-stepdir")
    subprocess.run(["make", "-s", "-C", "firmware/avr", "images", f"IMAGES={tmp_path}"], check=True,
                   cwd=Path(__file__).parents[3])  # fmt: skip
    for name in BOARDS:
        for baud in images.BAUDS:
            assert 5_000 < images.shipped(name, baud, folder=tmp_path).size < 30_720


@pytest.fixture
def hex_file(tmp_path: Path) -> Path:
    (tmp_path / "x.hex").write_text(HEX)
    return tmp_path / "x.hex"


@pytest.fixture
def avrdude(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str, int], Path]:
    """Puts a stand-in for avrdude on the path, which notes its arguments, says something and ends."""

    def make(says: str, code: int) -> Path:
        (tmp_path / "says").write_text(says)
        script = tmp_path / "avrdude"
        script.write_text(f'#!/bin/sh\necho "$@" > {tmp_path}/arguments\ncat {tmp_path}/says >&2\nexit {code}\n')
        script.chmod(script.stat().st_mode | stat.S_IXUSR)
        monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
        return tmp_path / "arguments"

    return make


def invoke(*arguments: str, answer: str | None = None) -> Any:
    return CliRunner().invoke(flash_command.command, arguments, input=answer)


def test_an_image_is_written_after_a_yes(plug: Callable[..., Any], avrdude: Callable[..., Path], hex_file: Path):
    arguments, board = avrdude("", 0), plug(answer=mute)
    done = invoke("uno-stepdir", "--port", str(board.link), "--image", str(hex_file), answer="y\n")
    assert done.exit_code == 0, done.output
    assert "4 bytes for uno-stepdir (atmega328p)" in done.output
    assert "holds uno-stepdir now" in done.output
    said = arguments.read_text().strip()
    assert said == f"-p atmega328p -c arduino -P {board.link} -b 115200 -D -U flash:w:{hex_file}:i"


def test_nothing_is_written_after_a_no_or_dry(plug: Callable[..., Any], avrdude: Callable[..., Path], hex_file: Path):
    arguments, board = avrdude("", 0), plug(answer=mute)
    port = ("--port", str(board.link), "--image", str(hex_file))
    assert invoke("uno-stepdir", *port, answer="n\n").exit_code == 1
    dry = invoke("mega-stepdir", *port, "--dry-run")
    assert f"would run: avrdude -p atmega2560 -c wiring -P {board.link}" in dry.output
    assert not arguments.exists()


def test_a_port_in_use_is_not_written_to(plug: Callable[..., Any], avrdude: Callable[..., Path], hex_file: Path):
    arguments, board = avrdude("", 0), plug(answer=mute)
    with serial.Serial(str(board.link), 115_200, exclusive=True):
        done = invoke("uno-stepdir", "--port", str(board.link), "--image", str(hex_file), "-y")
    assert isinstance(done.exception, LinkError)
    assert "is in use by another program" in str(done.exception)
    assert not arguments.exists()


def test_unknown_boards_and_unclear_ports(monkeypatch: pytest.MonkeyPatch, hex_file: Path):
    assert "no board is called 'due'" in invoke("due").output
    monkeypatch.setattr(ports, "names", lambda: {"/dev/a": None, "/dev/b": None})
    assert "--port DEVICE (there are /dev/a, /dev/b)" in invoke("uno-stepdir", "--image", str(hex_file)).output
    monkeypatch.setattr(ports, "names", dict)
    assert "is the cable in?" in invoke("uno-stepdir", "--image", str(hex_file)).output


ANOTHER = "Device signature = 0x1e9801 (probably m2560)\nerror: expected signature for ATmega328P is 1E 95 0F"


@pytest.mark.parametrize(
    ("said", "meaning"),
    [
        ("not in sync\navrdude error: unable to open programmer", "answers as the bootloader of uno-stepdir"),
        (ANOTHER, "is an ATmega2560 (Mega), not the atmega328p of uno-stepdir; nothing was written"),
        ("OS error: cannot open port P: Permission denied\nunable to open programmer", "may not use P"),
        ("OS error: cannot open port P: Device or resource busy", "another program has P open"),
        ("verification mismatch\n  device 0xff != input 0x0c at addr 0x0000", "is not what was written"),
        ("avrdude error: something new", "avrdude failed on P: avrdude error: something new"),
    ],
)  # fmt: skip
def test_what_avrdude_says_is_one_clear_line(avrdude: Callable[..., Path], hex_file: Path, said: str, meaning: str):
    avrdude(said, 1)
    with pytest.raises(LinkError) as caught:
        flash.write(UNO, images.Image(path=hex_file), "P")
    assert meaning in caught.value.message
    assert "\n" not in caught.value.message


def test_without_avrdude_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch, hex_file: Path):
    monkeypatch.setenv("PATH", "")
    with pytest.raises(ConfigError, match="apt-get install avrdude"):
        flash.write(UNO, images.Image(path=hex_file), "P")


@pytest.mark.skipif(shutil.which("avrdude") is None, reason="avrdude is not installed (packages-test.txt)")
def test_the_real_avrdude_misses_the_port(hex_file: Path):
    with pytest.raises(LinkError, match="there is no port /dev/not-there"):
        flash.write(UNO, images.Image(path=hex_file), "/dev/not-there")


def test_an_avrdude_that_never_ends_is_ended(
    avrdude: Callable[..., Path], hex_file: Path, monkeypatch: pytest.MonkeyPatch
):
    avrdude("", 0).with_name("avrdude").write_text("#!/bin/sh\nexec sleep 60\n")
    monkeypatch.setattr(flash, "PATIENCE", 0.2)
    with pytest.raises(LinkError, match="avrdude has not ended"):
        flash.write(UNO, images.Image(path=hex_file), "P")
