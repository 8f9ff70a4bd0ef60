"""``trochia machine``: make, look at, check and import machine files."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from trochia.cli import machine_calibrate, machine_channels, machine_new, machine_show
from trochia.cli.machine_file import apply_changes, force, output, problem_data, settings, write_machine
from trochia.cli.options import as_json, print_json
from trochia.errors import ConfigError
from trochia.machine.draft import machine_of
from trochia.machine.dump import dumps
from trochia.machine.importers import IMPORTERS, NO_PLACE, Imported, detect
from trochia.machine.load import inspect, load, read_text, shipped

if TYPE_CHECKING:
    from trochia.machine.machine import Machine


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
def command() -> None:
    """Make, look at, check and import machine files.

    Example: trochia machine show xy-table
    """


@command.command()
@click.argument("name", metavar="[MACHINE]", required=False)
@as_json
def show(name: str | None, as_json: bool) -> None:
    """Show a machine: axes, limits, joints, what they resolve.  Without a name, list those that come with Trochia.

    Example: trochia machine show router
    """
    if name is None:
        rows = [{"name": entry, "description": load(entry).description} for entry in shipped()]
        print_json({"machines": rows}) if as_json else click.echo(machine_show.listing(rows))
        return
    machine = load(name)
    print_json(machine_show.as_data(machine)) if as_json else click.echo(machine_show.as_text(machine))


@command.command()
@click.argument("names", metavar="MACHINE...", nargs=-1, required=True)
@as_json
def check(names: tuple[str, ...], as_json: bool) -> None:
    """Say whether machine files are right, with every mistake in them.

    Example: trochia machine check mill.toml
    """
    results = [(name, *inspect(name)) for name in names]
    ok = all(machine is not None for _, machine, _ in results)
    if as_json:
        problems = [problem_data(error, name) for name, _, errors in results for error in errors]
        print_json({"ok": ok, "files": list(names), "problems": problems})
    else:
        for name, machine, errors in results:
            for error in errors:
                click.echo(f"error: {error}", err=True)
            if machine is not None:
                click.echo(f"{name}: ok ({machine_show.summary(machine)})")
            else:
                click.echo(f"{name}: {len(errors)} mistake{'s' if len(errors) > 1 else ''}", err=True)
    if not ok:
        sys.exit(2)


@command.command("import")
@click.argument("file", metavar="FILE", type=click.Path(path_type=Path))
@click.option("--from", "kind", type=click.Choice(tuple(IMPORTERS)), help="What FILE is; found out if not given.")
@click.option("--name", help="Name of the machine; the file's own name if not given.")
@output
@force
@settings
@as_json
def import_(  # noqa: PLR0917 - click hands options over by name
    file: Path, kind: str | None, name: str | None, output: Path | None, force: bool, changes: tuple[str, ...],
    as_json: bool,
) -> None:  # fmt: skip
    """Make a machine file from GRBL's $$, a LinuxCNC ini or a Klipper cfg; every setting not taken is reported.

    Example: trochia machine import printer.cfg -o printer.toml
    """
    text = read_text(file)
    importer = IMPORTERS[kind] if kind else detect(text, str(file))
    imported = importer.read(text, str(file))
    machine = _imported_machine(imported, importer.title, file, name, changes)
    toml = _heading(importer.title, file, imported) + dumps(machine, comments=True)
    if output is not None:
        write_machine(output, toml, force=force)
    if as_json:
        print_json({
            "from": importer.kind,
            "output": None if output is None else str(output),
            "toml": toml if output is None else None,
            "assumed": imported.assumed,
            "unmapped": [
                {"key": each.setting.full_name, "value": each.setting.value, "line": each.setting.line, "why": each.why}
                for each in imported.unmapped
            ],
        })  # fmt: skip
        return
    _report(imported, importer.title, file)
    if output is None:
        click.echo(toml, nl=False)
    else:
        click.echo(f"{output}: {machine_show.summary(machine)}", err=True)


def _imported_machine(
    imported: Imported, title: str, file: Path, name: str | None, changes: tuple[str, ...]
) -> Machine:
    """Return the machine of an import with the user's changes, or raise its first mistake."""
    document: dict[str, Any] = {"format": 1, "name": name or file.stem, "description": f"From {title}"}
    document |= imported.document
    apply_changes(document, changes)
    machine, problems = machine_of(document, str(file))
    if machine is None:
        error = problems[0]
        raise ConfigError(error.plain, key=error.key,
                          hint=f"{error.hint or 'The settings do not make a machine.'}\n"
                               f"  Change it with --set {error.key or 'KEY'}=VALUE.")  # fmt: skip
    return machine


def _heading(title: str, file: Path, imported: Imported) -> str:
    """Return the comment at the head of an imported file."""
    lines = [f"# Imported from {title}, {file.name}.  Assumed, because it does not say:"]
    lines += [f"# - {' '.join(sentence.split())}" for sentence in imported.assumed or ["nothing"]]
    return "\n".join(lines) + "\n"


def _report(imported: Imported, title: str, file: Path) -> None:
    """Tell on standard error what was assumed and what was left."""
    click.echo(f"{file}: {title}", err=True)
    for sentence in imported.assumed:
        click.echo(f"  assumed: {sentence}", err=True)
    if imported.unmapped:
        click.echo("  not mapped, as there is no place for them in a machine file (or for the reason given):", err=True)
    for each in imported.unmapped:
        value = f" = {' '.join(each.setting.value.split())[:60]}" if each.setting.value else ""
        why = "" if each.why == NO_PLACE else f" ({each.why})"
        click.echo(f"    line {each.setting.line}: {each.setting.full_name}{value}{why}", err=True)


command.add_command(machine_new.command, "new")
command.add_command(machine_channels.command, "channels")
command.add_command(machine_calibrate.command, "calibrate")
