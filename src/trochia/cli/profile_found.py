"""What ``trochia profile`` found: a profile, its verdict, what it asks of the motor, and what the twin did.

In: what the options want.  Out: :class:`Found`, one a case.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import click

from trochia.errors import LimitError

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.analysis.stepper_move import MoveUse
    from trochia.analysis.stepper_proof import Proof
    from trochia.cli.motor_options import Asked
    from trochia.cli.profile_asked import Wanted
    from trochia.pulses.ramps import Profile, Verdict

PROVED = 20.0  #: a move up to it is played on the twin without being asked [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """A profile; with a motor what it uses of it, what the twin did, and a move that it makes, where this one is not.

    Attributes
    ----------
    remedy
        What would do; None where nothing is wrong, or nothing was found.
    cured
        What the verdict's own remedy asks of the motor.
    """

    profile: Profile
    verdict: Verdict
    use: MoveUse | None = None
    proof: Proof | None = None
    remedy: Profile | None = None
    cured: MoveUse | None = None

    @property
    def ok(self) -> bool:
        """Whether it meets what is required, and the motor makes it: by the twin where it was asked."""
        if self.use is not None and not self.use.starts:
            return False
        makes = self.use is None or (self.use.ok if self.proof is None else self.use.ok and self.proof.ok)
        return self.verdict.ok and makes


def find(asked: Wanted, progress: Callable[[str, float], None]) -> list[Found]:
    """Return every case, in order.

    Raises
    ------
    click.UsageError
        For a twin without a motor, or a move too long for it.
    TrochiaError
        For what cannot be, with the number that would do.
    """
    from trochia.pulses.ramps import Requirement, profile, verdict  # noqa: PLC0415 - `trochia --help` must stay light

    if asked.prove and asked.motor is None:
        raise click.UsageError("The twin needs a motor: give --motor or -m.")
    wants = asked.requirement
    if asked.speed is not None:
        wants = replace(wants or Requirement(), speed=asked.speed)
    found: list[Found] = []
    made_all: list[Profile] = []
    for demand, law, name in asked.cases:
        made = profile(demand, law, time_box=asked.time_box)
        made_all.append(replace(made, title=f"{made.title}, {name}") if name else made)
    for made in (*made_all, *asked.measured):
        judged = verdict(made, wants)
        if asked.motor is None:
            found.append(Found(profile=made, verdict=judged))
        else:
            found.append(_with_motor(made, judged, asked.motor, asked, progress))
    return found


def _with_motor(
    made: Profile, judged: Verdict, motor: Asked, asked: Wanted, progress: Callable[[str, float], None]
) -> Found:
    """Return a profile judged by its motor too."""
    from trochia.analysis.stepper_move import easier, move_use  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.analysis.stepper_proof import LONGEST, prove_move  # noqa: PLC0415

    def proved(one: Profile) -> Proof:
        return prove_move(one, motor.made, motor.load, progress)

    use = move_use(made, motor.shaft)
    prove = made.duration <= PROVED if asked.prove is None else asked.prove
    if prove and made.duration > LONGEST:
        raise click.UsageError(f"The twin plays moves of up to {LONGEST:g} s, this one lasts {made.duration:.4g} s.")
    proof = proved(made) if prove else None
    remedy = None
    if not use.ok or (proof is not None and not proof.ok):
        try:
            remedy = easier(
                made,
                motor.shaft,
                (lambda one: proved(one).ok) if prove else None,
                slower=proof is not None and use.ok and proof.steady(made),
            )
        except LimitError:
            remedy = None
    cured = None if judged.cure is None else move_use(judged.cure, motor.shaft)
    return Found(profile=made, verdict=judged, use=use, proof=proof, remedy=remedy, cured=cured)
