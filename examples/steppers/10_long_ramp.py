"""Sketch 9: a ramp to 3000 steps on port 1, as fast as 3000 steps/s, with 300 steps/s².

Mended: 3000 steps/s would take 15,000 steps to reach; the ramp peaks at 949 steps/s (285 rpm), beyond what the motor
does without losing steps.  Both are told, and the speed is limited to 600 steps/s (180 rpm).
"""

import math

from terminal import Terminal, run

from trochia.stepper import DOUBLE, Calls, Stepper

STEPS, ASKED, ACCELERATION, MOTOR = 3000, 3000.0, 300.0, 600.0


def sketch(terminal: Terminal) -> None:
    """Run it."""
    motor = terminal.motor(1)
    stepper = Stepper(Calls(lambda: motor.onestep(1, DOUBLE), lambda: motor.onestep(-1, DOUBLE)), terminal)
    needed, peak = ASKED**2 / (2 * ACCELERATION), math.sqrt(STEPS * ACCELERATION)
    terminal.say(f"{ASKED:g} steps/s needs {needed:.0f} steps to reach; in {STEPS} the peak is {peak:.0f} steps/s")
    terminal.say(f"limited to {MOTOR:g} steps/s, {60 * MOTOR / 200:g} rpm: the motor loses steps above 200 rpm")
    stepper.set_max_speed(min(ASKED, MOTOR))
    stepper.set_acceleration(ACCELERATION)
    stepper.run_to_new_position(STEPS)
    terminal.say(f"{stepper.current_position()} steps in {terminal.now:.3f} s")


run(sketch, __doc__)
