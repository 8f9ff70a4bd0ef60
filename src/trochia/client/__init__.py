"""A machine at a distance, from Python.

In: an address, a name, a password.  Out: commands taken or refused, the newest status, a program run to its end.
:class:`Client` blocks, :class:`AsyncClient` is for asyncio; both do the same.  Only the messages are shared with the
server.

    with Client.connect("http://127.0.0.1:8765", "operator", password) as machine:
        machine.take()
        machine.command(Enable())
        machine.run("part.ngc", text)
"""

from trochia.client.asynchronous import AsyncClient, Refused
from trochia.client.blocking import Client

__all__ = ["AsyncClient", "Client", "Refused"]
