"""Name and password for a session's cookie, over HTTP."""

from __future__ import annotations

import urllib.error
import urllib.request
from http.cookies import SimpleCookie
from urllib.parse import urlsplit

import msgspec

from trochia.errors import LinkError
from trochia.messages import Credentials, encode

PATIENCE = 30.0  #: for the answer [s]


def login(url: str, user: str, password: str) -> str:
    """Log in, and return the cookie to send.

    Raises
    ------
    LinkError
        When it cannot be.
    """
    parts = urlsplit(url)
    if parts.scheme not in {"http", "https"} or not parts.netloc:
        raise LinkError(f"an address looks like http://127.0.0.1:8765, not {url!r}")
    request = urllib.request.Request(  # noqa: S310 - http or https, as just seen
        f"{url}/api/login", encode(Credentials(user=user, password=password)), {"content-type": "application/json"}
    )
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    try:
        with opener.open(request, timeout=PATIENCE) as response:
            jar = SimpleCookie(response.headers.get("set-cookie", ""))
    except urllib.error.HTTPError as error:
        with error:
            raise LinkError(f"no login at {url}: {_reason(error.read())}") from None
    except (OSError, ValueError) as error:
        raise LinkError(f"nobody answers at {url}: {error}") from error
    return "; ".join(f"{morsel.key}={morsel.value}" for morsel in jar.values())


def _reason(body: bytes) -> str:
    try:
        return str(msgspec.json.decode(body)["error"])
    except (msgspec.DecodeError, KeyError, TypeError):
        return "the server refused it"
