"""The options that say what a live run records.  In: the command line.  Out: a Take, or None where nothing is asked."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from trochia import units
from trochia.errors import RecordingError, UnitError

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.controller.recording import Take


def _time(_context: click.Context, _parameter: click.Parameter, value: str) -> float:
    """Return a time from a text like ``500 ms`` [s]."""
    try:
        seconds = units.parse(value, "time")
    except UnitError as error:
        raise click.BadParameter(str(error)) from None
    if seconds < 0:
        raise click.BadParameter("a time is zero or more")
    return seconds


def recording_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options, and hand the command ``take``."""

    def with_take(**given: Any) -> None:  # noqa: ANN401 - every option of the command
        command(take=_take(**{name: given.pop(name) for name in _NAMES}), **given)

    with_take.__doc__ = command.__doc__
    with_take.__click_params__ = getattr(command, "__click_params__", [])  # type: ignore[attr-defined]
    wrapped: Callable[..., Any] = with_take
    for option in reversed(_OPTIONS):
        wrapped = option(wrapped)
    return wrapped


_NAMES = ("record", "channels", "triggers", "before", "after", "limit")
_OPTIONS = (
    click.option("--record", type=click.Path(file_okay=False, path_type=Path), metavar="FOLDER",
                 help="Record every servo tick; a recording there is replaced."),
    click.option("--channel", "channels", multiple=True, metavar="NAME",
                 help='Record this one only, "X.*" all of X (again for more; '
                      "`trochia machine channels` lists them)."),
    click.option("--record-on", "triggers", multiple=True, metavar="WHAT",
                 help='Record only around a "hold", an "alarm" or a "line 12" (again for more).'),
    click.option("--before", default="1 s", show_default=True, callback=_time, metavar="TIME",
                 help="How much before what --record-on names."),
    click.option("--after", default="1 s", show_default=True, callback=_time, metavar="TIME",
                 help="How much after it."),
    click.option("--record-limit", "limit", type=click.FloatRange(min=0), default=256.0, show_default=True,
                 metavar="MB", help="What a recording takes at most, its oldest part dropped; 0: no bound."),
)  # fmt: skip


def _take(
    *, record: Path | None, channels: tuple[str, ...], triggers: tuple[str, ...], before: float, after: float,
    limit: float,
) -> Take | None:  # fmt: skip
    if record is None and (channels or triggers):
        raise click.UsageError("--channel and --record-on go with --record FOLDER")
    if record is None:
        return None
    from trochia.controller.recording import Take  # noqa: PLC0415 - `trochia --help` must stay light

    try:
        return Take(path=record, channels=channels, triggers=triggers, before=before, after=after,
                    limit=round(limit * 1e6) if limit else None)  # fmt: skip
    except RecordingError as error:
        raise click.UsageError(str(error)) from None


def tell_recorded(take: Take, failed: str, *, quiet: bool) -> None:
    """Say where the recording is, or why it is not whole."""
    from trochia.recorder import parts_of, read  # noqa: PLC0415

    if failed:
        click.echo(f"warning: the recording ended by itself: {failed}", err=True)
    parts = parts_of(take.path)
    if quiet:
        return
    if not parts:
        click.echo(f"recording {take.path}: nothing has triggered it")
        return
    recorded = read(take.path)
    click.echo(f"recording {take.path}: {len(parts)} part{'s' if len(parts) > 1 else ''}, the last {len(recorded)} "
               f"samples of {len(recorded.channels)} channels from {recorded.start:.3f} s")  # fmt: skip
