"""Measured data: channels, recordings, and the one file format they have."""

from trochia.recorder.channel import FORMAT_VERSION, Channel, Header
from trochia.recorder.recording import Recording

__all__ = ["FORMAT_VERSION", "Channel", "Header", "Recording"]
