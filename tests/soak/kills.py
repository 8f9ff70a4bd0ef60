"""kill -9 at random instants of a job: the journal opens, and names an executed point near the truth.

    python tests/soak/kills.py --count 200 --seed 1 --speed 20

Case N is made from seed N alone: an instant.  A process runs a program on the twin with a journal, its clock going
``speed`` times as fast as time, and tells each turn's truth through a pipe: stream time, line, place.  It is killed at
the instant.  What must hold:

- the journal opens, and tells a job that has not come to its end, with its text;
- the point it names was executed: its place is on the way told, not ahead of the truth;
- it is not older than one status period, 20 ms of the machine, than the last truth told;
- a new process on that journal says so in its alarm, and offers to go on from there.

Exit code 1: a case failed.
"""

from __future__ import annotations

import argparse
import os
import signal
import sys
import tempfile
import time
from pathlib import Path
from random import Random

from trochia.backends.live_twin import LiveTwin
from trochia.controller.interrupted import interrupted
from trochia.controller.runtime import PERIOD as TURN
from trochia.controller.runtime import Runtime
from trochia.machine.load import load
from trochia.messages import command as c

PROGRAM = Path(__file__).parents[2] / "programs" / "contour.ngc"
MACHINE = "laser"
PERIOD = 0.020 + TURN + 1e-6  #: one status period, and the turn that is under way [s]
SECONDS = 27.0  #: of the program


def run(folder: Path, speed: float, told: int) -> None:
    """Run the job with a journal, and tell each turn's truth."""
    runtime = Runtime(LiveTwin(load(MACHINE)), journal=folder)
    now = 0.0
    for command in (c.Enable(), c.ArmBeam(on=True), c.Load(name="job", text=PROGRAM.read_text()), c.Run()):
        ack = runtime.command(command, now)
        assert ack.ok, ack.reason
        now += TURN
        runtime.turn(now)
    begin, first = time.monotonic(), now
    while runtime.controller.state.value == "running":
        now += TURN
        runtime.turn(now)
        report = runtime.controller.report
        place = runtime.controller.position()
        line = f"{now:.6f} {report.executed:.9f} {report.line} {place['X']:.9f} {place['Y']:.9f}\n"
        os.write(told, line.encode())
        time.sleep(max(0.0, (now - first) / speed - (time.monotonic() - begin)))


def case(seed: int, speed: float) -> str:
    """Kill one job; return what the journal said."""
    draw = Random(seed)  # noqa: S311 - for tests
    instant = draw.uniform(0.1, SECONDS - 0.5)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "journal"
        told = killed(folder, instant, speed)
        assert told, "nothing was told"
        job = interrupted(folder)
        assert job is not None, "the journal tells of no job"
        assert not job.closed
        assert job.text == PROGRAM.read_text()
        truth = told[-1]
        places = {(round(row[3], 6), round(row[4], 6)) for row in told}
        at = (round(job.position["X"], 6), round(job.position["Y"], 6))
        age = truth[1] - job.done_s  # nothing moved before: stream time is the program's
        assert at in places or age < 0.0, f"{at} was never told"
        assert -PERIOD <= age <= PERIOD, f"{age:.4f} s old"
        assert job.line in {row[2] for row in told[-10:]}
        fresh = Runtime(LiveTwin(load(MACHINE)), journal=folder)
        alarm = fresh.status.alarms[0]
        assert f"line {job.line}" in alarm.message
        fresh.close()
        return f"line {job.line}, {job.distance:.3f} mm, {1000 * age:.0f} ms old"


def killed(folder: Path, instant: float, speed: float) -> list[tuple[float, float, int, float, float]]:
    """Run a job, kill it at an instant of its clock, and return what it told: time, stream time, line, X, Y."""
    out, told = os.pipe()
    process = os.fork()  # what is imported need not be again
    if process == 0:
        code = 1
        try:
            run(folder, speed, told)
            code = 0
        finally:
            os._exit(code)
    os.close(told)
    rows: list[tuple[float, float, int, float, float]] = []
    with os.fdopen(out) as lines:
        for line in lines:
            rows.append(_row(line))
            if rows[-1][0] >= instant:
                os.kill(process, signal.SIGKILL)
                break
        rows += [_row(line) for line in lines if line.count(" ") == 4 and line.endswith("\n")]
    os.waitpid(process, 0)
    return rows


def _row(line: str) -> tuple[float, float, int, float, float]:
    now, executed, number, x, y = line.split()
    return float(now), float(executed), int(number), float(x), float(y)


def main() -> int:
    """Run the campaign."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--speed", type=float, default=20.0)
    given = parser.parse_args()
    failed = 0
    for seed in range(given.seed, given.seed + given.count):
        try:
            said = case(seed, given.speed)
        except AssertionError as error:
            failed += 1
            said = f"FAILED: {error}"
        print(f"seed {seed}: {said}", flush=True)
    print(f"{given.count} cases from seed {given.seed}, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
