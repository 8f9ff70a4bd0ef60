"""A machine's servo joint as an axis to experiment on: options and bounds that `identify` and `tune` share.

In: the machine's name, the joint's.  Out: :class:`AskedAxis`, its positions in radians of the shaft.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from trochia.cli import options
from trochia.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.experiments import Bounds, TwinAxis
    from trochia.machine.servo_plant import ServoPlant
    from trochia.machine.servos.drive import ServoDrive

machine = click.option(
    "-m", "--machine", "machine_name", metavar="MACHINE", help="Machine file, or the name of one that comes along."
)
joint = click.option("-j", "--joint", metavar="NAME", help="One of the machine's servo joints; its first otherwise.")


@dataclass(frozen=True, slots=True, kw_only=True)
class AskedAxis:
    """A joint of a machine, its drive, what an experiment may do with it, and the greatest speed for one [rad/s]."""

    machine: str
    rotary: bool
    name: str
    drive: ServoDrive
    bounds: Bounds
    speed: float

    @property
    def unit(self) -> str:
        """Of its travel."""
        return "degree" if self.rotary else "mm"

    @property
    def plant(self) -> ServoPlant:
        """Of its file."""
        return self.drive.plant

    def twin(self) -> TwinAxis:
        """Return its twin, in the middle of travel."""
        from trochia.experiments import TwinAxis  # noqa: PLC0415 - `trochia --help` must stay light

        return TwinAxis(self.plant, self.drive.period, position=0.5 * (self.bounds.low + self.bounds.high))


def asked_axis(machine_name: str, joint_name: str | None) -> AskedAxis:
    """Return the joint that the options name.

    Raises
    ------
    ConfigError
        When the machine has no such servo joint, or it does not say all of its motor, amplifier and loop.
    """
    from trochia import api  # noqa: PLC0415 - as above
    from trochia.experiments import Bounds  # noqa: PLC0415
    from trochia.machine.servos.drive import servo_drive  # noqa: PLC0415

    loaded = api.load(machine_name)
    drives = {row.name: servo_drive(loaded, i) for i, row in enumerate(loaded.joints)}
    closed = [name for name, drive in drives.items() if drive is not None]
    name = joint_name if joint_name is not None else next(iter(closed), None)
    drive = drives.get(name) if name is not None else None
    if name is None or drive is None:
        raise ConfigError(
            f"{machine_name} has no servo joint {name or ''}".rstrip() + " whose file names motor, amplifier and loop",
            key="joint", hint=f"There are: {', '.join(closed)}." if closed else "See docs/reference/machine-file.md.",
        )  # fmt: skip
    index = [row.name for row in loaded.joints].index(name)
    row = loaded.kinematics.matrix[index]
    reach = [(c * axis.minimum, c * axis.maximum) for axis, c in zip(loaded.axes, row, strict=True) if c]
    ends = sum(min(pair) for pair in reach), sum(max(pair) for pair in reach)
    velocity = sum(abs(c) * axis.velocity for axis, c in zip(loaded.axes, row, strict=True))
    joint_velocity = loaded.joints[index].velocity
    velocity = min(velocity, joint_velocity or velocity, drive.greatest_velocity)
    scale = drive.per_radian
    bounds = Bounds(low=float(ends[0]) / scale, high=float(ends[1]) / scale, speed=float(velocity) / scale * 1.05,
                    command=drive.amplifier.command, current=drive.plant.amplifier.current * 1.001)  # fmt: skip
    rotary = any(axis.rotary for axis, c in zip(loaded.axes, row, strict=True) if c)
    return AskedAxis(
        machine=machine_name, rotary=rotary, name=name, drive=drive, bounds=bounds, speed=float(velocity) / scale
    )


def plots(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options of pictures and JSON."""
    command = options.as_json(command)
    return click.option(
        "-o", "--plot", type=click.Path(dir_okay=False, writable=True), metavar="FILE.png|FILE.svg|FILE.html",
        help="Draw what was found.",
    )(command)  # fmt: skip


def write_plot(path: str, title: str, draw: Callable[[str], bytes], rows: list[tuple[str, str]]) -> None:
    """Write a picture, or an HTML page of the picture and a table of figures."""
    from pathlib import Path  # noqa: PLC0415 - as above

    from trochia.analysis.tuning.page import page  # noqa: PLC0415
    from trochia.files import write_whole  # noqa: PLC0415

    suffix = Path(path).suffix
    if suffix not in {".png", ".svg", ".html"}:
        raise click.BadParameter(f"expected a name that ends in .png, .svg or .html, not {path}", param_hint="--plot")
    content = page(title, draw("svg").decode(), rows).encode() if suffix == ".html" else draw(suffix[1:])
    write_whole(Path(path), content)
