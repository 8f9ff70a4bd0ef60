"""Axes that nobody knows, drawn by a seed."""

from __future__ import annotations

import math

import numpy as np
import pytest

from trochia.machine.friction import Friction
from trochia.machine.servo_plant import Amplifier, ServoPlant

TURN = 2.0 * math.pi


def drawn(rng: np.random.Generator) -> ServoPlant:
    """Return a two-mass axis: peak 25 to 120 Hz, damping 1 to 6 %, gap 3 to 30 counts, dry and viscous friction."""
    jm = 10 ** rng.uniform(-4.3, -3.3)
    jl = jm * rng.uniform(0.5, 4.0)
    both, inertia = jm * jl / (jm + jl), jm + jl
    k = (TURN * rng.uniform(25.0, 120.0)) ** 2 * both
    d = 2.0 * rng.uniform(0.01, 0.06) * math.sqrt(k * both)
    viscous, dry = inertia / rng.uniform(0.3, 1.5), inertia * rng.uniform(40.0, 120.0)
    share, dry_share = rng.uniform(0.3, 0.7, 2)
    counts = float(rng.choice([10000, 20000, 65536])) / TURN
    return ServoPlant(
        amplifier=Amplifier(current=20.0), torque_constant=inertia * 300.0, motor_inertia=jm, load_inertia=jl,
        stiffness=k, damping=d, gap=rng.uniform(3.0, 30.0) / counts, counts=counts,
        motor_friction=Friction(coulomb=dry * (1.0 - dry_share), viscous=viscous * (1.0 - share)),
        load_friction=Friction(coulomb=dry * dry_share, viscous=viscous * share),
    )  # fmt: skip


@pytest.fixture(scope="session")
def axes() -> list[ServoPlant]:
    """Return ten axes."""
    rng = np.random.default_rng(2026)
    return [drawn(rng) for _ in range(10)]
