"""Trochia speaks GRBL 1.1: any sender that knows GRBL drives the machine through the controller's own rules."""

from trochia.gateways.grbl.doors import TcpDoor, TerminalDoor
from trochia.gateways.grbl.service import Service
from trochia.gateways.grbl.session import Session

__all__ = ["Service", "Session", "TcpDoor", "TerminalDoor"]
