"""An encoder edge by edge: what it counts, what it misses, what noise its speed has, against closed forms."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from trochia.errors import ConfigError, LimitError
from trochia.kernels.servo import ServoKernel, ServoSamples
from trochia.machine.edges import Edges
from trochia.machine.encoder_speed import crossover, difference_noise, period_noise
from trochia.machine.servo_plant import ServoPlant
from trochia.servo import Loop, Pid, ServoAxis
from trochia.servo.axis import plant_members

PERIOD = 1e-3
COUNTS = 1000.0
FREE = ServoPlant(torque_constant=1.0, motor_inertia=1.0, counts=COUNTS)


def at_speed(edges: Edges | None, speed: float, ticks: int, counts: float = COUNTS) -> tuple[ServoSamples, ServoAxis]:
    """Return the samples at a steady speed, reached in 50 ms, of a body without friction."""
    axis = ServoAxis(replace(FREE, edges=edges, counts=counts), Loop(period=PERIOD))
    push = np.zeros(50 + ticks)
    push[:50] = speed / 0.05
    samples = axis.run(np.zeros((len(push), 3)), injected=push)
    return ServoSamples.of(np.stack([getattr(samples, name)[60:] for name in ServoSamples.__slots__], axis=1)), axis


def test_faultless_edges_count_as_whole_counts_do() -> None:
    one, _ = at_speed(None, 7.3, 500)
    two, axis = at_speed(Edges(clock=1e6), 7.3, 500)
    np.testing.assert_array_equal(one.measured, two.measured)
    assert axis.encoder.told == axis.encoder.passed
    assert axis.encoder.missed == 0


@pytest.mark.parametrize("speed", [9.0, -9.0])
def test_n_missed_edges_are_a_drift_of_n_counts(speed: float) -> None:
    samples, axis = at_speed(Edges(missed=0.02, seed=7), speed, 2000)
    count = axis.encoder
    assert count.missed > 0
    assert count.told - count.passed == -math.copysign(count.missed, speed)
    off = samples.measured * COUNTS - np.floor(samples.motor * COUNTS)
    assert off[-1] == -math.copysign(1.0, speed) * count.missed
    expected = 0.02 * abs(count.passed)
    assert abs(count.missed - expected) < 4.0 * math.sqrt(expected * 0.98)


def test_what_is_drawn_follows_from_the_seed() -> None:
    one, two, other = (at_speed(Edges(missed=0.02, jitter=0.1, seed=s), 9.0, 500)[0].measured for s in (3, 3, 4))
    np.testing.assert_array_equal(one, two)
    assert (one != other).any()


@pytest.mark.parametrize("jitter", [0.0, 0.1, 0.2])
def test_jitter_s_noise_of_speed_by_counts(jitter: float) -> None:
    """q / T √(1/6 + 2 s²): two places, each off by an even spread of a count and by jitter."""
    edges = Edges(jitter=jitter, seed=5)
    axis = ServoAxis(replace(FREE, edges=edges), Loop(period=PERIOD))
    # never the same way a tick, so that the phase of the counts is spread evenly
    rng = np.random.default_rng(1)
    push = np.concatenate([np.full(50, 200.0), rng.normal(0.0, 100.0, 20000)])
    samples = axis.run(np.zeros((len(push), 3)), injected=push)
    true = np.diff(samples.motor) / PERIOD
    noise = (samples.speed[1:] - true)[60:]
    assert noise.std() == pytest.approx(edges.counted_noise(COUNTS, PERIOD), rel=0.03)
    assert Edges().counted_noise(COUNTS, PERIOD) == pytest.approx(difference_noise(COUNTS, PERIOD))


# an even speed has two lengths of period only, whose variance is f (1 - f) for f parts of a tick: 1/6 at this f
FRACTION = 0.5 * (1.0 - 1.0 / math.sqrt(3.0))


@pytest.mark.parametrize(("jitter", "ticks"), [(0.0, 66 + FRACTION), (0.1, 1e6), (0.1, 10 + FRACTION)])
def test_the_noise_of_speed_by_time(jitter: float, ticks: float) -> None:
    """v √(2 s² + (v c / f)² / 6), where edges come more slowly than the loop asks."""
    speed = 0.3 * (1.0 + 1e-3 * math.sqrt(2.0))
    clock = ticks * speed * COUNTS
    edges = Edges(jitter=jitter, clock=clock, seed=11)
    samples, _ = at_speed(edges, speed, 60000)
    changes = samples.speed[1:][np.diff(samples.speed) != 0.0]
    kept = changes[np.abs(changes - speed) < 0.9 * speed]
    assert len(kept) > 8000
    assert kept.std() == pytest.approx(edges.timed_noise(speed, COUNTS), rel=0.06)
    assert Edges(clock=clock).timed_noise(speed, COUNTS) == pytest.approx(period_noise(speed, COUNTS, clock))


def test_speed_by_time_is_better_below_the_crossover_and_sinks_while_no_edge_comes() -> None:
    clock = 1e5
    slow = 0.1 * crossover(COUNTS, PERIOD, clock)
    by_time, _ = at_speed(Edges(clock=clock), slow, 4000)
    by_counts, _ = at_speed(None, slow, 4000)
    assert by_time.speed.std() < 0.2 * by_counts.speed.std()
    # stopped: what is told sinks as one count over the time since the last
    axis = ServoAxis(replace(FREE, edges=Edges(clock=1e6)), Loop(period=PERIOD))
    push = np.zeros(600)
    push[:50], push[100:150] = 20.0, -20.0
    speed = axis.run(np.zeros((600, 3)), injected=push).speed
    assert speed[99] == pytest.approx(1.0, rel=0.01)
    assert 0.0 < speed[-1] < 2.5 / (COUNTS * 0.45)


def test_one_channel_counts_every_edge_the_way_it_is_driven() -> None:
    """A push back against the drive is counted forwards: twice as far off as it went back."""
    plant = replace(FREE, edges=Edges(single=True), load=0.5)
    axis = ServoAxis(plant, Loop(period=PERIOD))
    push = np.concatenate([np.full(300, 1.0), np.full(1500, 0.1)])  # the load turns it round
    samples = axis.run(np.zeros((1800, 3)), injected=push)
    turn = int(np.argmax(samples.motor))
    back = math.floor(samples.motor[turn] * COUNTS) - math.floor(samples.motor[-1] * COUNTS)
    assert back > 100
    assert axis.encoder.told - axis.encoder.passed == pytest.approx(2 * back, abs=2)


def test_index_pulses_tell_the_counts_lost_since_the_first() -> None:
    axis = ServoAxis(replace(FREE, edges=Edges(missed=0.05, turn=100, seed=2)), Loop(period=PERIOD))
    axis.run(np.zeros((50, 3)), injected=np.full(50, 10.0))  # to half a count a tick
    missed, seen = [], 0
    for _ in range(2500):
        axis.run(np.zeros((1, 3)))
        if axis.encoder.pulses > seen:
            seen = axis.encoder.pulses
            missed.append(axis.encoder.missed)
            assert axis.encoder.off == missed[0] - missed[-1]
    assert len(missed) == axis.encoder.passed // 100 > 10
    assert missed[-1] > missed[0]


def test_standing_on_an_edge_makes_no_counts() -> None:
    plant = ServoPlant(torque_constant=1.0, motor_inertia=1.0, counts=COUNTS, edges=Edges(jitter=0.2))
    axis = ServoAxis(plant, Loop(period=PERIOD))
    t = PERIOD * np.arange(4000)
    push = 0.01 * np.cos(40.0 * t)  # swings by 6 µrad: far less than a count
    measured = axis.run(np.zeros((4000, 3)), injected=push).measured
    assert np.ptp(measured) * COUNTS <= 1.0


def test_a_loop_that_runs_away_is_named_and_comes_to_an_end() -> None:
    plant = replace(FREE, edges=Edges(jitter=0.1, missed=0.01))
    with pytest.raises(LimitError, match="run away"):
        ServoAxis(plant, Loop(period=PERIOD, position=Pid(kp=-1e7))).run(np.full((5000, 3), 1.0))


def test_any_cut_into_blocks_counts_the_same() -> None:
    edges = Edges(jitter=0.1, missed=0.01, clock=1e5, turn=100)
    push = np.random.default_rng(3).normal(0.0, 50.0, 900)
    members = plant_members(replace(FREE, edges=edges), 1e-5)
    loop = Loop(period=PERIOD).members(1e-5)
    whole = ServoKernel(members, loop, seed=9).run(np.zeros((900, 3)), injected=push)
    kernel = ServoKernel(members, loop, seed=9)
    parts = [kernel.run(np.zeros((len(part), 3)), injected=part) for part in np.split(push, [1, 7, 300])]
    for name in ("measured", "speed"):
        np.testing.assert_array_equal(getattr(whole, name), np.concatenate([getattr(part, name) for part in parts]))


@pytest.mark.parametrize(
    ("faults", "what"),
    [({"jitter": 0.3}, "jitter"), ({"missed": 1.0}, "missed"), ({"clock": 0.0}, "clock"), ({"seed": -1}, "seed")],
)
def test_faults_that_cannot_be_are_named(faults: dict[str, float], what: str) -> None:
    with pytest.raises(ConfigError) as raised:
        Edges(**faults)  # type: ignore[arg-type]
    assert raised.value.key == what
    with pytest.raises(ConfigError, match="no edges"):
        ServoPlant(motor_inertia=1.0, edges=Edges(clock=1e6))
