"""`trochia run --backend grbl`: a program on a board that plans for itself.

In: what the command line names.  Out: the job, converted to what the board has, run to its end or given up.
"""

from __future__ import annotations

import sys
import time
from dataclasses import replace
from typing import TYPE_CHECKING

import click

from trochia import api
from trochia.backends.program import Doing, Order
from trochia.cli import options
from trochia.cli.job import judge
from trochia.cli.tables import show_verdict
from trochia.languages.gcode.write import lines
from trochia.program import AXES

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from trochia.backends.program import BoardReport
    from trochia.cli.job import Job
    from trochia.languages.gcode import Reading
    from trochia.languages.gcode.write import Line
    from trochia.machine.machine import Machine

LOOK = 0.01  #: between polls [s]


def run(
    program: str, machine_name: str, place: Mapping[str, float], profile: str | None, *, reading: Reading, port: str,
    baud: int, yes: bool, as_json: bool,
) -> None:  # fmt: skip
    """Connect, read the settings, check the program against machine file and board, run it; exits with the code.

    Without ``place`` the program's zero is the board's own work zero.
    """
    board = _Board(port, baud, quiet=as_json)
    try:
        board.connect()
        board.compare(api.load(machine_name))
        board.unlock(yes=yes)
        place = place or board.report.origin
        job = judge(program, machine_name, place, profile, reading=reading)
        if job.verdict.plan is None or not job.verdict.ok:
            _refuse(job, as_json=as_json)
        began = board.clock()
        board.run(_lines(job, place, board.report, reading), yes=yes)
        _tell(board.report, board.clock() - began, as_json=as_json)
    finally:
        board.close()
    sys.exit(1 if board.report.faults else 0)


def _lines(job: Job, place: Mapping[str, float], report: BoardReport, reading: Reading) -> list[Line]:
    """Return the program for a board that stands where it stands, in the board's work coordinates."""
    start = {axis: report.position.get(axis, 0.0) for axis in AXES}
    from trochia.languages import gcode  # noqa: PLC0415 - beside the others it would hide the package's name

    reading = replace(reading, dialect=reading.dialect or gcode.DIALECTS[job.machine.dialect])
    read = gcode.read(job.text, name=job.name, work=reading.work.placed(**place), start=tuple(start.values()),
                      reading=reading)  # fmt: skip
    beam = job.machine.beam
    shutter = beam.full_power if beam is not None and beam.kind == "shutter" else None
    origin = [report.origin.get(axis, 0.0) for axis in AXES]
    return list(lines(read, origin=origin, beam=beam is not None, shutter=shutter))


class _Board:
    """A person at the board."""

    def __init__(self, port: str, baud: int, *, quiet: bool) -> None:
        from trochia.backends.grbl import GrblBackend, SerialPort  # noqa: PLC0415 - only what moves needs a backend

        self._backend = GrblBackend(lambda: SerialPort(port, baud), baud=baud)
        self._quiet = quiet
        self.clock = time.monotonic
        self.report = self._backend.open(self.clock())

    def close(self) -> None:
        self._backend.close()

    def connect(self) -> None:
        """Wait until it has told its settings, where it stands and where its work zero lies."""
        self._wait(lambda report: report.doing is not Doing.CONNECTING and bool(report.position and report.origin))
        self._stop_at_faults()

    def compare(self, machine: Machine) -> None:
        """Say in what the machine file promises more than the board does."""
        from trochia.backends.grbl.settings import differences  # noqa: PLC0415

        for difference in differences(machine, self._backend.settings):
            click.echo(f"warning: {difference}", err=True)

    def unlock(self, *, yes: bool) -> None:
        """Home a locked board, or unlock one that cannot home."""
        if self.report.doing is not Doing.ALARM:
            return
        homes = self._backend.settings.get("$22") == "1"
        if not yes:
            click.confirm("the board is locked; home it" if homes else "the board is locked; unlock it", abort=True,
                          err=True)  # fmt: skip
        self._backend.order(Order.HOME if homes else Order.UNLOCK, self.clock())
        self._wait(lambda report: bool(report.faults) or (report.done and report.doing is Doing.IDLE))
        self._stop_at_faults()

    def run(self, made: list[Line], *, yes: bool) -> None:
        """Send lines and follow them to their end."""
        if not yes:
            click.confirm("run?", abort=True, err=True)
        self._backend.send(made)
        while True:
            try:
                self._wait(self._at_stop)
            except KeyboardInterrupt:
                held = self.report.doing is Doing.HOLD
                self._backend.order(Order.ABORT if held else Order.HOLD, self.clock())
                continue
            if self.report.doing is not Doing.HOLD:
                break
            go_on = yes or click.confirm("\nheld; go on?", default=True, err=True)
            self._backend.order(Order.RESUME if go_on else Order.ABORT, self.clock())
            self._pass(0.3)
        if not self._quiet and sys.stderr.isatty():
            click.echo(err=True)

    def _at_stop(self, report: BoardReport) -> bool:
        self._show(report)
        gone = report.doing in {Doing.LOST, Doing.ALARM, Doing.SLEEP}
        return gone or report.done or (report.doing is Doing.HOLD and not report.faults)

    def _wait(self, until: Callable[[BoardReport], bool]) -> None:
        self._pass(LOOK)
        while not until(self.report) and self.report.doing is not Doing.LOST:
            self._pass(LOOK)

    def _pass(self, seconds: float) -> None:
        end = self.clock() + seconds
        while self.clock() < end:
            time.sleep(LOOK / 2)
            self.report = self._backend.poll(self.clock())

    def _stop_at_faults(self) -> None:
        """End with what is wrong, if anything is."""
        serious = [fault for fault in self.report.faults if not fault.warning]
        if serious:
            raise click.ClickException(f"{serious[0].message}\n  {serious[0].remedy}")

    def _show(self, report: BoardReport) -> None:
        if self._quiet or not sys.stderr.isatty():
            return
        where = " ".join(f"{axis}{value:9.3f}" for axis, value in report.position.items())
        click.echo(f"\r{report.doing.value:9s} {where}  {60 * report.feed:7.0f} mm/min  line {report.line:6d}   ",
                   err=True, nl=False)  # fmt: skip


def _refuse(job: Job, *, as_json: bool) -> None:
    if as_json:
        options.print_json(job.verdict.figures())
    else:
        show_verdict(job.verdict)
    sys.exit(1)


def _tell(report: BoardReport, took: float, *, as_json: bool) -> None:
    if as_json:
        options.print_json({"ok": not report.faults, "state": report.doing.value, "line": report.line,
                            "time_s": took, "alarms": [fault.message for fault in report.faults]})  # fmt: skip
        return
    faults = "".join(f"\n{fault.message}\n  {fault.remedy}" for fault in report.faults)
    click.echo(f"{report.doing.value} after {took:.1f} s, executed to line {report.line}{faults}")
