"""Laws of recording files: what is written is read, whatever the channels, the blocks and the place of a crash."""

from __future__ import annotations

import os
import tempfile
from contextlib import suppress
from pathlib import Path

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from trochia.recorder import Channel, Header, RecordingWriter, gather, read, write
from trochia.recorder.channel import SCALARS

texts = st.text(st.characters(exclude_categories=["Cs"]), max_size=8)


@st.composite
def recorded(draw):
    """Draw a header and blocks of any bit patterns."""
    kinds = draw(st.lists(st.sampled_from(SCALARS), min_size=1, max_size=6))
    name = texts.filter(bool)
    named = draw(st.lists(name, min_size=len(kinds), max_size=len(kinds), unique=True))
    header = Header(
        period=draw(st.floats(1e-6, 10)),
        start=draw(st.floats(-1e6, 1e6)),
        duration=draw(st.floats(0, 1e6)),
        machine=draw(texts),
        program=draw(texts),
        channels=tuple(Channel(name=n, dtype=kind, unit=draw(texts)) for n, kind in zip(named, kinds, strict=True)),
    )
    sizes = draw(st.lists(st.integers(0, 9), max_size=4))
    return header, [{c.name: draw(arrays(np.dtype(c.dtype), size)) for c in header.channels} for size in sizes]


def same(a, b):
    assert a.header == b.header
    assert len(a) == len(b)
    for name, samples in a.channels.items():
        assert samples.tobytes() == b[name].tobytes()  # bit for bit: a NaN's payload too


@given(recorded())
def test_what_is_written_is_read(case):
    header, blocks = case
    with tempfile.TemporaryDirectory() as folder:
        write(Path(folder, "run"), header, blocks)
        same(read(Path(folder, "run"), verify=True), gather(header, blocks))


@given(recorded(), st.data())
def test_a_file_cut_anywhere_reads_up_to_its_last_whole_record(case, data):
    header, blocks = case
    with tempfile.TemporaryDirectory() as folder:
        with suppress(KeyboardInterrupt), RecordingWriter(Path(folder, "run"), header) as writer:
            for block in blocks:
                writer.write(block)
            raise KeyboardInterrupt
        file = writer.partial / "samples.bin"
        size = data.draw(st.integers(0, file.stat().st_size))
        os.truncate(file, size)
        part, whole = read(writer.partial), gather(header, blocks)
        assert not part.complete
        assert len(part) == size // header.record.itemsize
        for name, samples in part.channels.items():
            assert samples.tobytes() == whole[name][: len(part)].tobytes()
