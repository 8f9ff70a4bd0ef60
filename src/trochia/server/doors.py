"""Which names the server goes by, and so which requests are its own.

In: the Host, Origin and Sec-Fetch-Site of a request.  Out: why it is refused, or nothing.

A page of another site may send requests to this one, with the operator's browser; a name that some stranger's server
made point here (DNS rebinding) would even make them same-origin.  So the name has to be one of ours, and who sends from
a page has to send from ours.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

LOOPBACK = ("127.0.0.1", "localhost", "[::1]")


@dataclass(frozen=True, slots=True, kw_only=True)
class Doors:
    """The names a server goes by.

    Attributes
    ----------
    hosts
        What may stand in a Host header, with the port where it is not the scheme's own.
    origins
        What may stand in an Origin header.
    secure
        Whether it speaks TLS.
    """

    hosts: frozenset[str]
    origins: frozenset[str]
    secure: bool = False

    @classmethod
    def of(cls, port: int, names: Iterable[str] = (), *, secure: bool = False) -> Doors:
        """Return those of a port: loopback's names, and others, each with or without a port of its own."""
        scheme, usual = ("https", 443) if secure else ("http", 80)
        hosts: set[str] = set()
        for name in (*LOOPBACK, *(name.lower() for name in names)):
            own = name if name.rpartition(":")[2].isdigit() and not name.endswith("]") else f"{name}:{port}"
            hosts |= {own, own.removesuffix(f":{usual}")}
        return cls(hosts=frozenset(hosts), origins=frozenset(f"{scheme}://{host}" for host in hosts), secure=secure)

    def refusal(self, headers: Mapping[str, str], *, navigation: bool = False) -> str:
        """Return why a request is not for us; empty: it is.

        Parameters
        ----------
        headers
            By name in small letters.
        navigation
            Whether it only asks for the page itself, to which a link may lead from anywhere.
        """
        host = headers.get("host", "").lower()
        if host not in self.hosts:
            return f"this server does not go by the name {host!r}"
        origin = headers.get("origin")
        if origin is not None and origin.lower() not in self.origins:
            return f"requests from pages of {origin!r} are refused"
        site = headers.get("sec-fetch-site", "none")
        if site not in {"none", "same-origin"} and not (navigation and headers.get("sec-fetch-mode") == "navigate"):
            return "requests from other sites are refused"
        return ""
