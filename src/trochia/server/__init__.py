"""HTTP and WebSocket on top of the controller: who may come in, who may move, and what everybody sees.

In: requests from anywhere.  Out: commands to one runtime, its status to whoever looks, a log of who asked for what.
``desk.py`` is what all connections share, ``app.py`` the application, ``listen.py`` puts it on the network.
"""
