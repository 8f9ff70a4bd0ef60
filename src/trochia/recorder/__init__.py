"""Measured data: channels, recordings, and the one file format they have."""

from trochia.recorder.channel import FORMAT_VERSION, Channel, Header
from trochia.recorder.compare import Comparison, compare
from trochia.recorder.export import to_csv, to_npz
from trochia.recorder.figures import Figures, figures
from trochia.recorder.gather import gather
from trochia.recorder.reader import read
from trochia.recorder.recording import Recording
from trochia.recorder.ring import RingWriter, parts_of
from trochia.recorder.writer import RecordingWriter, save, write

__all__ = [
    "FORMAT_VERSION",
    "Channel",
    "Comparison",
    "Figures",
    "Header",
    "Recording",
    "RecordingWriter",
    "RingWriter",
    "compare",
    "figures",
    "gather",
    "parts_of",
    "read",
    "save",
    "to_csv",
    "to_npz",
    "write",
]
