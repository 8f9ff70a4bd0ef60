"""`trochia run`: a program on a machine, under the live controller."""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import click

from trochia.cli import options
from trochia.cli.mover import FIRST, OURS, SLOW, board_of, check, clock_of, mover, mover_options
from trochia.cli.record_options import recording_options, tell_recorded

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.cli.run_figures import Figures
    from trochia.cli.run_words import Words
    from trochia.controller.recording import Take
    from trochia.controller.runtime import Runtime
    from trochia.languages.gcode import Reading
    from trochia.messages import AnyCommand, Status

ENDS = ("idle", "alarm", "estop", "off")
LOOK = 0.1  #: between looks at the status [s]


@click.command()
@options.common
@mover_options("twin", "avr", "simavr", "grbl")
@click.option("--virtual", is_flag=True, help="Run by a virtual clock, as fast as the computer can.")
@click.option("-y", "--yes", is_flag=True, help="Home, start and go on at stops without asking.")
@recording_options
@click.option("--journal", type=click.Path(file_okay=False, path_type=Path), metavar="DIR",
              help="Folder of the machine's journal; without it nothing is kept.")  # fmt: skip
def command(
    *, program: str, machine_name: str, place: dict[str, float], profile: str | None, as_json: bool, reading: Reading,
    backend: str, port: str | None, baud: int | None, board: str | None, virtual: bool, yes: bool, journal: Path | None,
    take: Take | None,
) -> None:  # fmt: skip
    """Run a program: checked first, homed if need be, then under the controller, to its end.

    Ctrl-C holds (motion brakes along its path); once more gives the job up.

    Example: trochia run programs/contour.ngc -m xy-table --virtual -y
    """
    check(backend, port, virtual=virtual, kept=journal is not None or take is not None)
    if backend == "grbl" and port is not None:
        from trochia.cli import run_board  # noqa: PLC0415 - only where there is one

        run_board.run(program, machine_name, place, profile, reading=reading, port=port, baud=baud or SLOW, yes=yes,
                      as_json=as_json)  # fmt: skip
    from trochia.cli.job import judge, place_of  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.cli.tables import show_verdict  # noqa: PLC0415

    job = judge(program, machine_name, place, profile, reading=reading, tell=False,
                board_of=None if backend not in OURS else
                lambda machine: board_of(machine, board, baud) or (FIRST, baud or SLOW))  # fmt: skip
    if job.verdict.plan is None or not job.verdict.ok:
        if as_json:
            options.print_json(job.verdict.figures())
        else:
            show_verdict(job.verdict)
        sys.exit(1)
    from trochia.cli.run_figures import Figures  # noqa: PLC0415 - only what moves needs all this
    from trochia.cli.run_words import Words  # noqa: PLC0415
    from trochia.cli.user_codes import attach  # noqa: PLC0415
    from trochia.controller.runtime import Runtime  # noqa: PLC0415
    from trochia.program.logs import logs_of  # noqa: PLC0415

    logs_of(job.verdict.plan.program.actions, place_of(program))  # told before anything moves, if it cannot be
    moves = mover(job.machine, backend, port=port, baud=baud, board=board, virtual=virtual)
    clock = (lambda: 0.0) if virtual else clock_of(backend)
    runtime = Runtime(moves, journal=journal, work=reading.work.placed(**place), reading=reading,
                      now=clock())  # fmt: skip
    end_codes = attach(runtime, job.machine, machine_name, blocking=virtual)
    if take is not None:
        runtime.recorder.start(take, program=job.name)
    figures = None if virtual else Figures(runtime)
    words = Words(runtime)
    session = _Session(runtime, words, virtual=virtual, clock=clock, quiet=as_json, figures=figures)
    try:
        session.go(job.name, job.text.decode("latin-1"), yes=yes)
    finally:
        session.close()
        end_codes()
        words.show()
    logs = words.write_logs(place_of(program))
    if take is not None:
        tell_recorded(take, runtime.recorder.failed, quiet=as_json)
    if reading.on_end is not None:
        reading.on_end(runtime.controller.work)  # what the run left, which only the machine knows
    if as_json:
        _print(session, figures, take, logs)
    else:
        click.echo("".join(f"log      {path}\n" for path in logs), nl=False)
        if figures is not None:
            click.echo(figures.sentence())
    sys.exit(1 if session.status.alarms else 0)


def _print(session: _Session, figures: Figures | None, take: Take | None, logs: list[Path]) -> None:
    """Print what a run came to as one JSON object."""
    status = session.status
    options.print_json({"ok": not status.alarms, "state": status.state, "time_s": session.took,
                        "alarms": [alarm.message for alarm in status.alarms],
                        "host": None if figures is None else figures.told(),
                        "recording": None if take is None else str(take.path),
                        "logs": [str(path) for path in logs]})  # fmt: skip


class _Session:
    """A person at the machine: commands, questions, the line under way."""

    def __init__(
        self, runtime: Runtime, words: Words, *, virtual: bool, clock: Callable[[], float], quiet: bool,
        figures: Figures | None = None,
    ) -> None:  # fmt: skip
        self._words, self._now = words, 0.0
        self._runtime, self._virtual, self._quiet = runtime, virtual, quiet
        self._figures = figures
        self.took = 0.0
        if not virtual:
            runtime.start(clock)

    @property
    def status(self) -> Status:
        return self._runtime.status

    def close(self) -> None:
        self._runtime.close()

    def go(self, name: str, text: str, *, yes: bool) -> None:
        """Switch on, home, load, run, and follow to the end."""
        from trochia.messages import command as c  # noqa: PLC0415

        self._send(c.Enable())
        self._pass(LOOK)
        lost = [axis.name for axis in self.status.axes if not axis.trusted]
        if lost:
            if not yes:
                click.confirm(f"home {' '.join(lost)}?", abort=True, err=True)
            self._send(c.Home())
            self._follow(yes=yes)
            if self.status.state != "idle":
                return
        self._send(c.ArmBeam(on=True))
        self._send(c.Load(name=name, text=text))
        if not yes:
            click.confirm("run?", abort=True, err=True)
        began = self._time()
        if self._figures is not None:
            self._figures.begin()
        self._send(c.Run())
        self._follow(yes=yes)
        self.took = self._time() - began
        if not self._quiet:
            alarms = "".join(f"\n{alarm.message}\n  {alarm.remedy}" for alarm in self.status.alarms)
            click.echo(f"{self.status.state} after {self.took:.1f} s{alarms}")

    def _time(self) -> float:
        return self._now if self._virtual else self.status.time

    def _send(self, command: AnyCommand) -> None:
        """Have a command taken, or end with the reason."""
        answer = (self._runtime.command(command, self._now) if self._virtual
                  else self._runtime.send(command).result(timeout=60.0))  # fmt: skip
        if not answer.ok:
            raise click.ClickException(answer.reason)

    def _pass(self, seconds: float) -> None:
        """Let time pass."""
        from trochia.controller.runtime import PERIOD  # noqa: PLC0415

        if not self._virtual:
            time.sleep(seconds)
            return
        end = self._now + seconds
        while self._now < end - 1e-9:
            self._now += PERIOD
            self._runtime.turn(self._now)

    def _follow(self, *, yes: bool) -> None:
        """Let time pass until the machine is still, showing where it is and asking what it asks."""
        from trochia.messages import command as c  # noqa: PLC0415

        self._pass(LOOK)
        while self.status.state not in ENDS:
            try:
                self._words.show()
                self._show()
                self._pass(LOOK)
                if self.status.state == "held":
                    self._pass(LOOK)
                    self._ask(yes=yes)
            except KeyboardInterrupt:
                held = self.status.state in {"holding", "held"}
                self._send(c.Abort() if held else c.Hold())
        self._show(end="\n")

    def _ask(self, *, yes: bool) -> None:
        from trochia.messages import command as c  # noqa: PLC0415

        status = self.status
        request = status.request
        if status.state != "held" or (request is not None and request.kind == "hook"):
            return  # it goes on by itself
        text = request.text if request is not None else "held; go on"
        if yes or click.confirm(f"\n{text}?", default=True, err=True):
            self._send(c.Resume())
        else:
            self._send(c.Abort())

    def _show(self, end: str = "") -> None:
        if self._quiet or not sys.stderr.isatty():
            return
        status = self.status
        where = " ".join(f"{axis.name}{axis.work:9.3f}" for axis in status.axes)
        program = status.program
        line = f"line {program.line:6d}  {program.remaining_s:7.1f} s left" if program else ""
        click.echo(f"\r{status.state:9s} {where}  {status.speed:7.1f} mm/s  {line}   {end}", err=True, nl=False)
