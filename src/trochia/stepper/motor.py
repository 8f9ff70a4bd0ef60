"""The step library's motor, under the names its users know.

In: targets, speeds and accelerations in steps and seconds.  Out: step pulses, each when exact constant acceleration has
it.  Targets and limits may change in motion; a target behind is reached by braking first.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from trochia.errors import LimitError
from trochia.stepper import checks
from trochia.stepper.law import next_step

if TYPE_CHECKING:
    from trochia.stepper.outputs import StepOutput
    from trochia.stepper.times import Time


class Stepper:
    """One motor at rest at position 0.

    Positions are in steps, speeds in steps/s (positive is forwards), accelerations in steps/s².  As users of the step
    library know it, speed and acceleration are limited to 1 until they are set.
    """

    def __init__(self, output: StepOutput, time: Time) -> None:
        self.output = output
        self.time = time
        self._position = self._target = 0
        self._speed = 0.0  # of run_speed
        self._max_speed = self._acceleration = self._deceleration = 1.0
        self._start_stop = math.inf
        self._square, self._way = 0.0, 1  # squared speed after the last step, and which way it was
        self._last = 0.0  # when it was
        self._due: tuple[float, float] | None = None  # when the next is, and the squared speed after it
        self._since: float | None = None  # of run_speed: when its last step was, or when it began
        self._flows = False  # whether it has made one
        time.join(self._next_due)

    # limits

    def set_max_speed(self, speed: float) -> None:
        """Limit the speed [steps/s] of ``run`` and what stands on it.

        Raises
        ------
        LimitError
            Unless it is above 0.
        """
        self._max_speed = checks.speed("maximum speed", speed)
        self._change()

    def max_speed(self) -> float:
        """Return the greatest speed [steps/s]."""
        return self._max_speed

    def set_acceleration(self, acceleration: float, deceleration: float | None = None) -> None:
        """Set the acceleration, and with it the deceleration unless that is given too [steps/s²].

        Raises
        ------
        LimitError
            Unless both are above 0.
        """
        up = checks.acceleration("acceleration", acceleration)
        down = up if deceleration is None else checks.acceleration("deceleration", deceleration)
        self._acceleration, self._deceleration = up, down
        self._change()

    def set_start_stop_speed(self, speed: float) -> None:
        """Name the greatest speed the motor starts at, and stops from, without losing steps [steps/s].

        From then on what would start or stop beyond it is refused when it is run.

        Raises
        ------
        LimitError
            Unless it is above 0.
        """
        self._start_stop = checks.speed("start/stop speed", speed)

    def acceleration(self) -> float:
        """Return the acceleration [steps/s²]."""
        return self._acceleration

    def deceleration(self) -> float:
        """Return the deceleration [steps/s²]."""
        return self._deceleration

    # where it is

    def current_position(self) -> int:
        """Return how many steps it stands from 0."""
        return self._position

    def set_current_position(self, position: int) -> None:
        """Call the place where it stands ``position``; the target is the same place, and the speed is 0."""
        self._position = self._target = checks.whole("position", position)
        self._square, self._speed = 0.0, 0.0
        self._due = self._since = None

    def target_position(self) -> int:
        """Return where it is going [steps]."""
        return self._target

    def distance_to_go(self) -> int:
        """Return the steps from where it stands to the target, signed."""
        return self._target - self._position

    def speed(self) -> float:
        """Return the speed after the last step of a ramp, or else the one that was set [steps/s], signed."""
        return self._way * math.sqrt(self._square) if self._square else self._speed

    def is_running(self) -> bool:
        """Return whether it moves, or has steps to go."""
        return self._square > 0.0 or self._position != self._target

    def in_motion(self) -> bool:
        """Return whether the last step of a ramp was not its last."""
        return self._square > 0.0

    # speeding up and braking

    def move_to(self, position: int) -> None:
        """Set an absolute target [steps]; ``run`` gets there.

        Raises
        ------
        LimitError
            Unless it is a whole number.
        """
        self._target = checks.whole("target", position)
        self._change()

    def move(self, steps: int) -> None:
        """Set a target as many steps from here; errors as of ``move_to``."""
        self.move_to(self._position + checks.whole("move", steps))

    def run(self) -> bool:
        """Make the step that is due, if one is; return whether there is still way to go.

        Call it again and again: where nothing is due yet, time passes to what is due next.

        Raises
        ------
        LimitError
            When the first or the last step would be faster than the start/stop speed.
        """
        self._take_over()
        if self._due is None:  # the way begins now; other motors may begin theirs before time goes on
            self._check_ends()
            self._plan(self.time.now)
            return self._due is not None
        moment, square = self._due
        if self.time.now < moment:
            self.time.idle(self._next_due)
            return True
        now = self.time.now  # later than due where nobody ran it in time: the step is made late, not in the past
        if self._square and now - moment > moment - self._last:
            self._square = 0.0  # so late that it has come to rest
            self._plan(now)
            return self.is_running()
        self._make(now, self._way)
        self._square = square
        self._plan(now)
        return self.is_running()

    def run_to_position(self) -> None:
        """Run until the target is reached."""
        while self.run():
            pass

    def run_to_new_position(self, position: int) -> None:
        """Set a target and run until it is reached."""
        self.move_to(position)
        self.run_to_position()

    def stop(self) -> None:
        """Set the nearest target that braking allows: ``run`` comes to rest there."""
        self._take_over()
        self.move_to(self._position + self._way * math.ceil(self._square / (2.0 * self._deceleration) - 1e-9))

    # constant speed

    def set_speed(self, speed: float) -> None:
        """Set the speed of ``run_speed`` [steps/s], at most the greatest speed; 0 stands still.

        Raises
        ------
        LimitError
            Unless it is a finite number.
        """
        wanted = checks.finite("speed", speed, "steps/s")
        self._speed = max(-self._max_speed, min(self._max_speed, wanted))
        if not self._speed:
            self._since = None

    def run_speed(self) -> bool:
        """Make the step that is due at constant speed, if one is; return whether it was made.

        Raises
        ------
        LimitError
            When the speed is above the start/stop speed: it needs a ramp.
        """
        if not self._speed:
            return False
        if self._since is None:
            if abs(self._speed) > self._start_stop:
                raise LimitError(
                    f"{abs(self._speed):g} steps/s from rest is more than the start/stop speed of "
                    f"{self._start_stop:g} steps/s",
                    hint="Speed up to it: set_max_speed(), set_acceleration(), move_to() and run().",
                )
            self._since, self._flows = self.time.now, False
            self._square, self._due = 0.0, None  # a ramp ends here
        if self.time.now < self._since + 1.0 / abs(self._speed):
            self.time.idle(self._next_due)
            return False
        self._make(self.time.now, 1 if self._speed > 0 else -1)
        self._since, self._flows = self.time.now, True
        return True

    def run_speed_to_position(self) -> bool:
        """As ``run_speed``, towards the target, whatever the speed's sign; return whether there is way to go."""
        left = self.distance_to_go()
        if not left or not self._speed:
            self._since = None
            return False
        self._speed = math.copysign(self._speed, left)
        self.run_speed()
        return self._position != self._target

    # current

    def enable_outputs(self) -> None:
        """Switch the windings on."""
        self.output.energise(self.time.now, on=True)

    def disable_outputs(self) -> None:
        """Switch the windings off: the motor no longer holds its place."""
        self.output.energise(self.time.now, on=False)

    # inside

    def _take_over(self) -> None:
        """Let a ramp go on from constant speed, where that still runs; what was not run in time stands."""
        if self._since is None:
            return
        runs = self._flows and self._speed and self.time.now <= self._since + 1.0 / abs(self._speed)
        self._since = None
        if runs:
            self._square, self._way = self._speed**2, 1 if self._speed > 0 else -1
            self._change()

    def _check_ends(self) -> None:
        """Refuse ramps whose first or last step is too fast: it takes √(2/a), or 1/v where v is reached within it."""
        steepest = max(self._acceleration, self._deceleration)
        first = min(math.sqrt(steepest / 2.0), self._max_speed)
        if self._position != self._target and first > self._start_stop:
            raise LimitError(
                f"with {steepest:g} steps/s² the first or last step is made at {first:.4g} steps/s, more than the "
                f"start/stop speed of {self._start_stop:g} steps/s",
                hint=f"At most {2.0 * self._start_stop**2:.4g} steps/s² would do.",
            )

    def _make(self, moment: float, way: int) -> None:
        """Make one step."""
        self._last, self._way = moment, way
        self._position += way
        self.output.step(moment, way)

    def _plan(self, begin: float) -> None:
        """Find when the next step is due, the one before or the beginning having been at ``begin`` [s]."""
        self._due = None
        if self._square == 0.0:
            if self._position == self._target:
                return
            self._way = 1 if self._target > self._position else -1
        left = max(self._way * self.distance_to_go() - 1, 0)
        duration, square = next_step(
            self._square,
            gain=2.0 * self._acceleration,
            loss=2.0 * self._deceleration,
            top=self._max_speed**2,
            end=2.0 * self._deceleration * left,
        )
        self._due = (begin + duration, square)

    def _change(self) -> None:
        """Take up a new target or limit in motion, never with a step in the past; at rest, ``run`` does."""
        if self._square == 0.0:
            self._due = None
            return
        self._plan(self._last)
        if self._due is not None and self._due[0] < self.time.now:
            self._due = (self.time.now, self._due[1])

    def _next_due(self) -> float | None:
        """Return when something is due [s]."""
        if self._since is not None:
            return self._since + 1.0 / abs(self._speed)
        return self._due[0] if self._due else None
