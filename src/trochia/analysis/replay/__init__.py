"""Recordings looked at, and held against each other: a run against its plan, a run against another."""

from trochia.analysis.replay.align import Pair, aligned
from trochia.analysis.replay.held import Held, hold_against
from trochia.analysis.replay.look import Look, look
from trochia.analysis.replay.way import way_apart

__all__ = ["Held", "Look", "Pair", "aligned", "hold_against", "look", "way_apart"]
