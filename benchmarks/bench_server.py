"""What serving costs: eight viewers at 50 Hz, how soon a command moves the machine, and what a real-time run takes.

The server is `trochia serve` in a process of its own; its main thread does the serving and nothing else, so that
thread's processor time is the cost.  The controller's clock is the computer's steady one, and so is ours: from sending
to the first sample in motion is one difference.
"""

from __future__ import annotations

import asyncio
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

from harness import machine as processor
from trochia.client import AsyncClient
from trochia.messages.command import Enable, JogBy, Load, Run

VIEWERS = 8
SECONDS = 10.0
MOST = 0.06  #: of a core, for eight viewers
TRIES = 20
RUN = 30.0  #: of the real-time run, unless the command line says how long [s]

Server = tuple["subprocess.Popen[str]", str, str]


def start(folder: Path) -> Server:
    trochia = Path(sys.executable).with_name("trochia")
    process = subprocess.Popen(
        [trochia, "serve", "-m", "reference-mill", "--tcp", "0", "--users", folder / "users.json", "--journal",
         folder / "journal"], stdout=subprocess.PIPE, text=True, env=os.environ | {"PYTHONUNBUFFERED": "1"},
    )  # fmt: skip
    assert process.stdout is not None
    told = "".join(process.stdout.readline() for _ in range(3))
    found = re.search(r"password (\S+)[^@]*?(http://[\d.:]+)", told)
    assert found is not None, told
    return process, found[2], found[1]


def threads(process: subprocess.Popen[str]) -> tuple[float, float]:
    """Return the processor time of the serving thread, and of all others together [s]."""
    main = others = 0.0
    for task in Path(f"/proc/{process.pid}/task").iterdir():
        used = int((task / "schedstat").read_text().split()[0]) * 1e-9
        if int(task.name) == process.pid:
            main = used
        else:
            others += used
    return main, others


async def cost(
    process: subprocess.Popen[str], clients: list[AsyncClient], seconds: float
) -> tuple[float, float, float]:
    """Return shares of a core of the serving thread and of the others, and statuses a second and client."""
    begin, before = time.monotonic(), threads(process)
    first = [client.received for client in clients]
    await asyncio.sleep(seconds)
    took, after = time.monotonic() - begin, threads(process)
    rate = sum(client.received - count for client, count in zip(clients, first, strict=True))
    return (after[0] - before[0]) / took, (after[1] - before[1]) / took, rate / took / max(len(clients), 1)


def newest(client: AsyncClient) -> float:
    """Return the time of the newest sample that has arrived [s]."""
    return float(client.frames[-1].columns["time"][-1]) if client.frames else 0.0


async def latency(client: AsyncClient) -> list[float]:
    """Return the times from sending a command to the first sample of the machine in motion [s]."""
    await client.watch(samples=True)
    found: list[float] = []
    for i in range(TRIES):
        await asyncio.sleep(0.013 * i % 0.05)
        client.frames.clear()
        begin = time.monotonic()
        await client.command(JogBy(way={"X": 1.0 if i % 2 == 0 else -1.0}))
        end = await client.wait_for_new(lambda status: status.state == "idle", timeout=30.0)
        await client.wait_until(lambda _, t=end.time: newest(client) >= t, timeout=30.0)
        rows = [(t, v) for f in client.frames for t, v in zip(f.columns["time"], f.columns["values"], strict=True)]
        names = client.frames[-1].head.about["names"]
        column = names.index("X.velocity")
        found.append(next(float(t) for t, v in rows if t > begin and v[column] != 0.0) - begin)
    await client.watch(samples=False)
    return found


def program() -> str:
    """Return some minutes of short arcs and lines."""
    body = "".join(f"G2 X{i % 2 * 20} Y0 I{i % 2 * 20 - 10} J0\nG1 Y5\nY0\n" for i in range(1, 1000))
    return f"G21 G90 G17 G64 P0.01\nF1800\nG1 X0 Y0\n{body}M2\n"


async def main(seconds: float) -> None:
    with tempfile.TemporaryDirectory() as name:
        process, url, password = start(Path(name))
        try:
            async with await AsyncClient.connect(url, "operator", password) as operator:
                alone = await cost(process, [operator], SECONDS)
                viewers = [await AsyncClient.connect(url, "operator", password) for _ in range(VIEWERS - 1)]
                all_ = await cost(process, [operator, *viewers], SECONDS)
                await operator.take()
                await operator.command(Enable())
                waits = await latency(operator)
                await operator.command(Load(name="arcs", text=program()))
                await operator.command(Run())
                await operator.wait_until("running", timeout=30.0)
                running = await cost(process, [operator, *viewers], seconds)
                status = operator.status
                for viewer in viewers:
                    await viewer.close()
        finally:
            process.terminate()
            process.communicate(timeout=60)
    print(f"{processor()}; load average {os.getloadavg()[0]:.1f}\n")
    print("| | serving [% of a core] | controller and log [%] | statuses a second and viewer |\n|---|--:|--:|--:|")
    for what, (serving, others, rate) in (("1 viewer, at rest", alone), (f"{VIEWERS} viewers, at rest", all_),
                                          (f"{VIEWERS} viewers, a program running", running)):  # fmt: skip
        met = "" if "8" not in what else " met" if serving < MOST else " MISSED"
        print(f"| {what} | {100 * serving:.1f}{met} | {100 * others:.1f} | {rate:.1f} |")
    ms = [1000.0 * wait for wait in waits]
    print(f"\ncommand to motion: median {median(ms):.1f} ms, greatest {max(ms):.1f} ms of {len(ms)}")
    assert status is not None
    alarms = "; ".join(f"{alarm.message} (line {alarm.line})" for alarm in status.alarms) or "none"
    print(f"after {seconds:.0f} s of the program: {status.state}, alarms: {alarms}")


if __name__ == "__main__":
    asyncio.run(main(float(sys.argv[1]) if len(sys.argv) > 1 else RUN))
