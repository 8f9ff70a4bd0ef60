"""HTTP and WebSocket on top of the controller: who may come in, who may move, and what everybody sees.

In: requests from anywhere.  Out: commands to one runtime, its status to whoever looks, a log of who asked for what.
"""

from trochia.server.app import make_app
from trochia.server.desk import Desk
from trochia.server.doors import Doors
from trochia.server.listen import Served, listen
from trochia.server.rest import bring_to_rest
from trochia.server.users import Users

__all__ = ["Desk", "Doors", "Served", "Users", "bring_to_rest", "listen", "make_app"]
