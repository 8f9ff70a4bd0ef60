"""Motors that arrive together.

In: a target for each.  Out: ramps of one shape, so that all begin and end at the same moments.  The share of the way is
the same for all at every moment: in the space of the motors the move is a straight line.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.errors import LimitError

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
        self._own = [(m.max_speed(), m.acceleration(), m.deceleration()) for m in motors]

    def move_to(self, positions: Sequence[int]) -> None:
        """Set the motors' targets [steps], all at rest; the slowest motor for its way decides for all.

        Raises
        ------
        LimitError
            When a motor is in motion, or there are more or fewer targets than motors.
        """
        if len(positions) != len(self.motors):
            raise LimitError(f"{len(self.motors)} motors need as many targets, not {len(positions)}")
        if any(motor.speed() and motor.is_running() for motor in self.motors):
            raise LimitError("a group sets out from rest", hint="stop() and run until it stands.")
        ways = [abs(to - motor.current_position()) for motor, to in zip(self.motors, positions, strict=True)]
        moving = [(way, own) for way, own in zip(ways, self._own, strict=True) if way]
        for motor, way, to in zip(self.motors, ways, positions, strict=True):
            if way:
                speed, up, down = (way * min(own[i] / far for far, own in moving) for i in range(3))
                motor.set_max_speed(speed)
                motor.set_acceleration(up, down)
            motor.move_to(to)

    def run(self) -> bool:
        """Make the steps that are due; return whether any motor still has way to go."""
        return any([motor.run() for motor in self.motors])  # noqa: C419 - every motor must be asked

    def run_to_position(self) -> None:
        """Run until all have arrived."""
        while self.run():
            pass

    def release_limits(self) -> None:
        """Give every motor its own limits back."""
        for motor, (speed, up, down) in zip(self.motors, self._own, strict=True):
            motor.set_max_speed(speed)
            motor.set_acceleration(up, down)
