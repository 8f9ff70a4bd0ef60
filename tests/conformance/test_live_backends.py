"""What every live backend does with orders: the same motion for the same segments, the same refusals of abuse."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
import pytest

import trochia
from trochia.backends import LIVE_BACKENDS
from trochia.backends.avr.live_avr import LiveAvr
from trochia.backends.avr.transports import ChipTransport
from trochia.backends.avr.wiring import BOARDS
from trochia.backends.compensated import compensated
from trochia.backends.live import Orders, Watch
from trochia.backends.segments import Segments, sampled
from trochia.errors import LocalProtocolError
from trochia.machine.compensation import Compensation, Squareness
from trochia.machine.error_table import ErrorTable
from trochia.machine.io import Channel
from trochia.machine.transmissions import Leadscrew

if TYPE_CHECKING:
    from collections.abc import Iterator

    from trochia.backends.live import Report, SegmentBackend
    from trochia.machine.machine import Machine
    from trochia.planner import Trajectory

STEP = 0.01  #: between polls [s]


@pytest.fixture(params=[*sorted(LIVE_BACKENDS), *BOARDS, "corrected twin", "corrected uno-stepdir"])
def kind(request: pytest.FixtureRequest) -> str:
    return request.param


@pytest.fixture
def machine(kind: str) -> Machine:
    made = trochia.load("reference-mill")
    if kind in BOARDS and BOARDS[kind].coils:  # full steps of two motors
        made = shield_stage()
    made = replace(made, io=(Channel(name="touch", kind="input"), Channel(name="lamp", kind="latched")))
    return erring(made) if kind.startswith("corrected") else made


def erring(machine: Machine) -> Machine:
    """Return a machine whose twin errs, and that corrects it."""
    points: list[tuple[float, float]] = []
    for axis in machine.axes[:1]:
        places = np.linspace(axis.minimum, axis.maximum, 21)
        points = list(zip(places.tolist(), (0.03 * np.sin(places / 30.0)).tolist(), strict=True))
    table = ErrorTable(points=tuple(points))
    first = replace(machine.joints[0], screw_error=table, backlash=0.01,
                    compensation=Compensation(screw=table, backlash=0.01))  # fmt: skip
    return replace(machine, joints=(first, *machine.joints[1:]), squareness=Squareness(XY=0.05),
                   squareness_error=Squareness(XY=0.05))  # fmt: skip


def shield_stage() -> Machine:
    """The motor shield's stage, faster than it is, on a screw of 10 mm."""
    made = trochia.load("shield-stage")
    axes = tuple(replace(axis, velocity=200.0, acceleration=800.0, jerk=20_000.0) for axis in made.axes)
    screw = Leadscrew(lead=Fraction(10))
    return replace(made, axes=axes, joints=tuple(replace(j, transmission=screw, pulse_rate=None) for j in made.joints))


@pytest.fixture
def backend(kind: str, request: pytest.FixtureRequest, machine: Machine) -> Iterator[SegmentBackend]:
    kind, corrected = kind.removeprefix("corrected "), kind.startswith("corrected")
    if kind in BOARDS:  # the real image, on the simulated chip
        program, image = request.getfixturevalue("chip_program"), request.getfixturevalue("board_image")
        board = BOARDS[kind]
        made = LiveAvr(machine, ChipTransport(program, image(f"{board.name}-1000000"), mcu=board.mcu), board=board.name)
    else:
        made = LIVE_BACKENDS[kind](machine)
    if corrected:
        inner, made = made, compensated(made)
        for name in ("inputs", "lag"):
            if hasattr(inner, name):
                setattr(made, name, getattr(inner, name))
    made.open(0.0)
    yield made
    made.close()


@pytest.fixture
def motion(machine: Machine) -> Trajectory:
    text = "G21 G90 G94 F6000\nG1 X20 Y5\nG2 X30 Y15 R12\nG1 X0 Y0 S1 M3\nX5\nM2\n"
    return trochia.plan(trochia.gcode(text, machine), machine).trajectory


def segments(motion: Trajectory, machine: Machine, *, slew: float = 4.0, until: float | None = None) -> Segments:
    end = motion.duration if until is None else until
    times = np.linspace(0.0, end, max(2, round(end / 0.002)))
    return sampled(motion, machine.kinematics.matrix, times, np.full(len(times) - 1, slew))


def run(backend: SegmentBackend, *, until: float, since: float = 0.0) -> list[Report]:
    return [backend.poll(t) for t in np.arange(since + STEP, until + STEP, STEP)]


def test_nothing_moves_on_connection_and_drives_are_off(backend: SegmentBackend, machine: Machine) -> None:
    report = run(backend, until=1.0)[-1]
    assert not report.enabled
    assert report.still
    assert report.beam == 0.0
    np.testing.assert_array_equal(report.commanded, np.zeros(len(machine.joints)))


def test_segments_for_drives_that_are_off_are_refused(
    backend: SegmentBackend, motion: Trajectory, machine: Machine
) -> None:
    with pytest.raises(LocalProtocolError, match="off"):
        backend.order(Orders(segments=segments(motion, machine)), 0.0)
    assert run(backend, until=0.5)[-1].still


def test_the_same_segments_end_at_the_same_place_on_the_way_planned(
    backend: SegmentBackend, motion: Trajectory, machine: Machine
) -> None:
    backend.order(Orders(enable=True), 0.0)
    backend.order(Orders(segments=segments(motion, machine)), 0.0)
    reports = run(backend, until=motion.duration + 0.1)
    for report in reports:
        planned = motion.position(np.array([report.executed]))[0]
        np.testing.assert_allclose(report.commanded, planned, atol=1e-3)
        assert report.actual is None or np.abs(report.actual - report.commanded).max() < 0.02
    assert reports[-1].still
    np.testing.assert_allclose(reports[-1].commanded, motion.position(np.array([motion.duration]))[0], atol=1e-9)


def test_motion_goes_on_over_orders_that_join(backend: SegmentBackend, motion: Trajectory, machine: Machine) -> None:
    backend.order(Orders(enable=True), 0.0)
    whole, at, now = segments(motion, machine), 0.0, 0.0
    for first in range(0, len(whole), 50):
        part = whole.rows(slice(first, first + 50))
        backend.order(Orders(segments=part, at=at), now)
        at += part.span
        while backend.poll(now).queued > 0.06:
            now += STEP
    last = run(backend, since=now, until=now + 0.5)[-1]
    np.testing.assert_allclose(last.commanded, whole.end, atol=1e-9)
    assert last.executed == pytest.approx(motion.duration, abs=1e-6)


def test_a_queue_that_runs_low_stops_by_itself_within_its_slew(
    backend: SegmentBackend, motion: Trajectory, machine: Machine
) -> None:
    backend.order(Orders(enable=True, lit=True), 0.0)
    cut = 0.5 * motion.duration
    backend.order(Orders(segments=segments(motion, machine, until=cut)), 0.0)
    reports = run(backend, until=cut + 1.0)
    assert reports[-1].still
    assert not reports[-1].troubles
    assert reports[-1].executed <= cut + 1e-9
    rates = [report.rate for report in reports]
    lag = getattr(backend, "lag", 0.0)  # a report may be older than its poll by so much
    assert max(np.abs(np.diff([rate for rate in rates if rate > 0.0]))) <= 4.0 * (STEP + lag) + 1e-9
    slowed = [report for report in reports if 0.0 < report.rate < 1.0]
    assert slowed
    assert all(report.beam == 0.0 for report in slowed)


def test_what_is_queued_can_be_replaced(backend: SegmentBackend, motion: Trajectory, machine: Machine) -> None:
    backend.order(Orders(enable=True), 0.0)
    backend.order(Orders(segments=segments(motion, machine)), 0.0)
    executed = run(backend, until=0.2)[-1].executed
    at = executed + max(backend.latency, 0.02)
    position = motion.position(np.array([at]))[0]
    velocity = motion.velocity(np.array([at]))[0]
    brake = 0.1
    coefficients = np.stack([position, velocity, -velocity / (2 * brake), 0 * velocity], axis=-1)
    stop = Segments(duration=np.array([brake]), joints=coefficients[None] , line=np.array([9], np.uint32),
                    power=np.zeros(1, np.float32), slew=np.zeros(1))  # fmt: skip
    backend.order(Orders(segments=stop, at=at), 0.2)
    last = run(backend, since=0.2, until=0.6)[-1]
    assert last.still
    np.testing.assert_allclose(last.commanded, position + velocity * brake / 2, atol=1e-9)


@pytest.mark.parametrize("at", [-0.1, 5.0])
def test_segments_that_do_not_join_on_are_refused_and_change_nothing(
    backend: SegmentBackend, motion: Trajectory, machine: Machine, at: float
) -> None:
    backend.order(Orders(enable=True), 0.0)
    backend.order(Orders(segments=segments(motion, machine)), 0.0)
    before = run(backend, until=0.1)[-1]
    with pytest.raises(LocalProtocolError):
        backend.order(Orders(segments=segments(motion, machine), at=at), 0.1)
    with pytest.raises(LocalProtocolError, match="jump"):
        backend.order(Orders(segments=segments(motion, machine), at=before.executed + 0.3), 0.1)
    last = run(backend, since=0.1, until=motion.duration + 0.2)[-1]
    np.testing.assert_allclose(last.commanded, motion.position(np.array([motion.duration]))[0], atol=1e-9)


def test_a_stop_is_at_once_and_dark(backend: SegmentBackend, motion: Trajectory, machine: Machine) -> None:
    backend.order(Orders(enable=True, lit=True), 0.0)
    backend.order(Orders(segments=segments(motion, machine)), 0.0)
    lit = run(backend, until=0.85 * motion.duration)[-1]
    assert lit.beam == 1.0
    backend.order(Orders(stop=True), lit.time)
    after = backend.poll(lit.time + machine.servo_period + backend.latency)
    assert after.beam == 0.0
    assert after.still
    assert run(backend, since=after.time, until=after.time + 0.3)[-1].executed == after.executed


def test_a_watched_input_brakes_and_catches_the_place(
    backend: SegmentBackend, motion: Trajectory, machine: Machine
) -> None:
    backend.order(Orders(enable=True, watch=(Watch(name="touch", level=True),)), 0.0)
    backend.order(Orders(segments=segments(motion, machine)), 0.0)
    at = run(backend, until=0.2)[-1]
    assert at.caught is None
    backend.inputs["touch"] = True  # type: ignore[attr-defined]
    reports = run(backend, since=0.2, until=0.8)
    assert reports[0].caught is not None
    name, where = reports[0].caught
    assert name == "touch"
    speed = np.linalg.norm(at.velocity)
    assert np.linalg.norm(where - at.commanded) <= speed * 2 * STEP
    assert reports[-1].still
    assert np.linalg.norm(reports[-1].commanded - where) > 0.01  # it braked, it did not freeze
    assert reports[-1].executed < motion.duration


def test_positions_are_named_at_rest_only(backend: SegmentBackend, motion: Trajectory, machine: Machine) -> None:
    backend.order(Orders(enable=True, place={"X": 7.5}), 0.0)
    assert backend.poll(STEP).commanded[0] == 7.5
    backend.order(Orders(place={"X": 0.0}), STEP)
    backend.order(Orders(segments=segments(motion, machine)), STEP)
    run(backend, since=STEP, until=0.2)
    with pytest.raises(LocalProtocolError, match="at rest"):
        backend.order(Orders(place={"X": 1.0}), 0.2)


def test_outputs_are_set_at_once_or_at_their_time(
    backend: SegmentBackend, motion: Trajectory, machine: Machine
) -> None:
    backend.order(Orders(enable=True, outputs={"lamp": 1.0}), 0.0)
    assert backend.poll(STEP).outputs["lamp"] == 1.0
    backend.order(Orders(segments=segments(motion, machine), timed=((0.3, "lamp", 0.0),)), STEP)
    for report in run(backend, since=STEP, until=0.5):
        assert report.outputs["lamp"] == (1.0 if report.executed < 0.3 - 1e-9 else 0.0)
    with pytest.raises(LocalProtocolError, match="lamp"):
        backend.order(Orders(outputs={"horn": 1.0}), 0.5)


def test_drives_off_ends_all_motion(backend: SegmentBackend, motion: Trajectory, machine: Machine) -> None:
    backend.order(Orders(enable=True), 0.0)
    backend.order(Orders(segments=segments(motion, machine)), 0.0)
    run(backend, until=0.2)
    backend.order(Orders(enable=False), 0.2)
    last = run(backend, since=0.2, until=0.4)[-1]
    assert last.still
    assert not last.enabled
