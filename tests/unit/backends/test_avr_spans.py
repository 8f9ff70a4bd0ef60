"""Spans of a queue: each is a stretch of time, and all steps are in them."""

from __future__ import annotations

import numpy as np

from trochia.backends.avr.spans import SpanMaker, steps_made
from trochia.backends.queue import Queue
from trochia.backends.segments import Segments


def test_rows_that_begin_between_two_ticks_make_no_empty_spans():
    """The slew falls to a fifth from row to row, so that each row is a span."""
    rows = 13
    length = 0.05 / rows  # 61,538.46 ticks
    starts = np.arange(rows) * length
    speed = 10.0  # mm/s
    joints = np.zeros((rows, 1, 4))
    joints[:, 0, 0], joints[:, 0, 1] = speed * starts, speed
    queue = Queue(np.zeros(1))
    queue.add(
        Segments(
            duration=np.full(rows, length), joints=joints, line=np.ones(rows, np.uint32),
            power=np.zeros(rows, np.float32), slew=np.geomspace(3000.0, 3000.0 * 0.2 ** (rows - 1), rows),
        ),
        0.0, 0.0,
    )  # fmt: skip
    maker = SpanMaker(np.array([1000.0]), 16_000_000, lambda _power: 0)
    spans = []
    while (span := maker.make(queue, [], lambda _tick: 0)) is not None:
        spans.append(span)
        assert len(spans) < 100
    assert all(span.end > span.start for span in spans)
    assert len(spans) == rows
    assert int(sum(steps_made(span)[0] for span in spans)) == maker.count[0]
    assert abs(maker.count[0] - 1000 * speed * 0.05) <= 1
