"""Sketch "monitor": prints when the library's rule makes each step, then runs 400 steps: 650 steps/s, 3000 steps/s².

Mended: the original starts at 30 steps/s and counts the way left from both ends, so it reports 200 of 400 steps, and
prints each speed beside the wrong time.  Here the report is kept (first column), the exact law's time stands beside it.
"""

import math

from terminal import Terminal, run

from trochia.pulses.ramps.library import next_speed
from trochia.stepper import DOUBLE, Calls, Stepper

SPEED, ACCELERATION, STEPS, FIRST = 650.0, 3000.0, 400, 30.0


def exact(step: int) -> float:
    """Return when constant acceleration makes a step of the way up [ms]."""
    top = SPEED**2 / (2 * ACCELERATION)
    rising = math.sqrt(2 * min(step, top) / ACCELERATION)
    return 1e3 * (rising + max(step - top, 0) / SPEED)


def sketch(terminal: Terminal) -> None:
    """Run it."""
    speed, time = FIRST, 0.0
    terminal.say("step made at [ms]: by the library's rule, by constant acceleration")
    for done in range(STEPS // 2):
        speed = next_speed(speed, STEPS - done, ACCELERATION, ACCELERATION, SPEED)
        time += 1e3 / speed
        terminal.say(f"{time:.2f} {exact(done + 1):.2f}")
    motor = terminal.motor(2)
    stepper = Stepper(Calls(lambda: motor.onestep(1, DOUBLE), lambda: motor.onestep(-1, DOUBLE)), terminal)
    stepper.set_max_speed(SPEED)
    stepper.set_acceleration(ACCELERATION)
    stepper.run_to_new_position(STEPS)
    terminal.say(f"{stepper.current_position()} steps in {terminal.now:.3f} s")


run(sketch, __doc__)
