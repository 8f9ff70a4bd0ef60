"""The interface described: OpenAPI 3.1, its schemas made from the messages themselves.

In: the table of paths below.  Out: one document, which ``/api/openapi.json`` serves and the reference page is made of.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import metadata
from typing import Any

from trochia.messages import components
from trochia.messages.status import SCHEMA_VERSION

JSON, BINARY = "application/json", "application/octet-stream"
REFUSALS = {
    400: "the body or a parameter cannot be read",
    401: "not logged in, or the password is wrong",
    403: "this session may not do that, or the request comes from another site",
    404: "no program is loaded",
    409: "the machine, or whoever has control, refuses; the answer says why and what is legal",
    413: "the body is too long",
    415: "the body is no JSON",
    504: "the controller does not answer",
    429: "too many attempts; the header Retry-After tells the seconds to wait",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Path:
    """One path and method; ``handler`` is a method of :class:`trochia.server.routes.Routes`."""

    path: str
    method: str
    handler: str
    about: str
    takes: str = ""
    gives: str = ""
    refuses: tuple[int, ...] = ()


PATHS = (
    Path(path="/api/login", method="post", handler="login", about="Open a session; the answer sets its cookie.",
         takes="Credentials", gives="SessionStatus", refuses=(400, 401, 413, 415, 429)),
    Path(path="/api/logout", method="post", handler="logout", about="End the session.", refuses=(401,)),
    Path(path="/api/session", method="get", handler="session", about="Who one is to the machine.",
         gives="SessionStatus", refuses=(401,)),
    Path(path="/api/take", method="post", handler="take", about="Become the one who may move the machine.",
         takes="Take", gives="Ack", refuses=(400, 401, 409, 413, 415)),
    Path(path="/api/release", method="post", handler="release", about="Be no longer the one who may.",
         takes="Release", gives="Ack", refuses=(400, 401, 413, 415)),
    Path(path="/api/status", method="get", handler="status", about="The latest status.", gives="Status",
         refuses=(401,)),
    Path(path="/api/command", method="post", handler="command",
         about="Have a command taken.  Jog is refused here: its lease is renewed on a socket.", takes="Command",
         gives="Ack", refuses=(400, 401, 403, 409, 413, 415, 504)),
    Path(path="/api/stop", method="post", handler="stop", about="STOP: for everybody who is logged in.", gives="Ack",
         refuses=(401, 504)),
    Path(path="/api/path", method="get", handler="path",
         about="Path of the loaded program, a binary frame; `points` bounds its size.", gives="Frame",
         refuses=(400, 401, 404)),
    Path(path="/api/openapi.json", method="get", handler="openapi", about="This description."),
)  # fmt: skip
SOCKET = "/api/socket"


def document() -> dict[str, Any]:
    """Return the OpenAPI document."""
    schemas = components("#/components/schemas/{name}")
    kinds = [name for name, schema in schemas.items() if "kind" in schema.get("properties", {})]
    beside = {"Take", "Release", "ShowPath", "Watch", "Seen", "FrameHead"}
    schemas["Command"] = _any_of([kind for kind in kinds if kind not in beside])
    schemas["Message"] = _any_of([kind for kind in kinds if kind != "FrameHead"])
    schemas["Error"] = {"type": "object", "properties": {"error": {"type": "string"}}, "required": ["error"]}
    paths: dict[str, dict[str, Any]] = {}
    for path in PATHS:
        paths.setdefault(path.path, {})[path.method] = _operation(path)
    paths[SOCKET] = {"get": {
        "operationId": "socket", "summary": "The WebSocket: Message in, Told and binary frames out.",
        "responses": {"101": {"description": "a WebSocket"}, "403": {"description": REFUSALS[403]}},
    }}  # fmt: skip
    return {
        "openapi": "3.1.0",
        "info": {"title": "Trochia", "version": f"{metadata.version('trochia')}+schema.{SCHEMA_VERSION}"},
        "paths": paths,
        "components": {"schemas": schemas,
                       "securitySchemes": {"session": {"type": "apiKey", "in": "cookie", "name": "trochia-PORT"}}},
        "security": [{"session": []}],
    }  # fmt: skip


def _any_of(names: list[str]) -> dict[str, Any]:
    return {"anyOf": [{"$ref": f"#/components/schemas/{name}"} for name in sorted(names)],
            "discriminator": {"propertyName": "kind"}}  # fmt: skip


def _content(name: str) -> dict[str, Any]:
    if name == "Frame":
        return {BINARY: {"schema": {"type": "string", "format": "binary"}}}
    return {JSON: {"schema": {"$ref": f"#/components/schemas/{name}"}}}


def _operation(path: Path) -> dict[str, Any]:
    given = {"description": "done", **({"content": _content(path.gives)} if path.gives else {})}
    refusals = {str(code): {"description": REFUSALS[code],
                            "content": _content("Ack" if code in {403, 409} else "Error")}
                for code in path.refuses}  # fmt: skip
    good = "204" if path.handler == "logout" else "200"
    operation: dict[str, Any] = {
        "operationId": path.handler, "summary": path.about, "responses": {good: given, **refusals},
    }  # fmt: skip
    if path.takes:
        operation["requestBody"] = {"required": True, "content": _content(path.takes)}
    if path.handler == "path":
        operation["parameters"] = [{"name": "points", "in": "query", "schema": {"type": "integer", "minimum": 2}}]
    if path.handler in {"login", "openapi"}:
        operation["security"] = []
    return operation
