"""A small recording of every dtype, and how to break its files."""

from __future__ import annotations

import json

import numpy as np
import pytest

from trochia.recorder import Channel, Header


@pytest.fixture
def header():
    return Header(
        period=0.001,
        start=0.25,
        duration=0.9995,
        machine="bench",
        program="square.ngc",
        origin="made up",
        channels=(
            Channel(name="beam", dtype="|u1"),
            Channel(name="X.commanded", unit="mm"),
            Channel(name="X.actual", unit="mm"),
            Channel(name="joint.X.motor", unit="mm", dtype="<f4"),
            Channel(name="joint.X.counts", unit="count", dtype="<i8"),
            Channel(name="path.line", dtype="<u4"),
        ),
    )


@pytest.fixture
def block(header):
    """Return a maker of blocks: n samples from a seed."""

    def make(n, seed=0):
        random = np.random.default_rng(seed)
        return {
            channel.name: random.normal(0, 100, n).astype(channel.dtype)
            if channel.dtype[1] == "f"
            else random.integers(0, 200, n).astype(channel.dtype)
            for channel in header.channels
        }

    return make


@pytest.fixture
def edit():
    """Return a function that changes keys of a recording's sidecar (None takes a key away)."""

    def change(folder, **keys):
        path = folder / "recording.json"
        sidecar = json.loads(path.read_text()) | keys
        path.write_text(json.dumps({key: value for key, value in sidecar.items() if value is not None}))

    return change
