"""The queue of a backend over a long time."""

from __future__ import annotations

import numpy as np

from trochia.backends.queue import Queue
from trochia.backends.segments import Segments


def test_stream_time_does_not_drift_in_a_long_run() -> None:
    queue, at = Queue(np.zeros(1)), 1800.0
    queue.clear(np.zeros(1), at)
    chance = np.random.default_rng(1)
    for _ in range(3000):
        rows = chance.uniform(0.0003, 0.004, 13)
        queue.add(Segments(duration=rows, joints=np.zeros((13, 1, 4)), line=np.zeros(13, np.uint32),
                           power=np.zeros(13, np.float32), slew=np.ones(13)), at, at - 0.2)  # fmt: skip
        queue.forget(at - 0.2)
        at += float(rows.sum()) + 5e-13  # a plan's own sum is another, always a little longer
    assert abs(queue.end - at) < 2e-12
