"""Who may come in.  In: a file of names, roles and salted scrypt keys.  Out: the user of name and password, or none.

The file is written whole, and is its owner's alone; no password is kept.
"""

from __future__ import annotations

import hashlib
import hmac
import secrets
from typing import TYPE_CHECKING

import msgspec

from trochia.errors import ConfigError
from trochia.files import write_whole
from trochia.messages.session import Name, Role  # noqa: TC001 - msgspec reads the types at run time

if TYPE_CHECKING:
    from pathlib import Path

FORMAT_VERSION = 1
COST = 1 << 15  #: rounds of scrypt: some 0.1 s and 32 MB a try
BLOCK = 8
_MEMORY = 128 << 20  #: that scrypt may take at most [bytes]
SHORTEST = 8  #: password


class User(msgspec.Struct, frozen=True, kw_only=True):
    """One who may come in: what is needed to recognise the password, and not the password."""

    name: Name
    role: Role
    salt: bytes
    key: bytes
    cost: int = COST


class _File(msgspec.Struct, frozen=True, kw_only=True):
    format: int
    users: tuple[User, ...]


class Users:
    """The users file, read anew whenever it is asked, so that a change acts at once.

    Parameters
    ----------
    path
        Made at the first change where it is missing.
    cost
        Rounds of scrypt for passwords that are set from now on.
    """

    def __init__(self, path: Path, *, cost: int = COST) -> None:
        self.path = path
        self._cost = cost
        self._nobody = _user("nobody", "viewer", secrets.token_hex(), cost)

    def all(self) -> tuple[User, ...]:
        """Return every user; none where there is no file.

        Raises
        ------
        ConfigError
            When the file is not what it should be, or others than its owner may read it.
        """
        try:
            if self.path.stat().st_mode & 0o077:
                raise ConfigError(f"{self.path} may be read by others than its owner",
                                  hint=f"chmod 600 {self.path}; then give its users new passwords.")  # fmt: skip
            found = msgspec.json.decode(self.path.read_bytes(), type=_File)
        except FileNotFoundError:
            return ()
        except msgspec.DecodeError as error:
            raise ConfigError(
                f"{self.path} is no users file: {error}", hint="Put it aside; a new one is made."
            ) from None
        if found.format > FORMAT_VERSION:
            raise ConfigError(f"{self.path}: format {found.format}, this version reads {FORMAT_VERSION}")
        return found.users

    def verify(self, name: str, password: str) -> User | None:
        """Return the user of a name and a password; it takes as long for a name that is not there."""
        known = {user.name: user for user in self.all()}
        user = known.get(name, self._nobody)
        right = hmac.compare_digest(_key(password, user.salt, user.cost), user.key)
        return user if right and name in known else None

    def put(self, name: str, role: Role, password: str) -> None:
        """Add a user, or give one another role and password.

        Raises
        ------
        ConfigError
            For a name or a password that cannot be.
        """
        if len(password) < SHORTEST:
            raise ConfigError(f"a password has at least {SHORTEST} characters")
        try:
            user = msgspec.convert(msgspec.to_builtins(_user(name, role, password, self._cost)), User)
        except msgspec.ValidationError:
            raise ConfigError(f"a user's name has letters, digits, and _ . @ -, not {name!r}") from None
        self._write([*(other for other in self.all() if other.name != name), user])

    def remove(self, name: str) -> bool:
        """Take a user out, and return whether there was one."""
        users = self.all()
        rest = [user for user in users if user.name != name]
        if len(rest) < len(users):
            self._write(rest)
        return len(rest) < len(users)

    def first(self) -> str | None:
        """Make an operator where there are no users, and return the password; None where there are some."""
        if self.all():
            return None
        password = new_password()
        self.put("operator", "operator", password)
        return password

    def _write(self, users: list[User]) -> None:
        self.path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        data = msgspec.json.encode(_File(format=FORMAT_VERSION, users=tuple(users)))
        write_whole(self.path, msgspec.json.format(data, indent=2) + b"\n", mode=0o600)


def new_password() -> str:
    """Return a random password, easy to type: 16 letters and digits, some 80 bits."""
    letters = "abcdefghijkmnpqrstuvwxyz23456789"
    return "-".join("".join(secrets.choice(letters) for _ in range(4)) for _ in range(4))


def _user(name: str, role: Role, password: str, cost: int) -> User:
    salt = secrets.token_bytes(16)
    return User(name=name, role=role, salt=salt, key=_key(password, salt, cost), cost=cost)


def _key(password: str, salt: bytes, cost: int) -> bytes:
    return hashlib.scrypt(password.encode("utf-8", "surrogatepass"), salt=salt, n=cost, r=BLOCK, p=1, maxmem=_MEMORY)
