"""Motors that arrive together.

In: a target for each.  Out: ramps of one shape, so that all begin and end at the same moments.  The share of the way is
the same for all at every moment: in the space of the motors the move is a straight line.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.errors import LimitError
from trochia.stepper import checks

if TYPE_CHECKING:
    from collections.abc import Sequence

    from trochia.stepper.motor import Stepper


class StepperGroup:
    """Any number of motors on one time, each with its own limits.

    Raises
    ------
    LimitError
        Without motors, or for motors that do not share their time.
    """

    def __init__(self, *motors: Stepper) -> None:
        if not motors or any(motor.time is not motors[0].time for motor in motors):
            raise LimitError("a group has at least one motor, and all share one time")
        self.motors = motors
        self._own: list[tuple[float, float, float]] = []  # the motors' limits while a move has others

    def move_to(self, positions: Sequence[int]) -> None:
        """Set the motors' targets [steps], all at rest; the slowest motor for its way decides for all.

        Until they have arrived, or ``release_limits``, the motors have the limits of this move in place of their own.

        Raises
        ------
        LimitError
            When a motor is in motion, or there are more or fewer targets than motors.
        """
        if len(positions) != len(self.motors):
            raise LimitError(f"{len(self.motors)} motors need as many targets, not {len(positions)}")
        if any(motor.in_motion() for motor in self.motors):
            raise LimitError("a group sets out from rest", hint="stop() and run until it stands.")
        targets = [checks.whole("target", to) for to in positions]
        self.release_limits()
        self._own = [(m.max_speed(), m.acceleration(), m.deceleration()) for m in self.motors]
        ways = [abs(to - motor.current_position()) for motor, to in zip(self.motors, targets, strict=True)]
        moving = [(way, own) for way, own in zip(ways, self._own, strict=True) if way]
        for motor, way, to in zip(self.motors, ways, targets, strict=True):
            if way:
                speed, up, down = (way * min(own[i] / far for far, own in moving) for i in range(3))
                motor.set_max_speed(speed)
                motor.set_acceleration(up, down)
            motor.move_to(to)

    def run(self) -> bool:
        """Make the steps that are due; return whether any motor still has way to go."""
        going = [motor.run() for motor in self.motors]
        if not any(going):
            self.release_limits()
        return any(going)

    def run_to_position(self) -> None:
        """Run until all have arrived."""
        while self.run():
            pass

    def release_limits(self) -> None:
        """Give every motor its own limits back."""
        for motor, (speed, up, down) in zip(self.motors, self._own, strict=bool(self._own)):
            motor.set_max_speed(speed)
            motor.set_acceleration(up, down)
        self._own = []

    def stop(self) -> None:
        """Set the nearest targets that braking allows; ``run`` comes to rest there, all at once as they are in step."""
        for motor in self.motors:
            motor.stop()
