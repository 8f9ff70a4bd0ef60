"""Face of ``core/host/{link,cubic_steps,timeline}.h``: the firmware's protocol, and the steps that are sent over it.

In: structs of ``core/shared/protocol.h`` as numpy records.  Out: bytes of the line, and the other way round.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from trochia.kernels.layout import dtype_of, ffi, lib, pointer
from trochia.kernels.ticks import SEGMENT, SegmentRun

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

SPAN, BEGIN, CUT = dtype_of("trochia_span"), dtype_of("trochia_begin"), dtype_of("trochia_cut")
PUT, LOOK, HELLO = dtype_of("trochia_put"), dtype_of("trochia_look"), dtype_of("trochia_hello")
ANSWER, ACK = dtype_of("trochia_answer"), dtype_of("trochia_ack")
#: ``first`` beside the fields of a tick segment
PART = np.dtype([("first", "<u4"), *((name, SEGMENT[name]) for name in SEGMENT.names or ())])
PULSE, LIGHT = dtype_of("trochia_pulse_at"), dtype_of("trochia_light_at")
PIXEL = dtype_of("trochia_pixel")
STATUS = dtype_of("trochia_status")
SCHEMA: int = lib.trochia_schema()
SCHEMA_BYTES = 4  #: of an answer, at its beginning in every version
MOTORS, SLICE, FULL_RATE = lib.TROCHIA_MOTORS, lib.TROCHIA_SLICE, lib.TROCHIA_FULL_RATE
PAYLOAD = lib.TROCHIA_PAYLOAD  #: greatest payload of a frame [bytes]
LOOSE = lib.TROCHIA_LOOSE  #: types from here on are not numbered
AT_REST, SET_OUTPUTS = lib.TROCHIA_AT_REST, lib.TROCHIA_SET_OUTPUTS
PIXELS = lib.TROCHIA_PIXEL  #: in a span's flags: times how many pixels there are
SLOT = lib.TROCHIA_SLOT  #: ticks: unit of a pixel's time
_LINE = lib.TROCHIA_FRAMED
_CHUNK = 4096  # steps a call


def members(enum: str) -> dict[str, int]:
    """Return the members of a C enum without their prefix, in lower case."""
    return {name.removeprefix("TROCHIA_").lower(): value for name, value in ffi.typeof(enum).relements.items()}


TYPES = members("enum trochia_frame_type")
STATES = {value: name for name, value in members("enum trochia_state").items()}
RUNNING = lib.TROCHIA_RUNNING
CAUSES = {value: name for name, value in members("enum trochia_cause").items()}


def frame(number: int, kind: int, payload: bytes) -> bytes:
    """Return a frame as it goes over the line.

    Raises
    ------
    ValueError
        For a payload above ``PAYLOAD``.
    """
    line = ffi.new("uint8_t[]", _LINE)
    size = lib.trochia_frame_make(number, kind, payload, len(payload), line)
    if not size:
        raise ValueError(f"a payload has at most {PAYLOAD} bytes, not {len(payload)}")
    return bytes(ffi.buffer(line, size))


class Frame(NamedTuple):
    """One whole frame; ``kind`` is its type, -1 for one that was broken."""

    number: int
    kind: int
    payload: bytes


class FrameReader:
    """Bytes of a line in, frames out; the beginning of a frame is kept from call to call."""

    def __init__(self) -> None:
        self._in = ffi.new("trochia_frame_in *")
        self._taken = ffi.new("int32_t *")
        lib.trochia_frame_start(self._in)

    def feed(self, data: bytes) -> Iterator[Frame]:
        """Return what ends in these bytes."""
        while data:
            event = lib.trochia_frame_feed(self._in, data, len(data), self._taken)
            data = data[self._taken[0] :]
            if event == lib.TROCHIA_NOTHING:
                return
            if event == lib.TROCHIA_WHOLE:
                held = bytes(ffi.buffer(self._in.bytes, self._in.length))
                yield Frame(held[0], held[1], held[2:])
            else:
                yield Frame(0, -1, b"")
            lib.trochia_frame_start(self._in)


def cubic_steps(
    coefficients: NDArray[np.float64], starts: NDArray[np.float64], count: int
) -> tuple[NDArray[np.int64], NDArray[np.int8]]:
    """Return ticks and directions of a joint's steps along cubics (steps,).

    Parameters
    ----------
    coefficients
        By rising powers of ticks since the row's start (rows, 4) [steps].
    starts
        Of the rows, and where the last ends (rows + 1,) [ticks].
    count
        Where the joint stands [steps].
    """
    rows = np.ascontiguousarray(coefficients, np.float64)
    edges = np.ascontiguousarray(starts, np.float64)
    if rows.shape != (edges.size - 1, 4):
        raise ValueError(f"{edges.size - 1} rows of four coefficients, not {rows.shape}")
    state = ffi.new("trochia_cubic_state *", {"count": count})
    ticks: list[NDArray[np.int64]] = [np.empty(0, np.int64)]
    ways: list[NDArray[np.int8]] = [np.empty(0, np.int8)]
    while state.row < len(rows):
        tick, way = np.empty(_CHUNK, np.int64), np.empty(_CHUNK, np.int8)
        made = lib.trochia_cubic_steps(
            pointer(rows, "double *"), pointer(edges, "double *"), len(rows), state, _CHUNK,
            pointer(tick, "int64_t *"), pointer(way, "int8_t *"),
        )  # fmt: skip
        ticks.append(tick[:made])
        ways.append(way[:made])
    return np.concatenate(ticks), np.concatenate(ways)


def fit_one(ticks: NDArray[np.int64], tolerance: float) -> tuple[Any, NDArray[np.int64]]:
    """Return the part that holds as many steps as fit one tick segment after the first, and when it makes them (held,).

    Parameters
    ----------
    ticks
        After the span's start, rising, at least one [ticks].
    tolerance
        Of a step's tick [ticks]; in any case half of the interval beside it.
    """
    part = np.zeros((), PART)
    part["first"], part["stride"] = ticks[0] * 256, 1
    rest = np.ascontiguousarray(ticks[1:], np.int64)
    if not rest.size:
        return part, ticks[:1]
    state = ffi.new("trochia_fit_state *", {"now": int(ticks[0]) * 256})
    made = np.zeros(1, SEGMENT)
    lib.trochia_fit(
        pointer(rest, "const int64_t *"), rest.size, tolerance, state, 1, pointer(made, "trochia_tick_segment *")
    )
    for name in SEGMENT.names or ():
        part[name] = made[name][0]
    at = ticks[0] + np.cumsum(SegmentRun().intervals(made), dtype=np.int64)
    return part, np.concatenate([ticks[:1], at])


class Executed(NamedTuple):
    """What a chip makes of spans.

    Attributes
    ----------
    pulses
        In order (pulses,), of dtype ``PULSE``.
    lights
        Changes of the beam's power (lights,), of dtype ``LIGHT``.
    stream
        Stream time run through [ticks].
    rate
        At which it ended, of ``FULL_RATE``.
    position
        Steps each motor has made (MOTORS,).
    crowded
        Whether it ended because steps of a motor were closer than the grid can take.
    """

    pulses: NDArray[np.void]
    lights: NDArray[np.void]
    stream: int
    rate: int
    position: NDArray[np.int64]
    crowded: bool


def executed(spans: bytes, *, brake: int = -1) -> Executed:
    """Return what a chip makes of spans: at full rate; or, with ``brake``, as one that holds them all.

    Parameters
    ----------
    brake
        The slice from which on it brakes; 0: only where what it holds would no longer do to stop in.

    Raises
    ------
    ValueError
        For bytes that are no spans.
    """
    done, line = ffi.new("trochia_executed *"), ffi.new("trochia_timeline *")
    made, lights = np.empty(0, PULSE), np.empty(0, LIGHT)
    for _ in range(2):  # the first time it is only counted
        line, made, lights = ffi.new("trochia_timeline *"), np.empty(done.made, PULSE), np.empty(done.lit, LIGHT)
        done.pulses, done.lights = pointer(made, "trochia_pulse_at *"), pointer(lights, "trochia_light_at *")
        done.pulse_room, done.light_room = done.made, done.lit
        done.made = done.lit = 0
        if lib.trochia_timeline_run(line, spans, len(spans), brake, done) < 0:
            raise ValueError("these bytes are no spans")
    position = np.array([motor.position for motor in line.motors], np.int64)
    return Executed(made, lights, int(line.stream), int(line.rate), position, bool(line.crowded))


def pulses(spans: bytes) -> NDArray[np.void]:
    """Return the pulses a chip makes of spans at full rate (pulses,), of dtype ``PULSE``.

    Raises
    ------
    ValueError
        For bytes that are no spans.
    """
    return executed(spans).pulses
