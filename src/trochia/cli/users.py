"""`trochia users`: who may log in to a served machine."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import click

from trochia.cli.serve import settings_folder, users_option

if TYPE_CHECKING:
    from pathlib import Path

    from trochia.server.users import Users


def _users(path: Path | None) -> Users:
    from trochia.server.users import Users  # noqa: PLC0415 - `trochia --help` must stay light

    return Users(path or settings_folder() / "users.json")


@click.group()
def command() -> None:
    """Add, list, remove those who may log in to `trochia serve`.

    Example: trochia users add ada --viewer
    """


@command.command("add")
@click.argument("name")
@click.option("--viewer", is_flag=True, help="May watch, and press STOP.")
@click.option(
    "--password-stdin", is_flag=True, help="Read the password from standard input; else one is made and shown."
)
@users_option
def add(*, name: str, viewer: bool, password_stdin: bool, users_file: Path | None) -> None:
    """Add a user, or give one a new password and role."""
    from trochia.server.users import new_password  # noqa: PLC0415

    password = sys.stdin.readline().rstrip("\n") if password_stdin else new_password()
    _users(users_file).put(name, "viewer" if viewer else "operator", password)
    if not password_stdin:
        click.echo(f"user {name}, password {password}\nshown this once")


@command.command("list")
@users_option
def list_(*, users_file: Path | None) -> None:
    """Print names and roles."""
    for user in _users(users_file).all():
        click.echo(f"{user.name}\t{user.role}")


@command.command("remove")
@click.argument("name")
@users_option
def remove(*, name: str, users_file: Path | None) -> None:
    """Take a user out; who is in is out within a second."""
    if not _users(users_file).remove(name):
        raise click.ClickException(f"there is no user {name!r}")
