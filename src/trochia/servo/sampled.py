"""The linear part of plant and loop, sampled: frequency responses and the poles of the closed loop.

In: a ServoPlant and a Loop.  Out: exact responses at the servo's ticks (the command is held over a tick, Franklin,
Powell and Workman, *Digital Control*), with no friction that is dry, no gap and no limits.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from trochia.machine.servo_plant import Mode

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.servo_plant import ServoPlant
    from trochia.servo.axis import Loop
    from trochia.servo.pid import Pid

    Array = NDArray[np.float64]
    Response = NDArray[np.complex128]


class StateSpace(NamedTuple):
    """dx/dt = a x + b u, or x of the next tick = a x + b u;  y = c x."""

    a: Array
    b: Array
    c: Array


def state_space(plant: ServoPlant) -> StateSpace:
    """Return position (of what the encoder reads) by command.

    States are motor, load, their speeds, current, and the sum of an amplifier's own speed loop.
    """
    a, b = np.zeros((6, 6)), np.zeros((6, 1))
    a[0, 2] = a[1, 3] = 1.0
    b1, b2 = plant.motor_friction.viscous, plant.load_friction.viscous
    if plant.stiffness is None:
        inertia = plant.motor_inertia + plant.load_inertia
        a[2, 2] = a[3, 3] = -(b1 + b2) / inertia
        a[2, 4] = a[3, 4] = plant.torque_constant / inertia
    else:
        k, d, j1, j2 = plant.stiffness, plant.damping, plant.motor_inertia, plant.load_inertia
        a[2] = np.array([-k, k, -d - b1, d, plant.torque_constant, 0.0]) / j1
        a[3] = np.array([k, -k, d, -d - b2, 0.0, 0.0]) / j2
    amplifier, mode = plant.amplifier, plant.amplifier.mode
    tau = plant.inductance / plant.resistance if mode is Mode.VOLTAGE else amplifier.lag
    over, back = _of_current(plant)
    if mode is Mode.SPEED:
        a[5, 2], b[5] = -amplifier.speed_integral, amplifier.speed_integral * amplifier.gain
    summed = float(mode is Mode.SPEED)
    if tau > 0.0:
        a[4, 2], a[4, 4], a[4, 5], b[4] = -back / tau, -1.0 / tau, summed / tau, amplifier.gain * over / tau
    else:  # the current follows at once
        per = a[:, 4].copy()
        a[:, 2] -= per * back
        a[:, 5] += per * summed
        b[:, 0] += per * amplifier.gain * over
    c = np.zeros((1, len(a)))
    c[0, int(plant.on_load)] = 1.0
    # of one body the load's states repeat the motor's; without lag or sum theirs are none
    bodies = [0, 2] if plant.stiffness is None else [0, 1, 2, 3]
    keep = [*bodies, *([4] if tau > 0.0 else []), *([5] if summed else [])]
    if plant.stiffness is None:
        c[0, 0], c[0, 1] = 1.0, 0.0
    return StateSpace(a[np.ix_(keep, keep)], b[keep], c[:, keep])


def _of_current(plant: ServoPlant) -> tuple[float, float]:
    """Return the current by a unit of what the amplifier is told, and by a unit of speed against it."""
    match plant.amplifier.mode:
        case Mode.VOLTAGE:
            return 1.0 / plant.resistance, plant.emf_constant / plant.resistance
        case Mode.SPEED:
            return plant.amplifier.speed_gain, plant.amplifier.speed_gain
        case Mode.CURRENT:
            return 1.0, 0.0


def held(system: StateSpace, period: float) -> StateSpace:
    """Return the system from tick to tick, its input held over each."""
    from scipy.linalg import expm  # noqa: PLC0415 - scipy is slow to import

    a, b, c = system
    n = len(a)
    whole = np.zeros((n + 1, n + 1))
    whole[:n, :n], whole[:n, n:] = a, b
    grown = np.asarray(expm(whole * period), np.float64)
    return StateSpace(grown[:n, :n], grown[:n, n:], c)


def response(system: StateSpace, z: Response) -> Response:
    """Return c (z - a)⁻¹ b at points z (points,) of either plane."""
    n = len(system.a)
    inner = z[:, None, None] * np.eye(n) - system.a
    x = np.linalg.solve(inner, np.broadcast_to(system.b.astype(np.complex128), (len(z), n, 1)))
    return np.asarray((system.c @ x)[:, 0, 0], np.complex128)


def on_circle(frequency: Array, period: float) -> Response:
    """Return z = exp(j w T) for frequencies [Hz]."""
    return np.exp(2j * np.pi * np.asarray(frequency) * period)


def pid_response(pid: Pid, z: Response, period: float) -> Response:
    """Return output by measurement, its sign turned."""
    m, back = pid.members(period), 1.0 / z
    integral = (m["i_now"] + m["i_before"] * back) / (1.0 - back) if pid.ki else 0.0
    derivative = m["d_gain"] * (1.0 - back) / (1.0 - m["d_keep"] * back)
    return np.asarray(m["p"] + integral + derivative, np.complex128)


def controller_response(loop: Loop, frequency: Array) -> Response:
    """Return command by measured position, its sign turned: all loops together, as the plant meets them."""
    z = on_circle(frequency, loop.period)
    total = np.zeros(len(z), np.complex128)
    if loop.position is not None:
        total = pid_response(loop.position, z, loop.period)
    if loop.speed is not None:
        measured = (1.0 - z**-loop.averaged) / (loop.period * loop.averaged)
        total = pid_response(loop.speed, z, loop.period) * (total + measured)
    for biquad in loop.filters:
        total = total * biquad.response(frequency, loop.period)
    return total


def plant_response(plant: ServoPlant, frequency: Array, period: float) -> Response:
    """Return measured position by command at frequencies [Hz], the command held over each tick."""
    return response(held(state_space(plant), period), on_circle(frequency, period))


def open_loop(plant: ServoPlant, loop: Loop, frequency: Array) -> Response:
    """Return L, the loop cut at the plant's input."""
    return controller_response(loop, frequency) * plant_response(plant, frequency, loop.period)


def closed_poles(plant: ServoPlant, loop: Loop) -> Response:
    """Return the poles of the closed loop in z: stable when all lie inside the unit circle."""
    t, one = loop.period, np.array([1.0])

    def pid(given: Pid) -> Section:
        m = given.members(t)
        total = section(np.array([m["p"]]), one)
        if given.ki:
            total = beside(total, section(np.array([m["i_now"], m["i_before"]]), np.array([1.0, -1.0])))
        if given.kd:
            total = beside(total, section(m["d_gain"] * np.array([1.0, -1.0]), np.array([1.0, -m["d_keep"]])))
        return total

    total = section(np.zeros(1), one) if loop.position is None else pid(loop.position)
    if loop.speed is not None:
        difference = np.zeros(loop.averaged + 1)
        difference[0], difference[-1] = 1.0, -1.0
        total = behind(pid(loop.speed), beside(total, section(difference / (t * loop.averaged), one)))
    for f in loop.filters:
        total = behind(section(np.array([f.b0, f.b1, f.b2]), np.array([1.0, f.a1, f.a2])), total)
    body = held(state_space(plant), t)
    whole = behind(Section(body.a, body.b, body.c, 0.0), total)
    return np.asarray(np.linalg.eigvals(whole.a - whole.b @ whole.c), np.complex128)


class Section(NamedTuple):
    """x of the next tick = a x + b u, y = c x + d u, of one input and one output."""

    a: Array
    b: Array
    c: Array
    d: float


def section(numerator: Array, denominator: Array) -> Section:
    """Return numerator / denominator, polynomials in 1/z of which the denominator begins with 1."""
    n = max(len(numerator), len(denominator))
    over, under = (np.pad(np.asarray(p, np.float64), (0, n - len(p))) for p in (numerator, denominator))
    a = np.eye(n - 1, k=-1)
    a[:1] = -under[1:]
    return Section(a, np.eye(n - 1, 1), (over[1:] - over[0] * under[1:])[None, :], float(over[0]))


def beside(one: Section, two: Section) -> Section:
    """Return the sum of two sections."""
    a = np.zeros((len(one.a) + len(two.a),) * 2)
    a[: len(one.a), : len(one.a)], a[len(one.a) :, len(one.a) :] = one.a, two.a
    return Section(a, np.vstack([one.b, two.b]), np.hstack([one.c, two.c]), one.d + two.d)


def behind(last: Section, first: Section) -> Section:
    """Return the section that takes what another gives."""
    n = len(first.a)
    a = np.zeros((n + len(last.a),) * 2)
    a[:n, :n], a[n:, n:], a[n:, :n] = first.a, last.a, last.b @ first.c
    return Section(a, np.vstack([first.b, last.b * first.d]), np.hstack([last.d * first.c, last.c]), last.d * first.d)
