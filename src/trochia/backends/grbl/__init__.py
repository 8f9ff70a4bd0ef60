"""GRBL 1.1 boards: they take plain G-code and plan by themselves."""

from trochia.backends.grbl.backend import GrblBackend
from trochia.backends.grbl.port import BAUD, Port, SerialPort

__all__ = ["BAUD", "GrblBackend", "Port", "SerialPort"]
