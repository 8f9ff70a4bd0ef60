"""Frames of the link: what is put in comes out, whatever the line adds to it or takes from it in between."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.kernels.link import PAYLOAD, FrameReader, frame

frames = st.tuples(st.integers(0, 255), st.integers(0, 255), st.binary(max_size=PAYLOAD))


@given(st.lists(frames, max_size=4), st.integers(1, 50))
def test_frames_come_out_as_they_went_in(sent: list[tuple[int, int, bytes]], piece: int):
    line = b"".join(frame(*each) for each in sent)
    reader = FrameReader()
    got = [each for i in range(0, len(line), piece) for each in reader.feed(line[i : i + piece])]
    assert [tuple(each) for each in got] == sent


@given(frames)
def test_a_zero_only_ends_a_frame(sent: tuple[int, int, bytes]):
    assert frame(*sent).index(0) == len(frame(*sent)) - 1


@pytest.mark.parametrize("payload", [b"", b"\0", bytes(range(40)), bytes(PAYLOAD), b"\xff" * PAYLOAD])
def test_every_flipped_bit_and_every_byte_cut_or_doubled_is_seen(payload: bytes):
    line, after = frame(7, 1, payload), frame(8, 2, b"next")
    for i in range(len(line)):
        spoilt = [line[:i] + bytes([line[i] ^ 1 << bit]) + line[i + 1 :] for bit in range(8)]
        spoilt += [line[:i], line[:i] + line[i + 1 :]] if line[i] else []  # the zero after it ends it as well
        spoilt += [line[:i] + line[i : i + 1] + line[i:]] if line[i] else []  # another zero is none
        for data in spoilt:
            got = list(FrameReader().feed(data + b"\0" + after))
            assert [each for each in got if each.kind >= 0] == [(8, 2, b"next")]


def test_what_is_too_long_for_a_frame_is_broken_and_over_at_the_next_zero():
    got = list(FrameReader().feed(b"\xfe" + b"x" * 253 + b"\xff" + b"y" * 254 + b"\0\0\0" + frame(1, 2, b"3")))
    assert got == [(0, -1, b""), (1, 2, b"3")]


def test_a_payload_above_the_greatest_is_refused():
    with pytest.raises(ValueError, match="at most"):
        frame(0, 1, bytes(PAYLOAD + 1))
