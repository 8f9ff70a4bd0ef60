"""Canned cycles: one line of the program, many moves.

One file a family: :mod:`hole` has what all hole cycles share, :mod:`drill`, :mod:`tap` and :mod:`bore` the cycles
themselves, :mod:`thread` the threading cycle.
"""
