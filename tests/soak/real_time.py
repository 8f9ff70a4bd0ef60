"""A long run on the twin, in real time or by a virtual clock: no underrun, and what it asks of the host.

    python tests/soak/real_time.py --minutes 10
    python tests/soak/real_time.py --minutes 60 --virtual

The contour is repeated until the time is over, by `trochia run` with a journal.  Exit code 1: an alarm, an underrun.
"""

from __future__ import annotations

import argparse
import json
import math
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

PROGRAM = Path(__file__).parents[2] / "programs" / "contour.ngc"
MACHINE = "laser"
SECONDS = 27.5  #: of one contour


def text(minutes: float) -> str:
    """Return the contour, again and again for so long."""
    body = PROGRAM.read_text().replace("M2\n", "")
    return f"o1 repeat [{math.ceil(60.0 * minutes / SECONDS)}]\n{body}o1 endrepeat\nM2\n"


def main() -> int:
    """Run it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--virtual", action="store_true")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "contours.ngc"
        program.write_text(text(given.minutes))
        start = "from trochia.cli import main; main()"
        command = [sys.executable, "-c", start, "run", str(program), "-m", MACHINE, "-y", "--json",
                   "--journal", str(Path(folder) / "journal"), *(["--virtual"] if given.virtual else [])]  # fmt: skip
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    if not done.stdout:
        print(done.stderr)
        return 1
    told = json.loads(done.stdout)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"{told['time_s']:.0f} s of the machine, {used.ru_utime + used.ru_stime:.1f} s of processor time in all")
    for key, value in (told["host"] or {}).items():
        print(f"  {key}: {value:.1f}")
    for alarm in told["alarms"]:
        print(f"  {alarm}")
    return 0 if told["ok"] else 1


if __name__ == "__main__":
    sys.exit(main())
