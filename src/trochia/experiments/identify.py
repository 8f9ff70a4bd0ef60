"""From an axis nobody knows to its model: pulses, a soft loop, friction, frequency response, gap.

In: an axis and its bounds.  Out: :class:`Identified`.  The motor is off between the parts and at the end.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from trochia.analysis.identification.backlash import gap_by_reversal, with_gap
from trochia.analysis.identification.one_mass import one_mass
from trochia.analysis.identification.two_mass import plant_of, two_mass
from trochia.errors import RecordingError
from trochia.experiments.motion import feel, out_and_back, soft_loop, steady_speeds
from trochia.experiments.response import Excitation, by_multisine, through_train
from trochia.experiments.reversal import reversals
from trochia.machine.friction import Friction
from trochia.machine.servo_plant import Amplifier, ServoPlant

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.analysis.identification.estimate import Estimate
    from trochia.analysis.identification.response import FrequencyResponse
    from trochia.experiments.protocol import AxisUnderTest, Bounds
    from trochia.servo.axis import Loop

_FRICTION_SPEEDS = (1.0, 0.65, 0.35, 0.15)  # of the greatest
_CRUISE = 0.2468  # of the greatest: counts that beat with the sampling look like distortion
_FIRST = 2e-3  # first pulse, of the greatest command
_HELD = 0.3  # of all friction: what surely holds the load back


@dataclass(frozen=True, slots=True, kw_only=True)
class Identified:
    """What was found.

    Attributes
    ----------
    friction, train, gap, body
        Estimates; ``train`` and ``gap`` are None for one stiff mass, ``body`` for two.
    response
        Position by torque.
    plant
        The model, a unit of command giving the axis' own torque.
    loop
        The soft loop it was measured under.
    """

    friction: Estimate
    train: Estimate | None
    gap: Estimate | None
    response: FrequencyResponse
    plant: ServoPlant
    loop: Loop
    body: Estimate | None = None

    @property
    def estimates(self) -> tuple[Estimate, ...]:
        """All that there are."""
        return tuple(e for e in (self.friction, self.body, self.train, self.gap) if e is not None)


def identify(
    axis: AxisUnderTest, bounds: Bounds, *, speed: float, reach: float, band: tuple[float, float] = (1.0, 400.0),
    progress: Callable[[str], None] = lambda _: None,
) -> Identified:  # fmt: skip
    """Return the model of an axis.

    Parameters
    ----------
    speed
        Greatest to be used; the response is measured at a quarter of it.
    reach
        Way for the first pulses; friction is then measured over up to two and a half seconds of each speed.
    band
        Of the first excitation [Hz].
    progress
        Called with what is being done.

    Raises
    ------
    LimitError
        When the bounds would be left, or are.
    RecordingError
        When what was measured gives no model.
    """
    progress("pulses")
    pulse = feel(axis, bounds, reach=reach, first=_FIRST * min(bounds.command, 1e3))
    loop = soft_loop(pulse.inertia, axis, bounds)
    progress("inertia")
    moved = out_and_back(axis, loop, bounds, 0.5 * speed if axis.position < 0.5 * (bounds.low + bounds.high)
                         else -0.5 * speed, 2.0)  # fmt: skip
    loop = soft_loop(moved["inertia"], axis, bounds)
    progress("friction")
    friction = steady_speeds(axis, loop, bounds, [part * speed for part in _FRICTION_SPEEDS])
    progress("frequency response")
    level, cruise = friction["coulomb"], _CRUISE * speed
    response = by_multisine(axis, loop, bounds, Excitation(max(level, 0.1 * pulse.torque), band, cruise))
    try:
        train = two_mass(response, viscous=friction["viscous"])
    except RecordingError:
        body = one_mass(response, inertia=moved["inertia"], viscous=max(friction["viscous"], 0.0))
        return Identified(friction=friction, train=None, gap=None, body=body, response=response, loop=loop,
                          plant=_one_mass(axis, body, friction))  # fmt: skip
    progress("frequency response, around its notch and peak")
    excitation = through_train(axis, train, _HELD * (level + 0.5 * friction["viscous"] * cruise), cruise)
    response = by_multisine(axis, loop, bounds, excitation)
    train = two_mass(response, viscous=friction["viscous"])
    train.numbers["viscous"] = friction.numbers["viscous"]  # with its uncertainty: the response only divides it
    progress("reversals")
    plant = _two_masses(axis, train, friction)
    seen = reversals(axis, loop, bounds, speed=speed / 60.0, way=speed / 60.0)
    gap = gap_by_reversal(
        plant, loop, seen.wanted, seen.measured, first=seen.first, coulomb=level, greatest=speed / 240.0
    )
    plant = with_gap(plant, gap["gap"], gap["coulomb"], gap["coulomb_share"], plant.motor_friction.smooth)
    return Identified(friction=friction, train=train, gap=gap, response=response, plant=plant, loop=loop)


def _one_mass(axis: AxisUnderTest, body: Estimate, friction: Estimate) -> ServoPlant:
    dry = Friction(coulomb=max(friction["coulomb"], 0.0), viscous=max(friction["viscous"], 0.0),
                   offset=friction["offset"])  # fmt: skip
    return ServoPlant(amplifier=Amplifier(lag=body["lag"]), torque_constant=axis.torque, counts=axis.counts,
                      motor_inertia=body["motor_inertia"], motor_friction=dry)  # fmt: skip


def _two_masses(axis: AxisUnderTest, train: Estimate, friction: Estimate) -> ServoPlant:
    model = plant_of([train[name] for name in ("motor_inertia", "load_inertia", "stiffness", "damping", "load_share")],
                     friction["viscous"])  # fmt: skip
    return ServoPlant(
        amplifier=Amplifier(lag=train["lag"]), torque_constant=axis.torque, motor_inertia=model.motor_inertia,
        load_inertia=model.load_inertia, stiffness=model.stiffness, damping=model.damping, counts=axis.counts,
        motor_friction=Friction(viscous=model.motor_friction.viscous, offset=friction["offset"]),
        load_friction=model.load_friction,
    )  # fmt: skip
