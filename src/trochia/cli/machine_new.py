"""``trochia machine new``: a machine file from a few questions, or from none with ``--defaults``."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from trochia.cli import machine_show
from trochia.cli.machine_file import apply_changes, force, settings, write_machine
from trochia.errors import ConfigError, MachineError
from trochia.machine import draft
from trochia.machine.axes import Axis, AxisKind
from trochia.machine.dump import dumps
from trochia.machine.io import BEAMS, Beam, Spindle
from trochia.machine.joints import MOTORS, Encoder, Joint, Servo
from trochia.machine.kinematics import KINEMATICS
from trochia.machine.schema import Record, Variant, keys_of
from trochia.machine.transmissions import TRANSMISSIONS

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.machine.machine import Machine
    from trochia.machine.schema import Key

_NONE = "none"


@click.command()
@click.argument("file", metavar="[FILE]", required=False, type=click.Path(dir_okay=False, path_type=Path))
@click.option("--name", help="Name of the machine; that of FILE if not given.")
@click.option("--kinematics", type=click.Choice(tuple(KINEMATICS)), help="How joints move axes.")
@click.option("--axes", metavar="LETTERS", help="Its axes, like XYZ.")
@click.option(
    "--travel", "travels", multiple=True, metavar="X=LOW..HIGH", help="Travel, like X='0..300 mm'; an axis each."
)
@click.option("--velocity", metavar="QUANTITY", help="Greatest velocity of all linear axes, like '100 mm/s'.")
@click.option("--acceleration", metavar="QUANTITY", help="Greatest acceleration of all linear axes, like '500 mm/s2'.")
@settings
@click.option("--defaults", is_flag=True, help="Ask nothing: take a usual value for what is not given.")
@force
def command(
    file: Path | None,
    name: str | None,
    defaults: bool,
    force: bool,
    changes: tuple[str, ...],
    **given: Any,  # noqa: ANN401 - the options that preset answers, by name
) -> None:
    """Make a machine file: a wizard that asks with sensible answers ready, each checked as it is given.

    Example: trochia machine new mill.toml
    """
    if not defaults:
        click.echo("Enter takes the answer in brackets.  Nothing is written before the last question; Ctrl-C stops.\n")
    name = name or (file.stem if file else None) or ("machine" if defaults else click.prompt("Name", default="machine"))
    file = file or Path(f"{name}.toml")
    if file.exists() and not force:
        raise ConfigError(f"{file} exists already", hint="Write over it with --force, or choose another name.")
    document = _begin(str(name), given, ask=not defaults)
    for travel in given["travels"]:
        _put_travel(document, travel)
    if not defaults:
        _ask_all(document, given)
    apply_changes(document, changes)
    machine = _finish(document, str(file), ask=not defaults)
    write_machine(file, _heading(machine) + dumps(machine, comments=True), force=force)
    click.echo(f"\n{machine_show.as_text(machine)}\n\nWritten: {file}.  Use it: trochia check PROGRAM -m {file}")


def _heading(machine: Machine) -> str:
    """Return the comment at the head of a new file."""
    return f"# {machine.name}.  Each key is explained where it stands first; after a change: trochia machine check\n"


def _begin(name: str, given: dict[str, Any], *, ask: bool) -> draft.Document:
    """Return the draft of these axes and kinematics, with what the command line says of all axes."""
    kinematics = given["kinematics"] or "cartesian"
    if given["kinematics"] is None and ask:
        kinematics = click.prompt("Kinematics", default=kinematics, type=click.Choice(tuple(KINEMATICS)))
    usual = "XZ" if kinematics == "lathe" else "XYZ"
    if given["axes"] is None and ask:
        letters = _until_right("Axes", usual, draft.letters_of)
    else:
        letters = draft.letters_of(given["axes"] or usual)
    document = draft.draft(name, kinematics, letters)
    for letter, axis in document["axes"].items():
        for key in ("velocity", "acceleration"):
            if given[key] and letter not in "ABC":
                axis[key] = given[key]
    return document


def _put_travel(document: draft.Document, travel: str) -> None:
    """Apply ``--travel X=0..300 mm``; a unit at the end serves both."""
    letter, _, span = travel.partition("=")
    low, dots, high = (part.strip() for part in span.partition(".."))
    if letter not in document["axes"] or not dots:
        raise click.BadParameter(
            f"expected an axis and its travel, like X='0..300 mm', not {travel!r}", param_hint="--travel"
        )
    unit = high.lstrip("+-0123456789.eE ")
    document["axes"][letter] |= {"minimum": low if low.endswith(unit) else f"{low} {unit}", "maximum": high}


def _ask_all(document: draft.Document, given: dict[str, Any]) -> None:
    """Ask for every axis, joint and tool."""
    travelled = {travel.partition("=")[0] for travel in given["travels"]}
    for letter, axis in document["axes"].items():
        click.echo(f"\nAxis {letter}")
        _ask_axis(letter, axis, skip={key for key in ("velocity", "acceleration") if given[key] and letter not in "ABC"}
                  | ({"minimum", "maximum"} if letter in travelled else set()))  # fmt: skip
    for name, joint in document["joints"].items():
        click.echo(f"\nMotor of {name}")
        _ask_joint(joint, rotary=name in tuple("ABC"))
    click.echo("\nTool")
    _ask_tool(document)


def _ask_joint(joint: dict[str, Any], *, rotary: bool) -> None:
    """Ask for motor, transmission, encoder of a servo, backlash."""
    wanted = AxisKind.ROTARY if rotary else AxisKind.LINEAR
    fitting = {kind: cls for kind, cls in TRANSMISSIONS.items() if cls.moves in {None, wanted}}
    joint["motor"] = _ask_variant("Motor", MOTORS, joint["motor"], rotary=rotary, skip=("model",))
    joint["transmission"] = _ask_variant("Transmission", fitting, joint["transmission"], rotary=rotary)
    if joint["motor"]["kind"] == Servo.kind:
        joint["encoder"] = {"counts": _ask("Encoder counts a turn", keys_of(Encoder)["counts"], "4096")}
    joint["backlash"] = _ask("Backlash", keys_of(Joint)["backlash"], "0 deg" if rotary else "0 mm", rotary=rotary)


def _ask_axis(letter: str, axis: dict[str, Any], skip: set[str]) -> None:
    """Ask for travel and limits of one axis."""
    rotary = letter in "ABC"
    keys = keys_of(Axis)
    labels = {"minimum": "Travel from", "maximum": "Travel to", "velocity": "Velocity", "acceleration": "Acceleration"}

    def above_minimum(value: Any) -> None:  # noqa: ANN401 - what the codec read
        low = keys["minimum"].codec.read(axis["minimum"], rotary=rotary)  # type: ignore[union-attr]
        if not value > low:
            raise ConfigError(f"expected more than {axis['minimum']}")

    for name, label in labels.items():
        if name not in skip:
            also = above_minimum if name == "maximum" else None
            axis[name] = _ask(label, keys[name], axis[name], rotary=rotary, also=also)
    jerk = _ask("Jerk (none: not limited)", keys["jerk"], _NONE, rotary=rotary)
    if jerk != _NONE:
        axis["jerk"] = jerk


def _ask_tool(document: draft.Document) -> None:
    """Ask for spindle and beam."""
    spindle = keys_of(Spindle)
    maximum = _ask("Spindle, greatest speed (none: no spindle)", spindle["maximum"], _NONE)
    if maximum != _NONE:
        spin_up = _ask("Spindle, time to full speed", spindle["spin_up"], "2 s")
        document["spindle"] = {"maximum": maximum, "spin_up": spin_up}
    kind = click.prompt("Beam", default=_NONE, type=click.Choice((_NONE, *BEAMS)))
    if kind != _NONE:
        document["beam"] = {"kind": kind}
        if kind == "power":
            document["beam"]["full_power"] = _ask("Beam, the S of full power", keys_of(Beam)["full_power"], "1000")


def _ask_variant(
    label: str, registry: dict[str, Any], usual: dict[str, Any], *, rotary: bool, skip: tuple[str, ...] = ()
) -> dict[str, Any]:
    """Ask which kind, then for its keys."""
    kind = click.prompt(label, default=usual["kind"] if usual["kind"] in registry else next(iter(registry)),
                        type=click.Choice(tuple(registry)))  # fmt: skip
    cls = registry[kind]
    defaults = {field.name: field.default for field in fields(cls)}
    answers: dict[str, Any] = {"kind": kind}
    for name, entry in keys_of(cls).items():
        if name in skip or defaults[name] is None or isinstance(entry.codec, Record | Variant):
            continue
        ready = usual.get(name) if usual["kind"] == kind else None
        if ready is None:
            ready = defaults[name] if isinstance(defaults[name], int) else None
        if ready is None:
            ready = "1" if name == "ratio" else entry.codec.example(rotary=rotary).strip('"')
        answers[name] = _ask(f"  {name}: {entry.doc}", entry, str(ready), rotary=rotary)
    return answers


def _ask(
    label: str, entry: Key, default: str, *, rotary: bool = False, also: Callable[[Any], None] | None = None
) -> Any:  # noqa: ANN401 - a TOML value
    """Return an answer that the key's codec reads and its bound holds, or ``none`` where that is the ready answer."""
    assert not isinstance(entry.codec, Record | Variant)
    codec = entry.codec

    def read(text: str) -> Any:  # noqa: ANN401 - a TOML value
        if text == default == _NONE:
            return text
        answer = draft.value_of(text)
        value: Any = codec.read(answer, rotary=rotary)
        if isinstance(value, int | float) and not entry.bound.holds(value):
            raise ConfigError(f"expected a value {entry.bound.value}, not {text}")
        if also:
            also(value)
        return answer

    return _until_right(label, default, read)


def _until_right(label: str, default: str, read: Callable[[str], Any]) -> Any:  # noqa: ANN401 - whatever read returns
    """Ask until ``read`` takes the answer; say what is wrong in between."""
    while True:
        text = str(click.prompt(label, default=default)).strip()
        try:
            return read(text)
        except MachineError as error:
            click.echo(f"  {error.plain}", err=True)


def _finish(document: draft.Document, file: str, *, ask: bool) -> Machine:
    """Return the machine; where answers do not fit together, ask for the one to change, or raise."""
    while True:
        machine, problems = draft.machine_of(document, file)
        if machine is not None:
            return machine
        error = problems[0]
        if not ask:
            raise ConfigError(error.plain, key=error.key, hint=error.hint)
        click.echo(f"\nThese answers do not fit together:\n  {error.message}\n  {error.hint or ''}".rstrip(), err=True)
        key = click.prompt("Key to change", default=error.key or "")
        try:
            draft.put(document, key, click.prompt(key))
        except MachineError as refused:
            click.echo(f"  {refused.message}", err=True)
